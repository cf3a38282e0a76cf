"""Errors and warnings that name what went wrong and the way out."""


class ParameterError(ValueError):
    """A parameter has a value that cannot work."""


class FileError(RuntimeError):
    """A folder or file cannot be read back."""


class LammpsError(RuntimeError):
    """LAMMPS refused a command; carries its one useful line."""


class StalledWarning(UserWarning):
    """A relaxation stopped before it reached its tolerance."""


class UnjammedWarning(UserWarning):
    """A packing that was rigid rearranged under compression into one that bears no force."""


class BeyondModelWarning(UserWarning):
    """Particles are deformed further than the model describes, e.g. past confluence."""
