"""Where the motion is free, struck or driven, and which of several modes it shows."""
