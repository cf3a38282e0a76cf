"""Packings of rings strained in one step: the paper's one, and mixtures of stiffnesses."""
