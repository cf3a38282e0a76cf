"""Foams that age: growth of bubbles by gas through films and liquid, in the plane and in space."""
