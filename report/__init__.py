"""Pictures and the page that tell what came out: ``page.identification_page`` is the face."""
