"""What the measuring chain did, and which recording disagrees with the others."""
