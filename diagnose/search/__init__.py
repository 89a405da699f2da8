"""What is missing: the laws of the library against what a model leaves over."""
