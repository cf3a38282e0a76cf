"""Settings of simulations: packings, contact laws, walls, polygons, time steps."""
