"""How smooth the rings of the reference are: friction, hysteresis, a crystal."""
