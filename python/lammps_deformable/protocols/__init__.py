"""What is done to a simulation, step by step."""
