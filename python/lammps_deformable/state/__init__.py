"""Snapshots of a simulation, their contacts, and their pictures."""
