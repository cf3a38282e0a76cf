"""The command `deformable`."""
