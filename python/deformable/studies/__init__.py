"""Comparisons with rings of beads, the results of the paper, ensembles of jammed packings."""
