"""A gallery over recordings that other people made: each run through the commands as a user would, on one page."""
