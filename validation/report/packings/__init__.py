"""Packings of polygons strained in one step: the paper's one, and mixtures of stiffnesses."""
