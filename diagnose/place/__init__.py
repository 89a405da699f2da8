"""Where simulation and recording differ: the missing force, and what it follows."""
