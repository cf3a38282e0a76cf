"""What is simulated, as settings: packings, contact laws, walls, rings of beads, time steps."""
