"""LAMMPS as the engine: deformable particles, soft disks, rings of beads."""
