"""Where a motion is prescribed and the force recorded: the force law by itself, fitted, named and shown."""
