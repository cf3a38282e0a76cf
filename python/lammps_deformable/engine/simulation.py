"""Particles in LAMMPS: relax them, take their state, change their box."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.box import lattice_vectors, shown_box
from ..common.checks import count, expect, positive, shown
from ..common.errors import ParameterError, UndefinedError
from ..common.ranks import OneCall
from ..formats.store import Motion
from ..particles import containers
from ..particles.friction import Friction
from ..particles.gravity import as_gravity, check_held
from ..particles.laws import AnyLaw, Droplet, Ring, Sector, SoftContact, sticks
from ..particles.packing import Packing, refuse_crushed
from ..particles.polygons import DeformablePolygon, Walls
from ..particles.walls import Wall
from ..state.recorded import motion_of
from ..state.state import State
from .breathing import relax_radii
from .engines import (
    Droplets,
    Rings,
    SoftParticles,
)
from .free_box import check_free, relax_free_box
from .lammps import (
    box_change,
    close_lammps,
    communicator,
    gather,
    has_other_fixes,
    refuse_forces_of_motion,
    run,
    setup,
)
from .polygon_engine import PolygonBeads
from .relax import (
    USUAL,
    Callback,
    Forces,
    Iteration,
    can_polish,
    carry,
    check_callback,
    minimize_until_relaxed,
    minimizers_reach,
    polish,
    rest,
    tell,
    warn_of,
)
from .soft_disks import relax_in_box
from .stress import stress

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from lammps import lammps
    from mpi4py import MPI

    from ..protocols.motion import Alignment
    from ..protocols.protocol import Protocol
    from ..runs.run import Run

# What is computed for each law.
_ENGINES: dict[type, type] = {
    Ring: Rings,
    Sector: Rings,
    Droplet: Droplets,
    SoftContact: SoftParticles,
    DeformablePolygon: PolygonBeads,
}

# Films bear a pull of about w R^(d - 2). This part of it replaces a smaller mean contact force.
_PULL = 0.01


class Simulation(OneCall):
    """Particles in LAMMPS, in the plane or in space.

    Every rank of an MPI run must make the same calls, and gets the same values.

    Args:
        packing: where particles start, e.g. from `bidisperse`; or a state, such as that of `jam`:
            see `reset`. Its law may be another one.
        law: `Ring`, `Sector`, `Droplet`, `SoftContact` or `DeformablePolygon`.
        friction: of the contacts of rings or droplets, which rub and damp and turn them; particles
            get radii of their own. That of a state if not given; contacts of a packing slip freely
            then.
        gravity: acceleration (gx, gy), in space (gx, gy, gz), or a row for each species
            [length/time^2]; as masses are 1 it is the force on a particle too, which may stand for
            another constant force. It acts in relaxations and motion. That of a state if not given;
            (0, 0) is none.
        minimizer: of relaxations, `lbfgs` (*min_style deformable/lbfgs*) or `fire`. L-BFGS needs
            5 to 25 times fewer force calls; where it fails, FIRE goes on. The first one that the
            law can have if not given: energies of `Sector` jump, so it has `fire` only, contacts
            that rub rest by `damped` motion, smooth polygons by `newton`, those of beads by `fire`.
        comm: communicator that shares the work; all ranks if not given. With `MPI.COMM_SELF` every
            rank runs a simulation of its own, the fast way for many small packings. Soft contacts
            are relaxed by each rank alone, as their results would depend on the number of ranks.
        threads: of each rank, that share the balance of contacts of `balanced` and `curved` rings
            and of droplets, up to the cores that the process may use; `"auto"` takes all of these.
            Any number gives the same results to the last bit. Worth it from some 1000 particles on;
            `parallel_map` makes better use of cores where packings are many.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS. Particles may be added, deleted or
            changed as long as their IDs stay 1 to N and their masses 1; the law, its species, the
            boundaries and the thermo output belong to this object.
        law: of the particles.
        friction: of the contacts; None if they slip.
        gravity: of the particles, shape (d,) or (species, d); None without.
        minimizer: that of its relaxations.
        comm: the communicator.
        threads: as given.
        callback: a function that is told how relaxations go on; None if not set.
        time: of all motion and flows so far [time]; relaxations take none.
        shear_strain: of all calls of `shear` so far; None before the first one.
        directions: in which particles propel themselves, shape (N, d); None before.
        seed: of the last motion, given or drawn; None before.

    Raises:
        ParameterError: no packing or no law; a packing of another dimension than the law, or whose
            particles are far larger than its box; a center on the wrong side of a wall, or an
            obstacle that does not fit into the periodic box; a friction, gravity or minimizer that
            the law cannot have; or polygons that overlap too far, or reach their own images.
        LammpsError: LAMMPS refuses the packing or the law.
    """

    time: float = 0.0
    shear_strain: float | None = None
    threads: int | str = 1
    directions: NDArray[np.float64] | None = None
    seed: int | None = None
    _callback: Callback | None = None
    law: Any
    engine: Any
    _lmp: Any

    def __init__(
        self,
        packing: Packing | State,
        law: AnyLaw | SoftContact | DeformablePolygon,
        *,
        friction: Friction | None = None,
        gravity: ArrayLike | None = None,
        minimizer: str | None = None,
        comm: MPI.Comm | None = None,
        threads: int | str = 1,
    ) -> None:
        expect("packing", packing, Packing, State)
        expect("law", law, *_ENGINES)
        expect("friction", friction, Friction, type(None))
        self.law, self.comm = law, communicator(comm, (law, friction, gravity, minimizer, threads))
        if isinstance(threads, str) and threads != "auto":
            raise ParameterError(f"threads must be a number or 'auto', not {shown(threads)}")
        self.threads = threads if isinstance(threads, str) else count("threads", threads)
        start, state = _parts(self.comm.bcast(packing))  # those of other machines may differ
        self.friction = state.friction if state is not None and friction is None else friction
        gravity = state.gravity if state is not None and gravity is None else gravity
        self.gravity = as_gravity(gravity, start, law)
        self.engine = _ENGINES[type(law)](law)
        self.minimizer = self.engine.chosen(minimizer, self.friction)
        self._rigidity = Rigidity(start)
        self._check(start, state)
        self._open(start, state)

    @classmethod
    def _within(
        cls, packing: Packing, law: DeformablePolygon, walls: Walls, comm: MPI.Comm | None = None
    ) -> Simulation:
        """A single polygon between `Walls`, which `confine` moves."""
        expect("walls", walls, Walls)
        sim = cls.__new__(cls)
        sim.law, sim.comm, sim.friction = law, communicator(comm), None
        sim.gravity = None
        sim.engine, sim._rigidity = PolygonBeads(law, walls), Rigidity(packing)
        sim.minimizer = sim.engine.chosen(None, None)
        sim._check(packing, None)
        sim._open(packing, None)
        return sim

    def _check(self, packing: Packing, state: State | None) -> None:
        """Refuse a start that the law cannot have, before anything is changed."""
        refuse_crushed(packing)
        try:
            self.engine.check(packing, self.friction)
        except ParameterError as error:
            if state is not None and self.friction and self.friction == state.friction:
                raise ParameterError(f"{error}; or start from the packing of the state") from None
            raise

    def _open(self, packing: Packing, state: State | None, former: lammps | None = None) -> None:
        packing = self.engine.opened(packing, self.friction)
        self._walls = packing.walls
        self.lmp = self.engine.open(self, packing, former)
        self.engine.imbalance = USUAL
        self._facet = float(packing.radii.min()) ** (packing.dimension - 1)
        at_rest = Motion(np.zeros_like(packing.positions))
        self.engine.go_on(self, motion_of(state) if state is not None else at_rest)
        self.engine.setup = setup(self.lmp)

    def reset(self, packing: Packing | State) -> None:
        """Start anew from a packing or a state, with the same law: results depend on it alone.

        Otherwise the last digits depend on data that LAMMPS and the pair style keep, such as the
        order of particles and the shares of both sides in a contact. Where a packing rearranges,
        other last digits may lead to another packing. Commands given to `lmp` are lost.

        Args:
            packing: that of a state of this simulation, or another one: particles may be added,
                removed or have other radii. They are at rest, stick where their circles overlap,
                and time and strain begin anew. Those of a state go on, with velocities and films.

        Raises:
            ParameterError: the law cannot have the packing; the simulation is as it was.
            LammpsError: LAMMPS refuses it; the simulation is closed.
        """
        expect("packing", packing, Packing, State)
        start, state = _parts(packing)
        self._check(start, state)
        as_gravity(self.gravity, start, self.law)
        self.engine.steps_before = 0
        self._rigidity.start = self._rigidity.start and start
        try:
            self._open(start, state, self.lmp)
        except BaseException:
            self.close()
            raise

    @property
    def lmp(self) -> lammps:
        """The LAMMPS instance."""
        if self.closed:
            raise UndefinedError(
                "this Simulation is closed: make a new one, or use it before the end of its `with` "
                "block"
            )
        with self._lmp.calls.of_one_thread("Simulation.lmp"):
            return self._lmp

    @lmp.setter
    def lmp(self, lmp: lammps) -> None:
        self.engine.begun += 1
        lmp.calls.begun = True
        self._lmp = lmp

    @property
    def closed(self) -> bool:
        """Whether the LAMMPS instance is gone."""
        return not self._lmp.opened

    def close(self) -> None:
        """Free the LAMMPS instance."""
        with self._lmp.calls.of_one_thread("Simulation.close"):
            close_lammps(self._lmp)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __reduce__(self) -> NoReturn:
        raise ParameterError(
            "a Simulation cannot be pickled or copied, as its LAMMPS cannot: copy or save its "
            "state()"
        )

    def __repr__(self) -> str:
        if self.closed:
            return "<Simulation: closed>"
        number = self.engine.number(self.lmp)
        return f"<Simulation: {number} particles, law {self.law!r}, {shown_box(self.box)}>"

    @property
    def dimension(self) -> int:
        """2, or 3 in space."""
        return int(self.lmp.extract_setting("dimension"))

    @property
    def box(self) -> NDArray[np.float64]:
        """Lattice vectors as rows, as those of a packing, shape (d, d) [length].

        In directions that a container closes, the box has its length.
        """
        low, high, xy, yz, xz, *_ = self.lmp.extract_box()
        lx, ly, lz = (end - begin for begin, end in zip(low, high, strict=True))
        box = np.array([[lx, 0.0, 0.0], [xy, ly, 0.0], [xz, yz, lz]])
        dimension = self.dimension
        return containers.box_between(self._walls, box[:dimension, :dimension])

    @property
    def packing(self) -> Packing:
        """The present packing, that of `state()`."""
        return self.state().packing

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The walls, where they are now."""
        return self._walls

    def deform(self, box: NDArray[np.float64]) -> None:
        """Give the box other lattice vectors; all positions and walls follow affinely.

        With friction the springs of contacts follow too; particles do not turn.

        Args:
            box: lattice vectors as rows, as those of a packing, shape (d, d) [length].

        Raises:
            ParameterError: the box has another form, or one that walls cannot follow: they are not
                sheared, and round ones stay round. The simulation is unchanged.
        """
        former, state = self.box, self.state() if self.friction else None
        box = lattice_vectors(box)
        if len(box) != self.dimension:
            raise ParameterError(f"box must have {self.dimension} sides, not {len(box)}")
        walls = containers.stretched(self._walls, former, box)
        self.engine.follow(self, walls, box)
        self._walls = walls
        run(self.lmp, box_change(walls, box))
        if state is not None:
            carry(self.lmp, state, np.linalg.inv(former) @ box)

    def _confine(self, walls: Walls) -> None:
        """Move the walls around a single polygon, see `PolygonBeads.confine`."""
        if not isinstance(self.engine, PolygonBeads):
            raise ParameterError("_confine moves the walls of a single polygon only: take deform")
        self.engine.confine(self, walls)

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
        callback: Callable[[State], object] | None = None,
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
                0 as of `relax`.
            steps: number of steps.
            tolerance: of each relaxation, at most 0.01 in a record; by default that of `relax`.
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
        from ..protocols.compression import Compress

        return self.play(
            Compress(strain=strain, phi=phi, pressure=pressure, steps=steps, tolerance=tolerance),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

    def grow(
        self,
        *,
        factor: float | None = None,
        phi: float | None = None,
        steps: int = 1,
        tolerance: float | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
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
        from ..protocols.compression import Grow

        return self.play(
            Grow(factor=factor, phi=phi, steps=steps, tolerance=tolerance),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

    def shear(
        self,
        strain: float,
        *,
        steps: int = 1,
        rate: float | None = None,
        drag: float | None = None,
        temperature: float | None = None,
        inertia: bool = False,
        timestep: float | None = None,
        tolerance: float | None = None,
        seed: int | np.random.Generator | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Shear in equal steps, relaxing after each one, or at a rate; the size of the box stays.

        After step n the upper side of the box has moved along x by strain n / steps times its
        height. A state has the `shear_stress` that resists, and the `shear_strain` of all calls for
        one simulation. A box whose tilt exceeds half its width is replaced by the equivalent box
        with the smallest tilt, so that strains may be large.

        With a rate particles are overdamped, with a drag against the mean flow u = rate y along x,

            drag (dr/dt - u) = F + sqrt(2 drag temperature) noise

        as bubbles in Durian's model. LAMMPS' *fix deform* with *remap x* moves the box and the
        particles in it, *fix brownian* adds the rest. Velocities are 0 in all states.

        With inertia particles move by the forces of their contacts alone, friction and films
        included, and only the boundaries of the box shear them, by *remap v*. They begin with the
        mean flow, in place of the mean gradient of their velocities. Velocities of states have the
        flow in them.

        Args:
            strain: shear strain gamma of this call; negative shears in the other direction.
            steps: number of steps, of which each gives a state.
            rate: strain per time, above 0 [1/time]; if not given, the shear is quasistatic. The law
                of flows is `Ring` or `Droplet`, and the next arguments belong to them.
            drag: force over velocity relative to the mean flow [1/time], as masses are 1.
            temperature: of the noise [energy]; without, there is none.
            inertia: whether particles have inertia, and neither drag nor temperature.
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
            The states: that before the first step, then that after each step, with its
            `shear_strain`; without a rate it is relaxed, with a rate it has a `time`.

        Raises:
            ParameterError: a value is out of range, or the simulation has walls; or see `run`.
            LammpsError: see `run`.
            FileError: see `compress`.

        Source: drag: Durian, Phys. Rev. Lett. 75, 4780 (1995).
        """
        from ..protocols.shearing import Shear

        return self.play(
            Shear(
                strain=strain,
                steps=steps,
                rate=rate,
                drag=drag,
                temperature=temperature,
                inertia=inertia,
                timestep=timestep,
                tolerance=tolerance,
                seed=seed,
            ),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

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
        seed: int | np.random.Generator | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
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
        from ..protocols.shearing import Oscillate

        return self.play(
            Oscillate(
                amplitude=amplitude,
                period=period,
                cycles=cycles,
                steps=steps,
                drag=drag,
                temperature=temperature,
                timestep=timestep,
                tolerance=tolerance,
                seed=seed,
            ),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

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
        seed: int | np.random.Generator | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
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
            The states, that before first, with their `shear_strain` and `time`.

        Raises:
            ParameterError: see `shear`; or the box has a tilt yz.
            LammpsError: see `run`.
            FileError: see `compress`.
        """
        from ..protocols.shearing import Creep

        return self.play(
            Creep(
                shear_stress=shear_stress,
                time=time,
                steps=steps,
                drag=drag,
                viscosity=viscosity,
                temperature=temperature,
                timestep=timestep,
                seed=seed,
            ),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

    def coarsen(
        self,
        permeability: float,
        *,
        time: float,
        steps: int = 1,
        border: float = 0.0,
        tolerance: float | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Let gas flow from bubbles of higher pressure to their neighbors: a foam that ages.

        Volumes V_i of the undeformed bubbles, areas in the plane, change by the films S_ij between
        bubbles, their lengths or in space areas, and by the free surfaces S_i,

            dV_i/dt = -permeability [sum_j S_ij (p_i - p_j) + border S_i (p_i - p)/R_i]

        with the pressures p_i, and that of the gas in the liquid p, which keeps the sum of all
        volumes. Films alone let radii grow as t^(1/2), the liquid alone as t^(1/3). The foam is at
        rest all the time. In a step no volume changes by more than 5 % of the mean. A bubble below
        4 % of the mean, or of its largest neighbor, vanishes; the `labels` of a state tell which
        ones are left, and `Run.events` when the others vanished. Bubbles that lie loosely between
        others shrink by the border alone. Walls let no gas pass. Sizes become very unequal: take a
        reach of 2. Exact films are those of
        Ring(kA=inf, kP=0, tension=..., contact="curved", reach=2).

            run = sim.coarsen(1.0, time=50.0, steps=100, record="run")

        Args:
            permeability: of films [length^(d+1)/(energy time)].
            time: in all [time].
            steps: number of states, after equal parts of the time.
            border: thickness of films, over which gas crosses them, where it crosses a distance of
                about R_i through the liquid; 0: no gas flows through the liquid [length].
            tolerance: as in `compress`, as all that follows.
            record: folder of the run.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: the relaxed start, then that after each part of the time, with its `time`.

        Raises:
            ParameterError: a value is out of range, the law is neither `Ring` nor `Droplet`, or
                contacts rub.
            FileError: see `compress`.

        Source: films: von Neumann, in Metal Interfaces (1952); gas in the liquid: Lemlich, Ind.
        Eng. Chem. Fundam. 17, 89 (1978); growth: Lifshitz and Slyozov, J. Phys. Chem. Solids 19, 35
        (1961).
        """
        from ..protocols.coarsening import Coarsen

        return self.play(
            Coarsen(
                permeability=permeability,
                time=time,
                steps=steps,
                border=border,
                tolerance=tolerance,
            ),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

    def proliferate(
        self,
        rate: float | Sequence[float] | str,
        *,
        division: float,
        time: float,
        steps: int = 1,
        axis: str = "random",
        kappa: float | None = None,
        asymmetry: float = 0.1,
        pressure: float | None = None,
        death: float = 0.0,
        tolerance: float | None = None,
        seed: int | np.random.Generator | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Let cells grow, divide and die: a tissue.

        Volumes V_i of cells at rest, areas in the plane, grow by

            dV_i/dt = rate V_i max(0, 1 - p_i/pressure),    p_i = sum f h/(d V_i)

        over the contacts of a cell: f is the force, h the distance of the contact line, or facet,
        from the center, d the dimension. A cell of the volume `division` or more divides in two,
        side by side. The tissue is at rest all the time, relaxed at least each time that volumes
        have grown by 5 %. `labels` of a state tell which cell is which, `clones` the label of the
        first ancestor of each.

            run = sim.proliferate(1.0, division=1.6, time=5.0, steps=20, pressure=0.1)

        Args:
            rate: of growth, a number or one for each species, not negative [1/time]; or by place,
                an atom-style formula of LAMMPS such as "exp(-x/5)".
            division: volume at rest at which a cell divides [length^d].
            time: in all [time].
            steps: number of states, after equal parts of the time.
            axis: on which the two lie, `random`, `long`, that of the outline in the plane, or
                `stress`, along which the cell is pressed least; without contacts any.
            kappa: concentration of directions about that axis, by von Mises' density, in space by
                Fisher's, p ~ exp(kappa cos(angle)); 0 is any direction, without it is the axis.
            asymmetry: shares of the two are drawn between 0.5 (1 - asymmetry) and
                0.5 (1 + asymmetry), so that cells do not divide at the same time.
            pressure: at which cells do not grow any more [energy/length^d]; without, they always
                do.
            death: rate at which cells vanish by chance [1/time]; the last one stays.
            tolerance: as in `compress`.
            seed: of axes, shares and deaths, as in `run`.
            record: as in `compress`, as all that follows.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: the relaxed start, then that after each part of the time, with its `time`.

        Raises:
            ParameterError: a value is out of range, the law is neither `Ring` nor `Droplet`, or
                contacts rub; or cells have no room left.
            FileError: see `compress`.

        Source: growth under pressure: Shraiman, PNAS 102, 3318 (2005), and Basan et al., HFSP J. 3,
        265 (2009); long axis: Hertwig (1884); directions about it: Mardia and Jupp,
        Directional Statistics (2000).
        """
        from ..protocols.proliferation import Proliferate

        return self.play(
            Proliferate(
                rate=rate,
                division=division,
                time=time,
                steps=steps,
                axis=axis,
                kappa=kappa,
                asymmetry=asymmetry,
                pressure=pressure,
                death=death,
                tolerance=tolerance,
                seed=seed,
            ),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

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
        alignment: Alignment | None = None,
        pressure: float | None = None,
        inertial_number: float | None = None,
        tolerance: float | None = None,
        balance: float | None = None,
        seed: int | np.random.Generator | None = None,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
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

        With a propulsion each particle adds to F a force of this size along its
        direction, which diffuses (*fix deformable/propel* of this package). Without contacts and
        noise its speed is v = propulsion/drag, and in overdamped motion, with the persistence time
        tau,

            <r^2> = 2 v^2 tau (t - tau (1 - exp(-t/tau)))

        With a pressure p particles come to rest by damped motion in a box that follows: contacts
        that rub, by the `friction` of the simulation, make a packing depend on its way, and
        minimizers pass over friction. The box keeps its shape; the rate of its sides L is
        proportional to what is missing in the pressure P of the contacts,

            d(ln L)/dt = - I sqrt(p/m) (1 - P/p),

        in space with p times the mean diameter for p in the root, so that a loose packing is
        compressed at the inertial number I = |d(ln L)/dt| sqrt(m/p), and no faster later. The run
        ends where forces, torques and the pressure are balanced without the drag. Further calls at
        higher or lower pressures go on from there, springs of contacts included.

        Args:
            steps: number of time steps, where other protocols count states; with a pressure at
                most.
            every: number of steps between states; if not given, there is one at the end.
            timestep: length of a step [time]; if not given, a fifth of the longest one that is
                accepted, see docs/units.md. This one depends on the pressure in particles, or the
                load of droplets, on the temperature, of the motion or its bath, and on the fastest
                particle; where these grow, steps become shorter. Give one if other forces than
                those of contacts, by fixes of `lmp`, move particles that are at rest. With a
                pressure half of the longest one that is accepted for contacts that bear it.
            temperature: of the heat bath if there is a drag, and of initial velocities [energy].
                These are Maxwell's, with zero total momentum. A bath draws them where all particles
                are at rest, as after `relax`; others go on with the velocities that they have. If
                not given, none are drawn: the velocities are those of the simulation.
            drag: rate at which velocities decay, or force over velocity [1/time]; 0 if not given,
                with a pressure min(2, 0.16/(I N^(2/d))) sqrt(p/m).
            inertia: whether particles have some; without, they need a drag.
            propulsion: force with which particles propel themselves, above 0 [energy/length]; they
                need a drag.
            persistence: time tau in which their directions n forget the first one, <n(t).n(0)> =
                exp(-t/tau), above 0 [time]; infinite for directions that stay.
            alignment: of directions to velocities, to neighbors or to free space.
            pressure: p, of the state at rest [energy/length^d].
            inertial_number: I, 1e-3 if not given; the smaller, the slower is the compression.
            tolerance: with a pressure, largest force on a particle, and largest torque on it over
                its radius, over the mean contact force, and the largest relative error of the
                pressure; 1e-4 if not given.
            balance: largest imbalance of a `balanced` or `curved` contact over the largest force,
                in steps and states; 1e-8 if not given. In a hot bath 1e-4 halves the time of
                `curved`.
            seed: of velocities and noise, together with the number of steps so far: a second call
                draws others. The noise also depends on the number of ranks. If not given, or a
                generator of numpy, one is drawn, which `sim.seed` and the parameters of the run
                keep.
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
            a pressure the last one is not `converged` if it does not rest.

        Raises:
            ParameterError: a value is out of range, the time step is too long for the contacts, or
                the law is `Sector`, whose energy jumps; or with a pressure there are walls, or the
                box leans along x and y.
            LammpsError: particles overlap too much, at the start (`push_off` helps) or later.
            FileError: see `compress`.

        Warns:
            StalledWarning: particles did not come to rest at the pressure.

        Source: heat bath: Gronbech-Jensen and Farago, Mol. Phys. 111, 983 (2013), and Jensen and
        Gronbech-Jensen, Mol. Phys. 117, 2511 (2019); velocity Verlet: Swope et al., J. Chem. Phys.
        76, 637 (1982); damped motion at a pressure: Somfai et al., Phys. Rev. E 75, 020301 (2007);
        inertial number: GDR MiDi, Eur. Phys. J. E 14, 341 (2004).
        """
        from ..protocols.motion import Move

        return self.play(
            Move(
                steps=steps,
                every=every,
                timestep=timestep,
                temperature=temperature,
                drag=drag,
                inertia=inertia,
                propulsion=propulsion,
                persistence=persistence,
                alignment=alignment,
                pressure=pressure,
                inertial_number=inertial_number,
                tolerance=tolerance,
                balance=balance,
                seed=seed,
            ),
            record=record,
            mode=mode,
            callback=callback,
            keep=keep,
            parameters=parameters,
        )

    def play(
        self,
        protocol: Protocol,
        *,
        record: str | Path | None = None,
        mode: str = "x",
        callback: Callable[[State], object] | None = None,
        keep: bool = True,
        parameters: Mapping[str, Any] | None = None,
    ) -> Run:
        """Take the steps of a protocol: one of this package, or a user's own, see `Protocol`.

            sim.play(Tap(amplitude=0.01, steps=20), record="taps")

        Args:
            protocol: with its settings; the simulation ends in the state after its last step.
            record: folder of the run, as in `compress`, as all that follows.
            mode: of the folder.
            callback: called with each state.
            keep: whether the result has all states.
            parameters: for the summary.

        Returns:
            The states: that before the first step, then that after each step.

        Raises:
            ParameterError: an argument is out of range or of another kind.
            TypeError: the callback returns something else than None and a bool.
            FileError: see `compress`.
        """
        from ..protocols.recording import play

        return play(self, protocol, record, mode, callback, keep, parameters)

    def state(self) -> State:
        """The present state, not relaxed."""
        return self.engine.state(self, self.engine.forces(self), converged=True)

    @property
    def callback(self) -> Callback | None:
        """Called with an `Iteration` where a relaxation begins, and after each call of a minimizer.

        The last one is that of the relaxed state. Calls of L-BFGS take 1000 iterations, those of
        FIRE 2000 or more, unless forces are small enough before. The function must leave the
        simulation as it is. Its exception ends the relaxation where it is, at rest. None calls
        nothing.

            sim.callback = lambda seen: print(seen.iterations, seen.residual)

        Raises:
            ParameterError: it cannot be called.
        """
        return self._callback

    @callback.setter
    def callback(self, callback: Callback | None) -> None:
        check_callback(callback)
        self._callback = callback

    def relax(
        self,
        tolerance: float | None = None,
        *,
        pressure: float | None = None,
        free: str = "iso",
        max_steps: int | None = None,
        vary: str | None = None,
        stiffness: float | None = None,
        moments: ArrayLike | None = None,
    ) -> State:
        """Minimize the energy until no force exceeds a part of the mean contact force.

        L-BFGS or FIRE in LAMMPS, see `Simulation`; smooth polygons take steps of Newton's method. A
        tolerance that these do not reach, because the contact lines of `balanced` and `curved`
        rings are balanced to 1e-8, ends with Newton's method on the contact network, a few steps
        with lines balanced to rounding. Close to the onset of jamming rounding may keep forces of
        rings at 1e-9, as they are cubes of tiny indentations.

        Forces of a user's fixes count that act in minimizations too, such as *fix addforce*. With
        friction particles move until they rest, as velocities and spins decay, and all fixes act.

        Args:
            tolerance: largest force on a particle, and with friction torque over its radius, over
                the mean contact force; of polygons that on a bead over that on a bead in a contact.
                1e-6 if not given, 1e-3 for polygons of beads. In a loose packing the mean contact
                force only falls.
            pressure: of the state, of droplets the osmotic one; the box is free to reach it, to
                1e-6 of it [energy/length^d]. It may be 0 where particles stick, to 1e-6
                tension/radius.
            free: what is free at a pressure: `iso` the size of the box alone, `aniso` its sides,
                or `tri` the shape, which ends without shear stress.
            max_steps: of the minimizer at most, as a patience; without it ends by itself where
                forces do not fall any more.
            vary: `radii`, of `Ring`, `SoftContact` and `Droplet`: particles breathe. With their
                radii R_i0 at the beginning, energy + stiffness/2 sum (R_i - R_i0)^2 is least over
                centers and radii, until its derivatives by radii are below the tolerance, too. The
                packing fraction is kept; the state has the new radii.
            stiffness: of radii, 0 or above, needed to vary them [energy/length^2].
            moments: powers m of the radii whose sums are kept as well, 1 if not given; (-3, 1, 6)
                lets a distribution keep its shape where the stiffness is small.

        Returns:
            The relaxed state; its `converged` is false if the tolerance was not reached.

        Raises:
            ParameterError: a value is out of range, or the pressure cannot be reached, or it is
                given with friction; or gravity pulls the particles where no wall holds them; or
                with friction a motion has not ended; or a polygon reached its own image.
            LammpsError: LAMMPS gave up, e.g. because a contact line is behind a center; a particle
                has no area left; or LAMMPS was given commands that states cannot follow, or a fix
                whose forces act in motion only, such as *fix gravity*; or the forces of droplets
                have no solution, far beyond the model.

        Warns:
            UnjammedWarning: a packing that was rigid has become loose without expanding. The one at
                the start counts as rigid if its forces balance, by the law or as soft disks.
            StalledWarning: forces stopped falling, or contacts far beyond the model do not balance.
            BeyondModelWarning: outlines have a negative radius of curvature, e.g. past confluence;
                or droplets have a load above 0.4, or one above 0.05 in the mean facet.

        Source: FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006), in the form of Guenole et
        al., Comput. Mater. Sci. 175, 109584 (2020). L-BFGS: Nocedal, Math. Comp. 35, 773 (1980),
        preconditioned by the springs of contacts.
        """
        if vary is None:
            for name, given in (("stiffness", stiffness), ("moments", moments)):
                if given is not None:
                    raise ParameterError(
                        f"{name}={shown(given)} is of radii: give vary='radii' too"
                    )
            return relax_above(self, tolerance, 0.0, pressure, free, max_steps)
        if vary != "radii" or stiffness is None or pressure is not None:
            raise ParameterError(
                "vary takes 'radii', with a stiffness and without a pressure, not "
                f"vary={shown(vary)}, stiffness={shown(stiffness)}, pressure={shown(pressure)}"
            )
        tolerance = positive("tolerance", self.engine.tolerance if tolerance is None else tolerance)
        if max_steps is not None:
            count("max_steps", max_steps)
        relax = partial(relax_above, self, tolerance)
        kept = 1.0 if moments is None else moments
        return relax_radii(self, stiffness, kept, tolerance, max_steps, relax)

    def _relaxed(self, tolerance: float, least: float, max_steps: int | None) -> State:
        """The state relaxed in its box."""
        engine, first = self.engine, self.lmp.extract_global("ntimestep")

        def seen(forces: Forces) -> Forces:
            self._tell(forces, self.lmp.extract_global("ntimestep") - first)
            return forces

        aim = max(tolerance, minimizers_reach(self, tolerance))
        self.engine.fell_back = False
        forces = minimize_until_relaxed(
            seen(engine.begin(self, least)),
            aim,
            engine.patience,
            engine.minimizer(self, aim),
            lambda: seen(engine.after(self, least)),
            engine.indicator,
            max_steps,
        )
        rest(self.lmp)  # FIRE leaves velocities
        unbalanced = engine.unbalanced(self, tolerance)
        state = engine.state(self, forces, forces.residual <= tolerance and not unbalanced)
        finer = not state.converged or tolerance < aim  # then contacts are balanced more closely
        if finer and max_steps is None and not unbalanced and can_polish(self, state):
            state = polish(self, state, tolerance)
        unjammed = engine.loose is not None and self._rigidity.lost(
            state.packing.phi, engine.loose, self._balanced
        )
        if self.comm.rank == 0:
            warn_of(state, tolerance, unjammed, engine.scale)
        return replace(
            state,
            minimizer=self.minimizer + ", fire" * self.engine.fell_back,
            iterations=int(self.lmp.extract_global("ntimestep")) - first,
        )

    def _tell(self, forces: Forces, iterations: int) -> None:
        """Tell the callback, if there is one, of the last evaluation."""
        if self.callback is None or not np.isfinite(forces.largest):
            return
        if not self.friction:
            rest(self.lmp)  # FIRE begins without velocities
        free = containers.free_room(self._walls, self.box)
        tensor = stress(self.lmp, free if self._walls else None)
        phi, pressure = self.engine.filled() / free, float(np.trace(tensor) / len(tensor))
        root = self.comm.rank == 0
        seen = Iteration("relax", iterations, phi, pressure, forces.residual, root)
        tell(self.callback, seen, self.comm)

    def _balanced(self, packing: Packing) -> bool:
        """Whether contact forces about balance in a packing."""
        with Simulation(packing, self.law, comm=self.comm, gravity=self.gravity) as sim:
            return sim.state().residual <= BALANCED and not sim.engine.loose


def _least_pull(sim: Simulation) -> float:
    """What the mean force of films counts as at least: a part of w R^(d - 2) [energy/length].

    The films of a floppy gel bear nothing at rest, and no force is small beside that.
    """
    adhesion = max(float(np.max(sim.law.adhesion)), *(wall.adhesion for wall in sim._walls), 0.0)
    return _PULL * adhesion * float(sim._facet ** ((sim.dimension - 2) / (sim.dimension - 1)))


def relax_above(
    sim: Simulation,
    tolerance: float | None = None,
    least: float = 0.0,
    pressure: float | None = None,
    free: str = "iso",
    max_steps: int | None = None,
) -> State:
    """As `relax`, where the mean contact force counts as at least so much [energy/length]."""
    tolerance = positive("tolerance", sim.engine.tolerance if tolerance is None else tolerance)
    if max_steps is not None:
        count("max_steps", max_steps)
    if not sim.friction:
        refuse_forces_of_motion(sim.lmp)
    check_free(free, sim._walls, pressure, sim.law, sim.friction)
    if sim.gravity is not None and not has_other_fixes(sim.lmp, sim.engine.setup):
        species = gather(sim.lmp, "type", 1).astype(np.int64) - 1
        check_held(sim.gravity, species, sim._walls)
    if isinstance(sim.law, Ring | Droplet) and sticks(sim.law, sim._walls):
        least = max(least, _least_pull(sim))
    if pressure is not None:
        least = max(least, pressure * sim._facet)
        return relax_free_box(
            sim, pressure, free, lambda: sim._relaxed(tolerance, least, max_steps)
        )
    return sim._relaxed(tolerance, least, max_steps)


def _parts(given: Packing | State) -> tuple[Packing, State | None]:
    """The packing, and the state if it is one."""
    return (given, None) if isinstance(given, Packing) else (given.packing, given)


# Forces over those of contacts of a rigid start; rounding of phi.
BALANCED, _ROUNDING = 0.1, 1e-12


class Rigidity:
    """What relaxed states of a simulation tell, one after the other.

    Args:
        start: where the simulation started; None if that does not count.

    Attributes:
        start: the start, until the first state is relaxed.
        phi: packing fraction of the last rigid packing; infinite without.
    """

    def __init__(self, start: Packing | None) -> None:
        self.start, self.phi = start, np.inf

    def lost(self, phi: float, loose: bool, balanced: Callable[[Packing], bool]) -> bool:
        """Whether a packing is loose at this phi, and was rigid at this or a lower one.

        Args:
            phi: of the undeformed particles.
            loose: whether it is loose now.
            balanced: whether contact forces of the law about balance in a packing.
        """
        start, self.start = self.start, None  # what came before counts from the second state on
        dense = start is not None and loose and phi >= (1.0 - _ROUNDING) * start.phi
        if start and dense and (_holds_disks(start) or balanced(start)):
            self.phi = 0.0
        lost = loose and phi >= self.phi
        self.phi = np.inf if loose else phi
        return lost


def _holds_disks(packing: Packing) -> bool:
    """Whether forces of soft disks about balance, as in `jam`."""
    disks = relax_in_box(packing, np.inf, 0.0, lambda *_: None)  # at once: they do not move
    return disks.pressure > 0.0 and disks.residual <= BALANCED
