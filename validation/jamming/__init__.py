"""Ensembles of packings at and above the onset of jamming."""
