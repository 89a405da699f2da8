"""What touches disk and processes: reading, writing, exit codes, groups of processes."""
