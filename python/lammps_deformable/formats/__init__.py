"""Files of particles as plain values: LAMMPS, extended XYZ, GSD, and what MDAnalysis reads."""
