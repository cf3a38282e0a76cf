"""How far each law goes before it fails."""
