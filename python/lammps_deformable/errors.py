"""Errors and warnings; their messages name the bad value and the way out."""

from __future__ import annotations


class DeformableError(Exception):
    """Any error of this package."""


class ParameterError(DeformableError, ValueError):
    """A parameter has a value that cannot work."""


class UndefinedError(ParameterError, AttributeError):
    """An object of this kind has no such attribute, so that `hasattr` says no."""


class FileError(DeformableError, RuntimeError):
    """A folder or file cannot be read."""


class LammpsError(DeformableError, RuntimeError):
    """LAMMPS refused a command; the message is one line of LAMMPS' error."""


class CallError(DeformableError, RuntimeError):
    """A simulation is called by two threads at a time, or not by all of its ranks."""


class StalledWarning(UserWarning):
    """A relaxation stopped before it reached its tolerance."""


class UnjammedWarning(UserWarning):
    """A packing is loose: it rearranged and lost its contact forces, or it has been expanded."""


class BeyondModelWarning(UserWarning):
    """Particles are deformed further than their law describes, e.g. past confluence."""


class JumpWarning(UserWarning):
    """Particles move by about half a box from one state to the next, and cannot be followed."""


class UnsavedWarning(UserWarning):
    """A saved state lacks walls or excluded pairs that were given to LAMMPS."""
