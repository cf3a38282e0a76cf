"""Files of other programs, and those of a run."""
