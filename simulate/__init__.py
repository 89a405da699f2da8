"""A model turned into a compiled core and run."""
