"""LAMMPS, the ways to rest, and one simulation."""
