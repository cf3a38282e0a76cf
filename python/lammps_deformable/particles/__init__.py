"""What a packing and a law are, and how they read in LAMMPS."""
