"""Studies with the package: what was measured, and the programs that measure it again."""
