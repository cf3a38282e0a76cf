"""How smooth the polygons of the reference are: friction, hysteresis, a crystal."""
