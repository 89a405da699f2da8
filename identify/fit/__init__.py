"""Which minimum, which noise and which errors the answer has."""
