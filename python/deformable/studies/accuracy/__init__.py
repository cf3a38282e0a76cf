"""How right each law is, and how fast: laws and rings compress the same packings."""
