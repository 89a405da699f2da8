"""What to record next: the experiment that tells the rivals apart."""
