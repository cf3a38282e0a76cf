"""LAMMPS as the engine: deformable particles, soft disks, polygons."""
