"""One state, and what it knows."""
