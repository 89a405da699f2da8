"""Values from which the fit starts."""
