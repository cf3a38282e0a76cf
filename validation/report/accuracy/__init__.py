"""How right each law is, and how fast: laws and polygons compress the same packings."""
