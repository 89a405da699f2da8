"""The terminal: options, words and exit codes; it translates and prints, and decides nothing."""
