"""Laws against reference models: error against run time."""
