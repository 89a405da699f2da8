"""FREEVIB and FORCEVIB: what the Hilbert transform says of a recording."""
