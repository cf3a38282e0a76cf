"""Settings of simulations: packings, contact laws, walls, rings of beads, time steps."""
