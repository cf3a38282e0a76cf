"""What was recorded, and states in dumps of LAMMPS."""
