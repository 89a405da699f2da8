"""Two rigs and a spring in co-simulation, and a controller beside them."""
