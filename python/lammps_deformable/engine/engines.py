"""What differs by law in a simulation: one small object for each, with the methods of `Engine`.

`polygon_engine` has that of polygons. An engine belongs to one `Simulation`, which calls it.
"""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import fractional
from ..common.checks import shown
from ..common.errors import LammpsError, ParameterError
from ..common.ranks import alone
from ..core import dot, unit_vectors
from ..particles.commands import (
    SOFT_STEP,
    film_commands,
    fire_commands,
    law_commands,
    list_commands,
    memory_commands,
    pair_style,
    soft_commands,
)
from ..particles.containers import Distances, check_centers, check_fit
from ..particles.friction import (
    FRICTION,
    Friction,
    Rubbing,
    check_friction,
    friction_commands,
    has_films,
    rubbing_step,
    spring_commands,
)
from ..particles.gravity import gravity_commands, gravity_energy
from ..particles.laws import (
    LARGEST_LOAD,
    STIFFNESS_PER_PRESSURE,
    Droplet,
    Law,
    Ring,
    Sector,
    SoftContact,
    check_dimension,
    check_sticky_walls,
    filled_area,
    natural_pressure,
    refuse_adhesion,
    refuse_values_of_particles,
    sticks,
    undeformed,
)
from ..particles.packing import Packing, packing_of_species, with_own_radii
from ..particles.species_file import species_file
from ..state.contacts import ROWS, ContactTable, Later, attached
from ..state.rubbing import RUBBING_ROWS, rubbing_table
from ..state.state import State
from .lammps import (
    Setup,
    gather,
    has_other_fixes,
    images_of,
    local_array,
    open_lammps,
    place,
    place_images,
    place_velocities,
    place_walls,
    refuse_other,
    refuse_without_area,
    run,
    run_forces,
    shared_file,
    threads_of,
    unsaved,
    wall_forces,
)
from .relax import (
    NO_FORCE,
    TOLERANCE,
    USUAL,
    Fire,
    Forces,
    Minimizer,
    damp,
    force_rounding,
    largest_force,
    lbfgs_or_fire,
    minimize_command,
    thermo_commands,
)
from .stress import stress, virial_command

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from lammps import lammps
    from mpi4py import MPI

    from ..formats.store import Motion
    from ..particles.walls import Wall
    from .simulation import Simulation

Floats = NDArray[np.float64]

# Set anew before each state: its energy must not depend on the thermo output of a user.
THERMO = thermo_commands("c_deformable_energy c_deformable_beyond[1]").strip()

# What the pair style tells beside its energy, numbers of its compute.
BEYOND, IMBALANCE, LOST = 0, 3, 5

# Of LAMMPS in units lj.
_TIMESTEP = 0.005

# Energy and stress of the contacts alone: forces that a user adds have no place in a saved state.
_COMPUTES = """
compute deformable_energy all pe pair
compute deformable_beyond all pair {style}
"""


def packing_in(sim: Simulation, radii: Floats) -> Packing:
    """The packing that LAMMPS has, of species of these radii.

    Commands given to `lmp` may have changed the species and radii of particles.
    """
    own = sim.lmp.extract_setting("radius_flag")
    return packing_of_species(
        gather(sim.lmp, "x", 3)[:, : sim.dimension],
        gather(sim.lmp, "type", 1).astype(np.int64) - 1,
        radii,
        sim.box,
        gather(sim.lmp, "radius", 1) if own else None,
        sim.walls,
    )


def _of_all(names: NDArray[np.int64] | None, number: int) -> NDArray[np.int64] | None:
    """Labels of so many particles; None if commands to `lmp` have added or deleted some."""
    return names if names is not None and len(names) == number else None


# Relative change of area and perimeter below which a particle counts as round, that of an
# indentation of 1e-7 R: the energy of a loose packing only tends to zero.
_ROUND = 1e-14


def evaluate(
    lmp: lammps, style: str, walls: Sequence[Wall], names: Sequence[str], columns: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Evaluate forces at the present positions.

    Results of the pair style for each particle come from *fix pair*. It reads them once in a time
    step, but a run of no steps does not advance the step. So each evaluation defines the fix anew,
    and removes it again: it would slow down minimizations and runs.

    Args:
        lmp: with this pair style.
        style: of the pairs.
        walls: around the particles.
        names: of the results.
        columns: of the rows of contacts.

    Returns:
        The results of all particles, shape (N, number of names), and the rows of the contacts on
        this rank, shape (M, columns).
    """
    results = " ".join(f"{name} 0" for name in names)
    run(
        lmp,
        f"{THERMO}\n"
        f"fix deformable_results all pair 1 {style} {results}\n"
        "compute deformable_rows all deformable/contact",
    )
    try:
        run_forces(lmp, "run 0 post no", walls)
        of_particles = gather(lmp, "f_deformable_results", len(names))
        return of_particles, local_array(lmp, "deformable_rows", columns)
    finally:
        run(lmp, "unfix deformable_results\nuncompute deformable_rows")


def are_round(
    area: NDArray[np.float64], perimeter: NDArray[np.float64], radius: NDArray[np.float64]
) -> bool:
    """Whether particles of these radii are circles, as in a loose packing, shape (N,)."""
    strain = 1.0 - area / (np.pi * radius**2) + perimeter / (2.0 * np.pi * radius) - 1.0
    return bool(np.abs(strain).max() <= _ROUND)


def contacts_of(
    lmp: lammps,
    comm: MPI.Comm,
    rows: NDArray[np.float64],
    packing: Packing,
    friction: Friction | None,
    one_force: bool = True,
) -> tuple[ContactTable | Later, Rubbing | None]:
    """The table of contacts after an evaluation; and what goes on where they rub.

    Args:
        lmp: with the fix of friction, if there is one.
        comm: its ranks.
        rows: of the contacts on all ranks.
        packing: of the particles.
        friction: of the contacts.
        one_force: see `Later`.
    """
    if friction is None:
        return Later(rows, packing, one_force), None
    columns = RUBBING_ROWS[packing.dimension] + (4 if friction.ledger else 0)
    own = local_array(lmp, FRICTION, columns, fix=True)
    rubbing = np.concatenate(comm.allgather(own))
    table, springs, places = rubbing_table(rows, packing, rubbing, has_films(friction))
    stored, *lost = (lmp.extract_fix(FRICTION, 0, 1, n) for n in (0, 1, 2, 3, 6))
    omega = gather(lmp, "omega", 3)
    spins = np.ascontiguousarray(omega[:, 2]) if packing.dimension == 2 else omega
    each = gather(lmp, f"f_{FRICTION}", 4) if friction.ledger else None
    return table, Rubbing(spins, springs, tuple(lost), stored, places, each)


# Iterations without halving the largest force after which a relaxation counts as stalled.
_PATIENCE = 60_000

# Imbalance of contacts at most.
UNBALANCED = 0.01

# Results of the pair styles for each particle, by their names in *fix pair*.
_OF_RINGS = ("area", "perimeter", "contacts", "pressure", "arc_radius", "contact_length")
_OF_DROPLETS = ("area", "contacts", "contact_area", "pressure", "load")


class Engine:
    """What all laws have. Further methods of each:

    check(packing, friction): refuse what the law cannot have; nothing is changed.
    open(sim, packing, former): a LAMMPS with the packing, the former one if there is one.
    follow(sim, walls, box): refuse or take the walls of a new box.
    forces(sim, least): evaluate forces and results of particles at the present positions.
    begin, after: the same before a relaxation, and after a call of the minimizer.
    minimizer(sim, tolerance): a function that calls the minimizer once, see `relax.Minimizer`.
    filled(): area or volume of the particles at the last evaluation.
    state(sim, forces, converged): the state at the last evaluation.

    Attributes:
        minimizers: that relax it, the usual one first.
        tolerance: of a relaxation, if none is given.
        patience: iterations without progress after which a relaxation counts as stalled.
        scale: of the forces, in words.
        indicator: what falls while a relaxation goes on; None: the patience is for all of it.
        loose: whether no contact bears a force; None: nobody asks.
        law: of the particles.
        setup: what LAMMPS had when it was filled.
        begun: how often it has been filled.
        steps_before: steps of LAMMPS before it began to count them.
        lost: energy that films had lost before LAMMPS began to count it [energy].
        labels, clones: of the particles, see `State`.
        imbalance: of contacts, over the largest force.
        fell_back: whether FIRE went on where L-BFGS failed, in the last relaxation.
    """

    minimizers: tuple[str, ...] = ("lbfgs", "fire")
    tolerance, patience, scale = TOLERANCE, 0, "the mean contact force"
    indicator: Callable[[Forces], float] | None = None
    loose: bool | None = None
    law: Any
    setup: Setup
    begun, steps_before, lost = 0, 0, 0.0
    labels: NDArray[np.int64] | None = None
    clones: NDArray[np.int64] | None = None
    imbalance, fell_back = USUAL, False

    def chosen(self, minimizer: str | None, friction: Friction | None) -> str:
        """The minimizer, or the first one that the law can have."""
        choice = ("damped",) if friction else self.minimizers
        if minimizer is None:
            return choice[0]
        if minimizer not in choice:
            raise ParameterError(
                f"minimizer must be {' or '.join(map(repr, choice))} for "
                f"{'contacts that rub' if friction else type(self.law).__name__}, "
                f"not {shown(minimizer)}"
            )
        return minimizer

    def opened(self, packing: Packing, friction: Friction | None) -> Packing:
        """The packing as LAMMPS gets it."""
        return packing

    def go_on(self, sim: Simulation, motion: Motion) -> None:
        """Take the time and strain of a motion; the particles are at rest."""
        sim.time, sim.shear_strain, sim.directions = motion.time, motion.strain, None

    def number(self, lmp: lammps) -> int:
        """Of particles."""
        return int(lmp.get_natoms())

    def unbalanced(self, sim: Simulation, tolerance: float) -> bool:
        """Whether forces say nothing, because contacts do not balance."""
        return False


class Deformables(Engine):
    """What rings, sectors and droplets have in common: a pair style of the plugin."""

    patience = _PATIENCE

    def __init__(self, law: Any) -> None:
        self.law, self.loose, self.indicator = law, True, attrgetter("largest")
        if isinstance(law, Sector):  # its energy jumps
            self.minimizers = ("fire",)

    def check(self, packing: Packing, friction: Friction | None) -> None:
        """Refuse what the law cannot have."""
        check_dimension(self.law, packing.dimension)
        refuse_values_of_particles(self.law, packing)
        species_file(self.law, packing.species_radii)
        if friction:
            check_friction(friction, packing, self.law)
        self._check_walls(packing.walls, packing.box, packing.species_radii)
        if packing.walls:
            check_centers(packing.walls, packing.box, packing.positions)
            check_sticky_walls(packing, self.law)

    def opened(self, packing: Packing, friction: Friction | None) -> Packing:
        """The packing; with friction particles have radii of their own, which lets them turn."""
        return with_own_radii(packing) if friction and not packing.own_radii else packing

    def open(self, sim: Simulation, packing: Packing, former: lammps | None) -> lammps:
        """LAMMPS with the packing, the law, walls and friction, and the computes of states."""
        self._radii = packing.species_radii
        lmp, friction = open_lammps(packing, sim.comm, former), sim.friction
        with shared_file(sim.comm, species_file(self.law, self._radii)) as file:
            run(lmp, law_commands(packing, self.law, file, threads_of(lmp, sim.threads)))
        place_walls(lmp, packing.walls)
        run(lmp, film_commands(self.law, packing.walls))
        run(lmp, friction_commands(friction, len(self._radii)) + gravity_commands(sim.gravity))
        if friction:  # evaluations have a time step too
            run(lmp, f"timestep {min(rubbing_step(friction), _TIMESTEP)!r}")
        stress_of = virial_command("pair fix" if packing.walls or friction else "pair")
        run(lmp, stress_of + _COMPUTES.format(style=pair_style(self.law)) + THERMO)
        self._smallest_radius = float(packing.radii.min())
        return lmp

    def _check_walls(self, walls: tuple[Wall, ...], box: Floats, radii: Floats) -> None:
        reach = 1.0 + (self.law.reach if isinstance(self.law, (Ring, Droplet)) else 0.0)
        check_fit(walls, box, reach * float(radii.max()))

    def follow(self, sim: Simulation, walls: tuple[Wall, ...], box: Floats) -> None:
        """Place the walls of a new box."""
        self._check_walls(walls, box, self._radii)
        if walls:
            place_walls(sim.lmp, walls, former=sim.walls)

    def go_on(self, sim: Simulation, motion: Motion) -> None:
        """Let particles go on with a motion, where they are those of the same moment."""
        lmp, rubbing = sim.lmp, motion.rubbing
        place_velocities(lmp, motion.velocities)
        if sticks(self.law, sim.walls):  # films of another law are gone
            run(lmp, "\n".join(memory_commands(motion.films)))
        if rubbing is not None and lmp.has_id("fix", FRICTION):
            spins = rubbing.spins
            place(lmp, "omega", spins if spins.ndim == 2 else np.outer(spins, [0.0, 0.0, 1.0]))
            run(lmp, spring_commands(sim.friction, rubbing))
            if sim.friction and sim.friction.ledger and rubbing.by_particle is not None:
                place(lmp, f"f_{FRICTION}", rubbing.by_particle)
        if motion.images is not None and motion.images.any():
            place_images(lmp, motion.images)
        sim.time, sim.shear_strain, sim.directions = motion.time, motion.strain, motion.directions
        self.lost, self.labels, self.clones = motion.lost, motion.labels, motion.clones

    def unbalanced(self, sim: Simulation, tolerance: float) -> bool:
        return told(sim.lmp, IMBALANCE) > max(tolerance, UNBALANCED)

    def _particles(self, sim: Simulation) -> None:
        """Take species and radii from LAMMPS: commands given to `lmp` may have changed them."""
        refuse_other(sim.lmp, self.setup)
        self._species = gather(sim.lmp, "type", 1).astype(np.int64) - 1
        by_particle = sim.lmp.extract_setting("radius_flag")
        self._particle_radii = gather(sim.lmp, "radius", 1) if by_particle else None

    @property
    def _radius(self) -> Floats:
        own = self._particle_radii
        return self._radii[self._species] if own is None else own

    def _all_lost(self, sim: Simulation, rubbing: Rubbing | None) -> float:
        """Energy lost so far, before LAMMPS counted it too: by films and by friction."""
        return self.lost + told(sim.lmp, LOST) + sum(rubbing.lost if rubbing else ())

    def _common(self, sim: Simulation, forces: Forces, converged: bool) -> dict[str, Any]:
        """What states of all these laws have."""
        dimension = sim.dimension
        packing = packing_in(sim, self._radii)
        images = images_of(sim.lmp)
        elastic = float(sim.lmp.extract_compute("deformable_energy", 0, 0))
        return {
            "packing": packing,
            "law": self.law,
            "energy": elastic + gravity_energy(sim.gravity, packing, images),
            "gravity": sim.gravity,
            "pressure_tensor": stress(sim.lmp, packing.volume if packing.walls else None),
            "residual": forces.residual,
            "converged": converged,
            "beyond": round(told(sim.lmp, BEYOND)),
            "velocities": gather(sim.lmp, "v", 3)[:, :dimension],
            "_root": sim.comm.rank == 0,
            "wall_forces": wall_forces(sim.lmp, sim.walls),
            "time": sim.time,
            "shear_strain": sim.shear_strain,
            "labels": _of_all(self.labels, len(packing)),
            "clones": _of_all(self.clones, len(packing)),
            "unsaved": unsaved(sim.lmp, self.setup),
            "images": images,
        }


class Rings(Deformables):
    """Particles of the plane with the law `Ring` or `Sector`."""

    law: Law

    def open(self, sim: Simulation, packing: Packing, former: lammps | None) -> lammps:
        """As that of all, with the scales of forces and times of this packing."""
        lmp = super().open(sim, packing, former)
        self._largest_radius = float(packing.radii.max())
        stiffness = self.law.single_contact_stiffness(self._smallest_radius)
        self._single_contact_pressure = stiffness / STIFFNESS_PER_PRESSURE
        self._single_contact_force = stiffness * self._smallest_radius
        self._natural_pressure = natural_pressure(packing, self.law)
        return lmp

    def forces(self, sim: Simulation, least: float = 0.0) -> Forces:
        """Bring forces and results of the particles up to date; returns the forces."""
        self._particles(sim)
        self._results, self._rows = evaluate(
            sim.lmp, pair_style(self.law), sim.walls, _OF_RINGS, len(ROWS[2])
        )
        area, perimeter, contacts, pressure, _, length = self._results.T
        self._skin = self.law.species_parameters(self._radii).skin[self._species]
        self._largest_pressure = float(pressure.max())
        self.loose = are_round(area, perimeter, self._radius - self._skin)
        total, number = dot(pressure, length), float(max(contacts.sum(), 1.0))
        mean = self._single_contact_force if self.loose else total / number
        largest = largest_force(sim.lmp, self._particle_radii if sim.friction else None)
        if not np.isfinite(largest):
            raise LammpsError(
                "forces are no numbers any more, far beyond the model: separate particles that "
                "overlap (push_off), compress less, or in smaller steps"
            )
        self._others = others_push(sim, largest, total)
        scale = max(mean, least) or self._others * largest
        none = NO_FORCE * self._natural_pressure * self._smallest_radius
        return Forces(largest, scale, none if sim.friction else 0.0)

    begin = after = forces

    def minimizer(self, sim: Simulation, tolerance: float) -> Minimizer:
        """L-BFGS or FIRE; with friction damped motion."""
        fire = Fire()

        def call(forces: Forces, left: int, most: int) -> int:
            highest = self._largest_pressure
            # the force of a user's fix takes the place of pressures, as long as particles fall
            others = self._others and forces.largest / self._largest_radius
            stiffest = max(highest, self._single_contact_pressure, others)
            if sim.friction:
                pressures = stiffest, forces.scale / self._largest_radius, self._natural_pressure
                return damp(sim.lmp, sim.friction, *pressures, sim.walls, 2)
            force = 0.5 * tolerance * forces.scale  # the scale falls a little further meanwhile
            run_forces(sim.lmp, fire.call(highest, stiffest, force, most), sim.walls)
            return left if told(sim.lmp, IMBALANCE) > tolerance else fire.iterations

        return call if sim.friction else lbfgs_or_fire(sim, tolerance, call, self._smallest_radius)

    def filled(self) -> float:
        """Area of all particles at the last evaluation."""
        return float(np.sum(filled_area(self._results[:, 0], self._results[:, 1], self._skin)))

    def state(self, sim: Simulation, forces: Forces, converged: bool) -> State:
        """The state at the last evaluation."""
        area, perimeter, contacts, pressure, arc_radius, _ = np.ascontiguousarray(self._results.T)
        refuse_without_area(area)
        common = self._common(sim, forces, converged)
        rows = np.concatenate(sim.comm.allgather(self._rows))
        one_force = isinstance(self.law, Ring) and self.law.contact != "radical"
        table, rubbing = contacts_of(
            sim.lmp, sim.comm, rows, common["packing"], sim.friction, one_force
        )
        return State(
            **common,
            results={
                "area": area,
                "perimeters": perimeter,
                "pressures": pressure,
                "n_contacts": contacts.astype(np.int64),
                "arc_radii": arc_radius,
            },
            _table=table,
            films=attached(rows, 2) if sticks(self.law, sim.walls) else None,
            lost_energy=self._all_lost(sim, rubbing),
            friction=sim.friction,
            rubbing=rubbing,
        )


# Time step of FIRE over sqrt(mass/stiffness), with the tension as the stiffness of a contact.
_OF_FIRE = 0.05

# Iterations of one call of FIRE; and beyond the model, where forces may have several solutions.
# There each counts for so many, as energies that jump have no minimum to be found.
_ITERATIONS, _FEW, _DEARER = 2000, 50, 30


class Droplets(Deformables):
    """Droplets in three dimensions, with the law `Droplet`."""

    law: Droplet

    def open(self, sim: Simulation, packing: Packing, former: lammps | None) -> lammps:
        """As that of all, with the largest tension of this packing."""
        lmp = super().open(sim, packing, former)
        tension = self.law.species_parameters(packing.species_radii).tension
        self._stiffness = float(tension.max())
        return lmp

    def forces(self, sim: Simulation, least: float = 0.0) -> Forces:
        """Bring forces and results of the particles up to date; returns the forces."""
        self._particles(sim)
        self._results, rows = evaluate(
            sim.lmp, pair_style(self.law), sim.walls, _OF_DROPLETS, len(ROWS[3])
        )
        _refuse_no_numbers(self._results)
        self._rows = np.concatenate(sim.comm.allgather(rows))
        force = self._rows[:, ROWS[3].index("force")]
        self.loose = not force.any()
        mean = 0.0 if self.loose else float(np.abs(force).mean())
        largest = largest_force(sim.lmp, self._particle_radii if sim.friction else None)
        others = others_push(sim, largest, float(force.sum()))
        scale = max(mean, least) or others * largest
        rounding = 0.0 if sim.friction else force_rounding(sim.box, self._stiffness)
        return Forces(largest, scale, rounding)

    begin = after = forces

    def minimizer(self, sim: Simulation, tolerance: float) -> Minimizer:
        """L-BFGS or FIRE; with friction damped motion."""
        timestep = f"timestep {_OF_FIRE / self._stiffness**0.5!r}\n"

        def call(forces: Forces, left: int, most: int) -> int:
            if told(sim.lmp, IMBALANCE) > UNBALANCED:
                return left
            if sim.friction:
                stiffness = self._stiffness, forces.scale / self._smallest_radius, self._stiffness
                return damp(sim.lmp, sim.friction, *stiffness, sim.walls, 3)
            force = 0.5 * tolerance * forces.scale  # the scale falls a little further meanwhile
            beyond = told(sim.lmp, BEYOND) > 0
            count = min(left, _FEW if beyond else _ITERATIONS, most)
            run_forces(sim.lmp, timestep + minimize_command(force, count), sim.walls)
            return count * _DEARER if beyond else count

        return call if sim.friction else lbfgs_or_fire(sim, tolerance, call, self._smallest_radius)

    def filled(self) -> float:
        """Volume of all droplets at the last evaluation."""
        return undeformed(self._radius, 3)

    def state(self, sim: Simulation, forces: Forces, converged: bool) -> State:
        """The state at the last evaluation."""
        area, contacts, contact_area, pressure, load = np.ascontiguousarray(self._results.T)
        common = self._common(sim, forces, converged)
        table, rubbing = contacts_of(sim.lmp, sim.comm, self._rows, common["packing"], sim.friction)
        return State(
            **common,
            results={
                "surface_areas": area,
                "pressures": pressure,
                "loads": load,
                "contact_areas": contact_area,
                "n_contacts": contacts.astype(np.int64),
            },
            _table=table,
            films=attached(self._rows, 3) if sticks(self.law, sim.walls) else None,
            lost_energy=self._all_lost(sim, rubbing),
            friction=sim.friction,
            rubbing=rubbing,
        )


def _refuse_no_numbers(results: Floats) -> None:
    """Raise an error if the law has lost its solution, far beyond the model."""
    wrong = np.flatnonzero(~np.isfinite(results).all(axis=1))
    if len(wrong) > 0:
        raise LammpsError(
            f"the load of droplet {wrong[0]} is no number any more, as loads far above "
            f"{LARGEST_LOAD:g} have no solution: compress less, or in smaller steps"
        )


def told(lmp: lammps, n: int) -> float:
    """What the pair style tells beside its energy; 0 of a law that does not."""
    numbers = lmp.numpy.extract_compute("deformable_beyond", 0, 1)
    return float(numbers[n]) if n < len(numbers) else 0.0


def others_push(sim: Simulation, largest: float, total: float) -> bool:
    """Whether gravity or a user's fix moves particles: all contacts together bear less than a
    force.
    """
    moves = sim.gravity is not None or has_other_fixes(sim.lmp, sim.engine.setup)
    return largest > total and moves


_CONTACTS = """
compute overlaps all pair/local dist force cutoff {cutoff}
timestep {timestep!r}
"""

# Walls repel particles as other particles do, U = k/2 (R - h)^2 at the distance h.
_WALLS = """
fix deformable_walls all external pf/callback 1 1
fix_modify deformable_walls virial yes
"""

# Centers closer than this part of the box are at one place, where a contact has no direction. They
# are separated by this part of the smallest radius, on a spiral of golden angles.
_SAME_PLACE = 1e-12
_SEPARATION = 1e-3
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))

# Iterations after which a relaxation counts as stalled: large packings relax slowly near the onset.
_SOFT_PATIENCE = 2_000_000


class SoftParticles(Engine):
    """Soft disks or spheres, with the law `SoftContact`, by LAMMPS' own pair styles.

    Every rank does the same work: relaxation near jamming is chaotic, so that results of shared
    work would depend on the number of ranks.
    """

    minimizers, patience = ("fire",), _SOFT_PATIENCE

    def __init__(self, law: SoftContact) -> None:
        self.law = law

    def check(self, packing: Packing, friction: Friction | None) -> None:
        """Refuse friction, and walls that do not fit."""
        if friction:
            raise ParameterError("soft contacts have no friction: take the law Ring")
        refuse_adhesion(self.law, packing.walls, " to walls, and soft contacts have none")
        check_fit(packing.walls, packing.box, float(packing.radii.max()))

    def opened(self, packing: Packing, friction: Friction | None) -> Packing:
        """The packing without centers at one place."""
        return separated(packing)

    def open(self, sim: Simulation, packing: Packing, former: lammps | None) -> lammps:
        """LAMMPS with the packing and its walls."""
        self._radii, self._radius = packing.species_radii, packing.radii
        self._dimension = packing.dimension
        self._distances = Distances(packing.walls, packing.box)
        lmp = open_disks(packing, alone(), self.law.k, former)
        if packing.walls:
            run(lmp, _WALLS)
            lmp.set_fix_external_callback("deformable_walls", self._repel, lmp)
        return lmp

    def follow(self, sim: Simulation, walls: tuple[Wall, ...], box: Floats) -> None:
        """Take the walls of a new box."""
        check_fit(walls, box, float(self._radius.max()))
        self._distances = Distances(walls, box)

    def _overlaps(
        self, x: Floats, number: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], Floats, Floats, Floats]:
        """Contacts with walls: their positions, overlaps, distances, and directions, (n, d).

        Args:
            x: positions, shape (n, d) [length].
            number: of the particles at these positions, from 0, shape (n,).
        """
        i, _, out, distance = self._distances.contacts(x, float(self._radius.max()))
        return i, np.maximum(self._radius[number[i]] - distance, 0.0), distance, out

    def _repel(self, lmp: lammps, _step: int, _n: int, tag: Any, x: Any, f: Any) -> None:
        """Forces of the walls and their virial, for LAMMPS."""
        dimension = lmp.extract_setting("dimension")
        i, overlap, distance, out = self._overlaps(x[:, :dimension], tag - 1)
        forces = -self.law.k * overlap[:, None] * out
        f[:] = 0.0
        np.add.at(f, (i[:, None], np.arange(dimension)), forces)
        virial = np.zeros((3, 3))
        virial[:dimension, :dimension] = (-distance[:, None] * out).T @ forces
        xx, xy, xz, _, yy, yz, _, _, zz = virial.ravel().tolist()
        lmp.fix_external_set_virial_global("deformable_walls", [xx, yy, zz, xy, xz, yz])

    def begin(self, sim: Simulation, least: float) -> Forces:
        """The forces before a relaxation: their scale is in the contacts, or given."""
        if least == 0.0:
            return self.forces(sim)
        refuse_other(sim.lmp, self.setup)
        self._radius = packing_in(sim, self._radii).radii
        return Forces(np.inf, least, force_rounding(sim.box, self.law.k))

    def forces(self, sim: Simulation, least: float = 0.0) -> Forces:
        """The forces at the present positions."""
        refuse_other(sim.lmp, self.setup)
        self._radius = packing_in(sim, self._radii).radii  # for the walls
        run(sim.lmp, "run 0 post no")
        return self.after(sim, least)

    def after(self, sim: Simulation, least: float) -> Forces:
        """The forces of the last run."""
        positions = gather(sim.lmp, "x", 3)[:, : sim.dimension]
        _, overlap, *_ = self._overlaps(positions, np.arange(len(positions)))
        pairs = local_array(sim.lmp, "overlaps", 2)[:, 1]
        self._contact_forces = np.append(pairs, self.law.k * overlap[overlap > 0.0])
        mean = float(self._contact_forces.mean()) if self._contact_forces.size else 0.0
        rounding = force_rounding(sim.box, self.law.k)
        return Forces(largest_force(sim.lmp), least or mean, rounding)

    def minimizer(self, sim: Simulation, tolerance: float) -> Minimizer:
        """FIRE, until the forces are small, whose scale falls in a loose packing."""

        def call(forces: Forces, left: int, most: int) -> int:
            force = max(tolerance * forces.scale, 0.9 * forces.rounding)
            before = sim.lmp.extract_global("ntimestep")
            run(sim.lmp, minimize_command(force, min(left, most)))
            return max(sim.lmp.extract_global("ntimestep") - before, 1)

        return call

    def filled(self) -> float:
        """Area or volume of all particles."""
        return undeformed(self._radius, self._dimension)

    def state(self, sim: Simulation, forces: Forces, converged: bool) -> State:
        """The state at the last run."""
        packing = packing_in(sim, self._radii)
        return State(
            packing=packing,
            law=self.law,
            energy=float(0.5 * np.sum(self._contact_forces**2) / self.law.k),
            pressure_tensor=stress(sim.lmp, packing.volume if packing.walls else None),
            residual=forces.residual,
            converged=converged,
            velocities=gather(sim.lmp, "v", 3)[:, : packing.dimension],
            _root=sim.comm.rank == 0,
            time=sim.time,
            shear_strain=sim.shear_strain,
        )


def separated(packing: Packing) -> Packing:
    """The packing with no two centers at one place; the same for the same packing."""
    place = np.rint(fractional(packing.positions, packing.box) / _SAME_PLACE)
    _, first, group = np.unique(
        place % round(1.0 / _SAME_PLACE), axis=0, return_index=True, return_inverse=True
    )
    if len(first) == len(packing):
        return packing
    group = group.ravel()
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], group[order])
    rank = np.empty(len(packing))
    rank[order] = np.arange(len(packing)) - start  # 0, 1, ... among the centers at each place
    distance = _SEPARATION * float(packing.radii.min()) * np.sqrt(rank)
    spiral = distance[:, None] * unit_vectors(_GOLDEN * rank)
    if packing.dimension == 3:  # on a cone
        spiral = np.column_stack([spiral, distance])
    return packing.replace(positions=packing.positions + spiral)


def open_disks(
    packing: Packing,
    comm: MPI.Comm | None = None,
    k: float = 1.0,
    former: lammps | None = None,
) -> lammps:
    """A LAMMPS with soft disks or spheres, U = k/2 overlap^2 of each pair, ready for FIRE."""
    smallest = float(packing.radii.min())
    lmp = open_lammps(packing, comm or alone(), former)
    run(lmp, soft_commands(packing, k))
    cutoff = "radius" if packing.own_radii else "type"
    run(lmp, _CONTACTS.format(cutoff=cutoff, timestep=SOFT_STEP / k**0.5))
    run(
        lmp,
        virial_command()
        + thermo_commands("")
        + list_commands(0.3 * smallest, packing)
        + fire_commands(dmax=0.01 * smallest),
    )
    return lmp
