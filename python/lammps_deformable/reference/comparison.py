"""Contact laws against reference models: errors, and error against run time.

In space these are exact shapes of droplets, in the plane deformable polygons. Smooth polygons
(docs/theory/numerics.md, "Smooth polygons") come to rest where smooth particles do. Bead polygons
have friction: they interlock, and their energy depends on the way.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from .. import core
from ..common.box import cartesian, fractional
from ..common.checks import count, expect, finite, shown
from ..common.errors import ParameterError, StalledWarning, UnjammedWarning, collected, warn
from ..common.files import make_folder
from ..common.parallel import parallel_map
from ..common.versions import optional
from ..core import angles, norm, unit_vectors
from ..engine.lammps import gather, images_of
from ..engine.simulation import Simulation
from ..particles.laws import (
    Droplet,
    Law,
    Ring,
    Sector,
    SoftContact,
    pair_matrix,
    per_species,
    refuse_adhesion,
)
from ..particles.packing import Packing
from ..particles.polygons import DeformablePolygon, Polygons, refuse_overlap, refuse_packing
from ..state.state import State
from .error_plot import plot_errors
from .exact_droplets import ExactPacking, exact_packing, osmotic

if TYPE_CHECKING:
    from matplotlib.axes import Axes

T = TypeVar("T")
Row = dict[str, Any]
Steps = list[tuple[State, float]]
Method = Law | Droplet | SoftContact | DeformablePolygon

# Laws without a continuous energy do not come to rest.
_RESTLESS = {"sector"}

# A packing with less than this part of the polygons' pressure has lost its rigidity.
_UNJAMMED = 1e-6

# Distance of the centers over the radius, in root mean square, beyond which a method has gone to
# another minimum than the reference. Within one, `balanced`, `curved` and polygons are up to 0.012
# apart (validation/report/seeds.json), two minima 0.07 and more. The lines of `radical` move
# centers by 0.004 to 0.03: some of its rows count as another minimum for that alone.
_ONE_MINIMUM = 0.02

# Largest residual of polygons whose energies are those at rest, and the largest relative difference
# of two estimates of the limit of very many vertices that is nothing to warn of.
_RESTING, _UNCERTAIN = 1e-2, 0.1

# kP/(kA R^2) of polygons that stand for inextensible ones: the springs lower S by kA q^2/kP, below
# a tenth. The time of a relaxation grows as the root of the stiffness.
STIFF = 10.0

# Radius of the vertices of polygons [length], and the stiffness of their contacts over the largest
# kA. With radii of 0.5 and 0.7 contacts give way by less than 1 % of the indentation.
SKIN, CONTACT = 0.025, 10.0

# Corners of an outline: the polygon is nearer to the curve than 2e-6 of its radius.
_POINTS = 1440

# Directions in which outlines of polygons are compared.
_DIRECTIONS = 2.0 * np.pi * np.arange(720) / 720

# Corners that coincide may differ in direction by rounding [rad].
_ROUNDING = 1e-12

# Columns of a table, and their heads in print.
COLUMNS = {
    "method": "method",
    "vertices": "vertices",
    "energy_error": "energy",
    "pressure_error": "pressure",
    "area_error": "areas",
    "shape_error": "outline",
    "distance": "centers",
    "seconds": "seconds",
    "residual": "residual",
}


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """Errors and processor times of contact laws and polygons, from `compare`.

    Attributes:
        rows: of each method, in the order of measuring: `disk` for soft disks, names of laws,
            `smooth` and `bead` for polygons, and `reference`. In space `sphere` for soft spheres,
            `droplet`, `elements` for finite elements on meshes of one size, and `reference`, what
            is extrapolated from them. Keys:

            method, vertices: its name, and N_v of the smallest polygons, or nodes for each droplet,
                else None.
            strain: linear, beyond the start; None at given centers.
            energy_ratio, pressure_ratio: over those of the reference, None where one of both is
                loose; energies over those of polygons of very many vertices if there are two kinds
                of smooth polygons.
            energy_error, pressure_error: distance of these ratios from 1.
            area_error: rms difference of the area deficits over their rms; 1 for disks. In space of
                what surfaces have gained; of soft spheres their energies.
            shape_error: mean distance of the outlines over the radius.
            distance: root mean square distance of the centers from those of the reference, over the
                mean radius. A law or smooth polygons that stay farther than 0.02 are in another
                minimum, and have no errors.
            seconds: processor time of all steps.
            residual: largest of the forces that are left over the mean contact force.
            limit_error: of the reference, what its energy is uncertain by: how far the limit of
                very many vertices is from the finest polygons; in space that of the extrapolation.

            A value that is not known is None: the stiffness of disks is free, and a packing may be
            loose.
        steps: rows of each law and polygon at each strain, see `compression_rows`.
    """

    rows: list[Row]
    steps: list[Row]

    def table(self) -> dict[str, NDArray[Any]]:
        """Columns of the rows, arrays of the same length; nan or an empty word if not known."""
        found: dict[str, NDArray[Any]] = {}
        for key in COLUMNS:
            values = [row[key] for row in self.rows]
            if key == "method":
                found[key] = np.array(values)
            else:
                found[key] = np.array([math.nan if v is None else v for v in values], float)
        return found

    def to_pandas(self) -> Any:
        """`table` as a pandas.DataFrame."""
        return optional("pandas", "pandas").DataFrame(self.table())

    def __str__(self) -> str:
        width = max(len(row["method"]) for row in self.rows)
        lines = [
            f"{'method':{width}} " + " ".join(f"{head:>9}" for head in [*COLUMNS.values()][1:])
        ]
        uncertain = self.rows[-1].get("limit_error")
        for row in self.rows:
            cells = ["-" if row[key] is None else f"{row[key]:.3g}" for key in [*COLUMNS][1:]]
            error = row["energy_error"]
            if uncertain is not None and error is not None and error < uncertain:
                cells[[*COLUMNS].index("energy_error") - 1] = f"<{uncertain:.2g}"
            lines.append(f"{row['method']:{width}} " + " ".join(f"{cell:>9}" for cell in cells))
        away = [_name(row) for row in self.rows if _is_away(row)]
        if away:
            lines.append(f"In another minimum, and so without errors: {'; '.join(away)}.")
        if uncertain is not None:
            lines.append(f"The reference's energy is known to {100.0 * uncertain:.2g} %.")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Comparison: {', '.join(dict.fromkeys(row['method'] for row in self.rows))}>"

    def plot(self, ax: Axes | None = None, quantity: str = "energy_error") -> Axes:
        """Draw errors against processor time, a point for each method; polygons are joined.

        Args:
            ax: where; a new figure if not given.
            quantity: `energy_error`, `pressure_error`, `area_error` or `shape_error`.

        Raises:
            ParameterError: no method has a time, as at given centers.
        """
        if ax is None:
            from matplotlib import pyplot as plt

            ax = plt.figure(layout="constrained").subplots()
        plot_errors(self.rows, ax, quantity)
        ax.legend()
        return ax


def compare(
    start: Packing | State | Sequence[State],
    *,
    law: Law | Droplet | None = None,
    polygon: DeformablePolygon | None = None,
    vertices: Iterable[int] = (38, 76, 152),
    beads: Iterable[int] = (),
    strain: float = 0.02,
    steps: int = 2,
    workers: int | None = None,
    keep: str | Path | None = None,
) -> Comparison:
    """Measure errors of contact laws and of polygons against their processor times.

    Each method compresses the same packing in the same steps and relaxes on its own. One that
    comes to another minimum relaxes again from where the reference is. Errors are those against the
    finest smooth polygons, at the last strain; of energies those against the limit of very many
    vertices. In space they are those of
    droplets against their exact shapes by finite elements, which begin where the law is at rest;
    soft spheres have the stiffness with which their energies come nearest to the exact ones, and
    are left out where droplets stick. That takes some seconds of each droplet and step.

    Args:
        start: a packing at the onset of jamming, or a state there: circles must not overlap, as
            polygons begin as circles. Of a run that is an isotropic compression the first state,
            with its strain and steps. Of a state of polygons the laws are evaluated at its centers
            at once, and have no times.
        law: only this one, a `Ring` or `Sector`; all laws if not given. In space a `Droplet` of one
            tension, with an adhesion for all pairs or none.
        polygon: the stiffness of the polygons at its number of vertices; others have the same kP.
            By default that of the law, or of the state's law; kP = 10 kA R^2 stands for an
            infinite one, also in the laws. Of a packing alone kA = 1 and kP = 6.
        vertices: N_v of the smallest smooth polygons; the most are the reference. Multiples of 19
            give radii of 0.5 and 0.7 the same kP at each number. No arguments about polygons
            matter in space.
        beads: N_v of bead polygons.
        strain: total linear strain of the compression.
        steps: number of steps.
        workers: methods at a time, as in `parallel_map`.
        keep: folder of pickles, of the results of methods that are complete: only you may write to
            it, because reading a pickle runs the code in it.

    Raises:
        ParameterError: circles overlap; a run is no isotropic compression; particles stick, or have
            a tension: polygons have none; or they have radii of their own.

    Warns:
        UnjammedWarning: the packing is loose.
        StalledWarning: smooth polygons did not come to rest. They do not count for the limit.
        UserWarning: smooth polygons came to different minima, and are compared at half of the
            strain; or the packing is loose, and they are compared at twice the strain; or the
            energy of very many vertices is known to some 10 % only.
    """
    given: Any = law
    strain, steps = finite("strain", strain), count("steps", steps)
    expect("polygon", polygon, DeformablePolygon, type(None))
    expect("keep", keep, str, Path, type(None))
    if isinstance(start, State) and isinstance(start.law, DeformablePolygon):
        return _at_centers(start, given)
    first, strain, steps = _begin(start, strain, steps)
    if not 0.0 < strain < 1.0:
        raise ParameterError(f"strain must lie between 0 and 1, not {strain}")
    packing = first if isinstance(first, Packing) else first.packing
    expect("packing", packing, Packing)
    own: Any = first.law if isinstance(first, State) else None
    own = None if isinstance(own, SoftContact) else own
    if packing.dimension == 3:
        droplets = given or own or Droplet()
        expect("law", droplets, Droplet)
        return _in_space(packing, droplets, strain, steps, workers, keep)
    for each in (given, own):
        if each is not None:
            _refuse_law(each)
    stiffness = given or own
    model = partial(_polygons, packing, polygon, None if polygon else stiffness)
    *coarse, finest = sorted(set(_counts("vertices", vertices))) or [0]
    if not finest:
        raise ParameterError("vertices must be at least one number: the most are the reference")
    rivals = [model(each) for each in coarse]
    rivals += [model(each, smooth=False) for each in _counts("beads", beads)]
    reference = model(finest)
    refuse_packing(packing)
    refuse_overlap(packing, reference)
    laws = None if given is None else {given.name: _matched(given, reference, packing)}

    def at(strain: float) -> tuple[list[Row], list[Row]]:
        steps_of = compression_rows(
            packing, reference, strain, steps, rivals, laws=laws, workers=workers, keep=keep
        )
        soft = Simulation(packing, SoftContact(), comm=MPI.COMM_SELF)
        disks = math.fsum(seconds for _, seconds in timed(soft, strain, steps))
        return steps_of, method_rows(steps_of, disks)

    rows, found = at(strain)
    why, part = _another_strain(found)
    if why:
        warn(f"{why} at a strain of {strain:.3g}: compared at {part * strain:.3g}", UserWarning)
        rows, found = at(part * strain)
    _warn_of_reference(found)
    return Comparison(found, rows)


def _counts(name: str, values: Iterable[int]) -> list[int]:
    """Numbers of vertices, from 1."""
    if not isinstance(values, Iterable) or isinstance(values, str):
        raise ParameterError(f"{name} must be several numbers, as (38, 76), not {shown(values)}")
    return [count(name, each) for each in values]


def _refuse_law(law: Any) -> None:
    expect("law", law, Ring, Sector)
    refuse_adhesion(law, (), ", and polygons have none")
    if isinstance(law, Ring) and np.any(law.tension):
        raise ParameterError(
            "particles have a tension, and polygons have none: compare without; the exact law with "
            "a tension, to compare states of others with, is Ring(..., contact='curved')"
        )


def _another_strain(rows: Sequence[Row]) -> tuple[str, float]:
    """Why a limit of smooth polygons is not known, or nothing; and the part of the strain to take.

    Args:
        rows: of `method_rows`.
    """
    smooth = [row for row in rows if row["method"] == "smooth"]
    if "limit_error" not in rows[-1] and any(map(_is_away, smooth)):
        return "smooth polygons came to different minima", 0.5
    laws = [row for row in rows if row["vertices"] is None and row["seconds"] is not None][1:]
    if laws and all(row["energy_ratio"] is None and not _is_away(row) for row in laws):
        return "the packing hardly bears a load", 2.0
    return "", 1.0


def _warn_of_reference(rows: Sequence[Row]) -> None:
    """Warn of energies that say little, as the polygons have not found them.

    Args:
        rows: of `method_rows`.
    """
    ways = "take more vertices, smaller steps or another strain"
    for row in rows:
        if row["method"] in ("smooth", "reference") and not _at_rest(row["residual"]):
            warn(
                f"the smooth polygons of {row['vertices']} vertices did not come to rest: their "
                f"residual is {row['residual']:.2g}, and their row says nothing; {ways}",
                StalledWarning,
            )
    if not any(row["pressure_ratio"] for row in rows[:-1]):
        warn(
            "the packing is loose, of the finest polygons or of all others, so that there are no "
            "errors of energies: take a larger strain, or another packing",
            UnjammedWarning,
        )
    uncertain = rows[-1].get("limit_error")
    if uncertain is not None and uncertain > _UNCERTAIN:
        warn(
            f"the energy of polygons of very many vertices is known to {100 * uncertain:.0f} % "
            f"only, and so are the errors of energies: {ways}",
            UserWarning,
        )


def _at_rest(residual: float | None) -> bool:
    """Whether a relaxation has ended with energies that can be compared."""
    return residual is not None and residual < _RESTING


def _begin(start: Any, strain: float, steps: int) -> tuple[Packing | State, float, int]:
    """Where a comparison begins, its strain and steps."""
    if isinstance(start, (Packing, State)):
        return start, strain, steps
    ends = [start[0], start[-1]] if isinstance(start, Sequence) and len(start) else []
    if not ends or not all(isinstance(end, State) for end in ends):
        raise ParameterError(f"start must be a packing, a state or a run, not {shown(start)}")
    first, last = ends
    whole = first.packing.box
    strain = 1.0 - float(last.packing.box[0, 0] / whole[0, 0])
    if not (strain > 0.0 and np.allclose(last.packing.box, whole * (1.0 - strain), rtol=1e-9)):
        raise ParameterError("the run is no isotropic compression: compare its first state")
    return first, strain, len(start) - 1


def _polygons(
    packing: Packing,
    polygon: DeformablePolygon | None,
    law: Law | None,
    vertices: int,
    smooth: bool = True,
) -> DeformablePolygon:
    """Polygons of another number of vertices with the stiffness of a model, or of a law."""
    if polygon is not None:
        times = vertices / float(np.min(polygon.vertices))
        springs = (np.asarray(polygon.kL) * times).tolist()
        most = polygon.vertices
        of_each = vertices if np.ndim(most) == 0 else np.rint(np.asarray(most) * times).tolist()
        return replace(polygon, vertices=of_each, kL=springs, smooth=smooth)
    if law is None:
        return standard_polygons(vertices, smooth=smooth)
    kinds = len(packing.species_radii)
    kA, kP = (per_species(value, kinds) for value in (law.kA, law.kP))
    return stiff_polygons(packing.species_radii, vertices, kA, kP, smooth)


def standard_polygons(count: int, smooth: bool = True) -> DeformablePolygon:
    """Polygons for the measurements: kA = 1, kP = 6, contacts of range c = 0.05 and stiffness 10.

    Args:
        count: N_v, of the smallest polygons.
        smooth: whether they are smooth, else bead polygons.
    """
    return DeformablePolygon(count, smooth=smooth, radius=SKIN, kL=6.0 * count, kr=CONTACT)


def stiff_polygons(
    radii: NDArray[np.float64],
    count: int,
    kA: Sequence[float],
    kP: Sequence[float],
    smooth: bool = True,
) -> DeformablePolygon:
    """Polygons of species of these stiffnesses, arguments as for `standard_polygons`.

    Where kP is infinite, polygons have 10 kA R^2 instead, because no spring is rigid.
    """
    polygons = DeformablePolygon(count, radius=SKIN).polygons(radii)
    springs = polygons.number * np.where(np.isinf(kP), STIFF * np.array(kA) * radii**2, kP)
    return DeformablePolygon(
        count, smooth=smooth, radius=SKIN, kL=springs.tolist(), kA=kA, kr=CONTACT * max(kA)
    )


def _matched(law: Law, model: DeformablePolygon, packing: Packing) -> Law:
    """The law for particles like these polygons: with their kP, and their vertices as a skin."""
    if isinstance(law, Sector):
        return law
    polygons = model.polygons(packing.species_radii)
    return replace(law, kP=polygons.kP.tolist(), skin=polygons.skin.tolist())


def _in_space(
    start: Packing,
    law: Droplet,
    strain: float,
    steps: int,
    workers: int | None,
    keep: str | Path | None,
) -> Comparison:
    """Droplets, and soft spheres if nothing sticks, against exact shapes."""
    if start.walls or len(set(np.atleast_1d(law.tension).tolist())) > 1:
        raise ParameterError(
            "droplets must have one tension, and no walls, to be compared in space"
        )
    if law.sticks and np.min(law.adhesion) == 0.0:
        raise ParameterError(
            "exact shapes in space are known where all droplets stick to all, or none to any: give "
            "each pair an adhesion, or none"
        )
    calls: list[tuple[Callable[..., Any], Any]]
    calls = [(compressed, law), (exact_path, law)]
    calls += [] if law.sticks else [(compressed, SoftContact())]
    droplets, exact, *others = parallel_map(
        lambda call: _kept(call[0], keep)(start, call[1], strain, steps), calls, workers=workers
    )
    known = [shapes.found.energies for _, shapes, _ in exact]
    spheres = [(_stored(state), state, seconds) for path in others for state, seconds in path]
    k = 1.0
    if spheres:
        soft = [stored for stored, _, _ in spheres]
        k = math.fsum(map(np.dot, soft, known)) / math.fsum(map(np.dot, soft, soft))
    rows: list[Row] = []
    for n, (state, shapes, seconds) in enumerate(exact):
        own, own_seconds = droplets[n]
        methods = [
            ("sphere", None, k * stored, k * sphere.pressure, sphere.residual, took)
            for stored, sphere, took in spheres[n : n + 1]
        ]
        methods.append(("droplet", None, _stored(own), own.pressure, own.residual, own_seconds))
        for level in [*shapes.levels, shapes.found]:
            nodes, took = level.nodes // len(start), seconds + level.seconds
            found = level.energies, osmotic(state, level), None, took
            methods.append(("elements", nodes, *found))
        methods[-1] = "reference", *methods[-1][1:]
        for method, vertices, energies, pressure, residual, took in methods:
            rows.append(
                {
                    "method": method,
                    "vertices": vertices,
                    "n": len(start),
                    "strain": strain * (n + 1) / steps,
                    "energy_ratio": _over(float(energies.sum()), float(known[n].sum())),
                    "pressure_ratio": _over(pressure, osmotic(state, shapes.found)),
                    "S_rms": _over(norm(energies - known[n]), norm(known[n])),
                    "I": None,
                    "law_residual": residual,
                    "seconds": took,
                }
            )
        rows[-1]["limit_error"] = shapes.found.energy_error / abs(float(known[n].sum()))
    each = len(rows) // steps
    last = [
        _with_errors(
            rows[k] | {"seconds": math.fsum(row["seconds"] for row in rows[k % each :: each])}
        )
        for k in range(len(rows) - each, len(rows))
    ]
    last[-1]["limit_error"] = rows[-1]["limit_error"]
    return Comparison(last, rows)


def exact_path(
    start: Packing, law: Droplet, strain: float, steps: int
) -> list[tuple[State, ExactPacking, float]]:
    """As `compressed`, with the exact shapes of each state; the seconds are those of the law."""
    found = compressed(start, law, strain, steps)
    return [(state, exact_packing(state), seconds) for state, seconds in found]


def _stored(state: State) -> NDArray[np.float64]:
    """Energy of each droplet, or of each soft sphere, which has half of that of its contacts."""
    if isinstance(state.law, Droplet):
        surface = state.results["surface_areas"] - 4.0 * np.pi * state.packing.radii**2
        stored = np.asarray(surface * np.max(state.law.tension))
        return stored - _gained(state) if state.law.sticks else stored
    contacts = state.contacts
    energies = 0.25 * contacts["force"] ** 2 / state.law.k
    return np.asarray(np.bincount(contacts["i"], energies, len(state.packing)), float)


def _gained(state: State) -> NDArray[np.float64]:
    """By films that stick: a droplet has half of the energy of each."""
    packing, films = state.packing, state.contacts[state.contacts["attached"]]
    adhesion = pair_matrix("adhesion", state.law.adhesion, len(packing.species_radii))
    pair = (packing.species[films[end]] for end in "ij")
    energies = 0.5 * adhesion[tuple(pair)] * np.pi * films["facet_radius"] ** 2
    return np.asarray(np.bincount(films["i"], energies, len(packing)), float)


def _kept(function: Callable[..., T], keep: str | Path | None) -> Callable[..., T]:
    """A function whose results are kept in a folder, if one is given."""
    if keep is None:
        return function
    from joblib import Memory

    found: Callable[..., T] = Memory(str(make_folder(keep) / core.version), verbose=0).cache(
        function
    )
    return found


def _at_centers(exact: State, law: Law | None) -> Comparison:
    """The laws at the centers of polygons, not relaxed."""
    if law is not None:
        expect("law", law, Ring, Sector)
    laws = matching_laws(exact.law, exact.polygons) if law is None else {law.name: law}
    none = {"vertices": None, "strain": None}
    rows = [
        {"method": name} | none | _against(exact, predict(exact, each, MPI.COMM_SELF), None)
        for name, each in laws.items()
    ]
    return Comparison([_with_errors(row) for row in rows], [])


def compression_rows(
    start: Packing,
    model: DeformablePolygon,
    strain: float,
    steps: int,
    rivals: Sequence[DeformablePolygon] = (),
    *,
    laws: Mapping[str, Law] | None = None,
    workers: int | None = None,
    keep: str | Path | None = None,
) -> list[Row]:
    """A packing compressed from jamming: every law against smooth polygons.

    Polygons and laws start from the same packing and relax on their own after each step. One that
    comes to another minimum than the reference relaxes again, from the reference's centers, smooth
    polygons from its outlines: an error is one within a minimum.

    Args:
        start: a jammed packing.
        model: of the reference.
        strain: total linear strain.
        steps: number of steps.
        rivals: other smooth or bead polygons to compare with the reference. All stand for the same
            particles: bead polygons have the laws' radii as effective ones, see `matching`.
        laws: by name; `matching_laws` if not given.
        workers: as for `compare`.
        keep: as for `compare`.

    Returns:
        Rows for each step, in the order of the steps. Their keys:

        n, strain, n_v: number of particles; of the reference.
        law: name of a law, or `smooth` or `bead` for rivals.
        vertices: N_v of a rival, else None.
        own: true if the law relaxed on its own, false if its particles have the centers of the
            reference. Rivals, and no row of the sector law, are on their own.
        energy_ratio, pressure_ratio: over those of the reference; None where one is unjammed, or a
            law or smooth polygons stay in another minimum, of centers farther than 0.02.
        S_rms: root mean square difference of the area deficits over their root mean square.
        I: mean distance of the outlines over the radius, each about its own center; None if an
            outline of a law folds.
        distance: root mean square distance of the centers over the mean radius, see `centers_rms`;
            0 at given centers.
        residual: of the reference, see `State.residual`. Above 1e-6 the reference has not
            converged: it is loose, or nearly so, and the row says nothing about the law.
        law_residual: of the law or rival; None at given centers.
        seconds: processor time of the law's or rival's relaxation; None at given centers.
        seconds_polygons: that of the reference's relaxation.
    """
    if laws is None:
        laws = matching_laws(model, model.polygons(start.species_radii))
    own = [name for name in laws if name not in _RESTLESS]
    others = [matching(start, rival) for rival in rivals]
    calls: list[tuple[Any, ...]] = [(start, model, strain, steps)]
    calls += [(other, rival, strain, steps) for other, rival in zip(others, rivals, strict=True)]
    calls += [(start, laws[name], strain, steps) for name in own]
    follow = _kept(compressed, keep)
    found = parallel_map(lambda call: follow(*call), calls, workers=workers)
    reference, *found = found
    follow = _kept(in_its_minimum, keep)
    found = parallel_map(
        lambda call: follow(*call),
        [(call[0], reference, path) for call, path in zip(calls[1:], found, strict=True)],
        workers=workers,
    )
    paths = dict(zip(own, found[len(rivals) :], strict=True))
    rows: list[Row] = []
    for n, (exact, seconds) in enumerate(reference):
        common = {
            "n": len(start),
            "strain": strain * (n + 1) / steps,
            "n_v": int(exact.polygons.number.min()),
            "residual": exact.residual,
            "seconds_polygons": seconds,
        }
        for name, law in laws.items():
            there = predict(exact, law, MPI.COMM_SELF)
            none = {"law": name, "vertices": None}
            if name in paths:
                rows.append(common | none | {"own": True} | _against(exact, *paths[name][n]))
            rows.append(common | none | {"own": False} | _against(exact, there, None))
        for rival, path in zip(rivals, found, strict=False):
            rows.append(
                common
                | {"law": "smooth" if rival.smooth else "bead"}
                | {"vertices": int(path[n][0].polygons.number.min()), "own": True}
                | _against(exact, *path[n])
            )
    return rows


def method_rows(steps: Sequence[Row], seconds_of_disks: float) -> list[Row]:
    """A row for each method at the last strain, see `Comparison.rows`.

    The sector law does not come to rest and is taken at the centers of the reference, without a
    time.

    Args:
        steps: of `compression_rows`.
        seconds_of_disks: processor time of soft disks.
    """
    paths: dict[tuple[str, int | None], list[Row]] = {}
    for row in steps:
        if row["own"] or row["law"] in _RESTLESS:
            paths.setdefault((row["law"], row["vertices"]), []).append(row)
    found = []
    for (method, _), path in paths.items():
        times = [row["seconds"] for row in path]
        seconds = None if None in times else math.fsum(times)
        found.append(path[-1] | {"method": method, "seconds": seconds})
    last = path[-1]
    # a disk keeps its area, S = 0; its stiffness is free, so that its energy says nothing
    disk = dict.fromkeys(last) | {key: last[key] for key in ("n", "strain", "n_v")}
    exact = {"method": "reference", "vertices": last["n_v"], "S_rms": 0.0}
    exact |= {"energy_ratio": 1.0, "pressure_ratio": 1.0, "law_residual": last["residual"]}
    exact["seconds"] = math.fsum(row["seconds_polygons"] for row in path)
    rows = [
        disk | {"method": "disk", "S_rms": 1.0, "seconds": seconds_of_disks},
        *found,
        disk | exact,
    ]
    smooth = [
        row
        for row in rows
        if row["method"] in ("smooth", "reference")
        and _at_rest(row["law_residual"])
        and row["energy_ratio"] is not None
    ]
    *_, coarse, fine = [None, None, *sorted(smooth, key=lambda row: int(row["vertices"]))]
    if coarse and fine:
        limit = of_many_vertices(
            coarse["energy_ratio"], fine["energy_ratio"], fine["vertices"] / coarse["vertices"]
        )
        for row in rows:
            if row["energy_ratio"] is not None:
                row["energy_ratio"] /= limit
    rows = [_with_errors(row) for row in rows]
    if coarse and fine:
        rows[-1]["limit_error"] = abs(fine["energy_ratio"] - 1.0)
    return rows


def _is_away(row: Row) -> bool:
    """Whether a method is in another minimum than the reference."""
    distance = row.get("distance")
    return row["method"] != "bead" and distance is not None and distance > _ONE_MINIMUM


def _name(row: Row) -> str:
    """A method in words."""
    method, vertices = row["method"], row["vertices"]
    return method if vertices is None else f"{method} polygons of {vertices} vertices"


def _with_errors(row: Row) -> Row:
    """The keys of `Comparison.rows`."""
    ratios = {name: row[f"{name}_ratio"] for name in ("energy", "pressure")}
    return {
        **{key: row[key] for key in ("method", "vertices", "strain")},
        **{f"{name}_ratio": ratio for name, ratio in ratios.items()},
        **{
            f"{name}_error": None if ratio is None else abs(ratio - 1.0)
            for name, ratio in ratios.items()
        },
        "area_error": row["S_rms"],
        "shape_error": row["I"],
        "distance": row.get("distance"),
        "seconds": row["seconds"],
        "residual": row["law_residual"],
    }


def of_many_vertices(coarse: float, fine: float, times: float) -> float:
    """The limit of an energy of polygons, which differs from it by a part of 1/N_v^2 at most.

    From 38 to 152 vertices the difference falls faster, about as 1/N_v^3: the limit is uncertain by
    its distance from the finest polygons.

    Args:
        coarse: energy of polygons of N_v vertices.
        fine: that of `times` as many.
        times: above 1.
    """
    return fine + (fine - coarse) / (times**2 - 1.0)


def compressed(start: Packing, law: Method, strain: float, steps: int) -> Steps:
    """Particles compressed from jamming: states, and seconds of processor time, of the steps."""
    with Simulation(start, law, comm=MPI.COMM_SELF) as sim, collected():  # rows have the residuals
        return timed(sim, strain, steps)


def in_its_minimum(start: Packing, reference: Steps, path: Steps) -> Steps:
    """States in the minima of the reference, where there are such.

    Args:
        start: of the path, at jamming.
        reference: states of smooth polygons.
        path: those of a law or of other polygons, which may have gone to other minima.

    Returns:
        The path. Where its centers are far from those of the reference, the state to which the
        method comes from there, with the seconds of the path. Bead polygons interlock: they stay.
    """
    found = []
    for (exact, _), (state, seconds) in zip(reference, path, strict=True):
        smooth = not isinstance(state.law, DeformablePolygon) or state.law.smooth
        if smooth and _in_another_minimum(exact, state):
            state = _from_reference(start, exact, state)
        found.append((state, seconds))
    return found


def _in_another_minimum(exact: State, state: State) -> bool:
    distance = centers_rms(exact, state)
    return distance is not None and distance > _ONE_MINIMUM


def _from_reference(start: Packing, exact: State, state: State) -> State:
    """Where a method comes to rest from the reference's centers, polygons from its outlines."""
    if not isinstance(state.law, DeformablePolygon):
        start = state.packing.replace(positions=exact.packing.positions)
    with Simulation(start, state.law, comm=MPI.COMM_SELF) as sim, collected():
        if isinstance(state.law, DeformablePolygon):
            sim.deform(exact.packing.box)
            place_outlines(sim, resampled(exact, state.polygons))
        return sim.relax()


def resampled(exact: State, polygons: Polygons) -> list[NDArray[np.float64]]:
    """Vertices of other polygons on the outlines of a state, equally far apart, arrays (N_v, 2)."""
    found = []
    for outline, kind in zip(exact.outlines, exact.packing.species, strict=True):
        closed = np.vstack([outline, outline[:1]])
        length = np.append(0.0, np.cumsum(np.hypot(*np.diff(closed, axis=0).T)))
        number = int(polygons.number[kind])
        at = np.arange(number) / number * length[-1]
        line = np.column_stack([np.interp(at, length, values) for values in closed.T])
        center = outline.mean(axis=0)
        found.append(center + (line - center) * polygons.radius[kind] / exact.polygons.radius[kind])
    return found


def place_outlines(sim: Simulation, outlines: Sequence[NDArray[np.float64]]) -> None:
    """Put the vertices of the polygons of a simulation on one rank at given places."""
    x = gather(sim.lmp, "x", 3)
    x[:, :2] = np.vstack(outlines) - cartesian(images_of(sim.lmp).astype(float), sim.box)
    sim.lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(x.ravel()))


def timed(sim: Simulation, strain: float, steps: int) -> Steps:
    """The states of a compression, with the seconds of processor time of each step.

    As `Simulation.compress`, which also evaluates the start.
    """
    found, box = [], sim.box
    for n in range(1, steps + 1):
        began = time.process_time()
        sim.deform(box * (1.0 - strain * n / steps))
        found.append((sim.relax(), time.process_time() - began))
    return found


def _against(exact: State, other: State, seconds: float | None) -> dict[str, Any]:
    """The errors of a law, or of other polygons, see `compression_rows`."""
    loose = is_unjammed(other, exact) or is_unjammed(exact, other)
    bead = isinstance(other.law, DeformablePolygon) and not other.law.smooth
    if not bead and seconds is not None and _in_another_minimum(exact, other):
        return dict.fromkeys(("energy_ratio", "pressure_ratio", "S_rms", "I")) | {
            "distance": centers_rms(exact, other),
            "law_residual": other.residual,
            "seconds": seconds,
        }
    wrong = norm(other.area_deficit - exact.area_deficit)
    return {
        "energy_ratio": None if loose else _over(other.energy, exact.energy),
        "pressure_ratio": None if loose else _over(other.pressure, exact.pressure),
        "S_rms": _over(wrong, norm(exact.area_deficit)),
        "I": _shape_error(exact, other),
        "distance": 0.0 if seconds is None else centers_rms(exact, other),
        "law_residual": None if seconds is None else other.residual,
        "seconds": seconds,
    }


def _over(value: float, exact: float) -> float | None:
    """A ratio; None to polygons without load, as JSON has no infinity."""
    return value / exact if exact and math.isfinite(value / exact) else None


def _shape_error(exact: State, other: State) -> float | None:
    if not isinstance(other.law, DeformablePolygon):
        try:
            return float(shape_errors(exact, other).mean())
        except ParameterError:  # an outline folds
            return None
    radius = exact.packing.radii
    return float(np.mean(np.abs(_dents(exact) - _dents(other)) / radius[:, None]))


def _dents(state: State) -> NDArray[np.float64]:
    """Distance of each polygon inward from its circle at rest, shape (N, directions) [length]."""
    found = []
    for polygon, center, kind in zip(
        state.outlines, state.packing.positions, state.packing.species, strict=True
    ):
        out = polygon - center
        inward = state.polygons.radius[kind] - np.hypot(*out.T)
        found.append(np.interp(_DIRECTIONS, angles(out), inward, period=2.0 * np.pi))
    return np.array(found)


def matching_laws(
    model: DeformablePolygon, polygons: Polygons, rigid: Sequence[bool] = ()
) -> dict[str, Law]:
    """The contact laws for such polygons, by name.

    `radical`, `balanced` and `curved` have the polygons' own stiffness kP = kL/N_v, and their beads
    as a rigid skin. `radical, kP inf` conserves perimeters, as the paper does. `sector`, which has
    a single kA, is left out if the kA of the species differ.

    Args:
        model: of the polygons.
        polygons: the undeformed ones.
        rigid: species whose polygons stand for inextensible ones. If there are any,
            `balanced, kP inf` has kP = inf for them.
    """
    kA, kP, skin = model.kA, polygons.kP.tolist(), polygons.skin.tolist()
    found: dict[str, Law] = {}
    if len(set(polygons.kA)) == 1:
        found["sector"] = Sector(polygons.kA[0])
    found |= {
        "radical, kP inf": Ring(kA, contact="radical"),
        "radical": Ring(kA, kP=kP, skin=skin, contact="radical"),
        "balanced": Ring(kA, kP=kP, skin=skin, contact="balanced"),
        "curved": Ring(kA, kP=kP, skin=skin, contact="curved"),
    }
    if any(rigid):
        kP = np.where(rigid, math.inf, kP).tolist()
        found["balanced, kP inf"] = Ring(kA, kP=kP, skin=skin, contact="balanced")
    return found


def matching(packing: Packing, model: DeformablePolygon) -> Packing:
    """The packing with other radii, such that the polygons have its own radii as effective ones."""
    radii = packing.species_radii
    for _ in range(10):  # the roughness hardly depends on the radius: each step gains two digits
        radii = radii + packing.species_radii - model.polygons(radii).effective_radius
    return packing.replace(radii=radii[packing.species])


def is_unjammed(own: State, exact: State) -> bool:
    """Whether a packing has lost its rigidity: it has less than 1e-6 of the polygons' pressure."""
    return own.pressure <= _UNJAMMED * exact.pressure


def centers_rms(exact: State, own: State) -> float | None:
    """Root mean square distance of the centers over the mean radius; None if one is unjammed.

    Particles that are rattlers in one of the two do not count. A common drift is subtracted.
    """
    if is_unjammed(own, exact):
        return None
    a, b, held = exact.packing, own.packing, ~(exact.rattlers | own.rattlers)
    if not held.any():
        return None
    apart = fractional((b.positions - a.positions)[held], b.box)
    apart -= apart[0]  # then the nearest image does not depend on the drift
    apart = cartesian(apart - np.rint(apart), b.box)
    apart -= apart.mean(axis=0)
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))) / b.radii.mean())


def predict(reference: State, law: Law | None = None, comm: MPI.Comm | None = None) -> State:
    """The state of a contact law for particles at the centers of bead polygons, not relaxed.

    Their radii are the effective ones of the polygons, `Polygons.effective_radius`.

    Args:
        reference: the polygons.
        law: by default `balanced` with the kA of the polygons, their kP = kL/N_v, and their beads
            as a rigid skin.
        comm: MPI ranks, as in `Simulation`.

    Raises:
        ParameterError: an argument is of another kind, or particles stick.
        LammpsError: see `Simulation.relax`.
    """
    expect("reference", reference, State)
    expect("the law of reference", reference.law, DeformablePolygon)
    if law is None:
        law = matching_laws(reference.law, reference.polygons)["balanced"]
    expect("law", law, Ring, Sector)
    refuse_adhesion(law, (), ", and polygons have none")
    radii = reference.polygons.effective_radius[reference.packing.species]
    packing = reference.packing.replace(radii=radii)
    with Simulation(packing, law, comm=comm) as sim:
        return sim.state()


def polygon_outlines(reference: State, state: State) -> list[NDArray[np.float64]]:
    """Lines of bead centers in a law, about each particle's own center, arrays (m, 2) [length]."""
    polygons = reference.polygons.radius[reference.packing.species]
    return state._parallels(state.packing.radii - polygons, _POINTS)


def shape_errors(reference: State, state: State) -> NDArray[np.float64]:
    """I of each particle, shape (N,): the outlines of a state against the beads.

    Raises:
        ParameterError: an outline folds: the particle is beyond the model.
    """
    errors = np.zeros(len(reference.packing))
    for n, (polygon, center, outline, radius) in enumerate(
        zip(
            reference.outlines,
            reference.packing.positions,
            polygon_outlines(reference, state),
            reference.packing.radii,
            strict=True,
        )
    ):
        try:
            errors[n] = shape_error(polygon - center, outline, radius)
        except ParameterError:
            raise ParameterError(
                f"the outline of particle {n} folds in the {state.law.name} law, which does not "
                "describe particles pressed that much: compress less"
            ) from None
    return errors


def radial_distance(outline: ArrayLike, angle: ArrayLike) -> NDArray[np.float64]:
    """Distance g(theta) of an outline from the origin.

    Args:
        outline: corners of a polygon around the origin, counterclockwise, shape (m, 2) [length].
        angle: directions theta, shape (k,) [rad].

    Returns:
        Distance at which each ray crosses the polygon, shape (k,) [length].

    Raises:
        ParameterError: a ray crosses the polygon more than once: the particle is beyond the model.
    """
    corners = np.asarray(outline, dtype=np.float64)
    turn = angles(corners)
    start = int(turn.argmin())
    corners = np.roll(corners, -start, axis=0)
    turn = np.roll(turn, -start)
    steps = np.diff(turn, append=turn[0] + 2.0 * np.pi)
    if not ((steps > -_ROUNDING) & (steps < np.pi)).all():
        raise ParameterError(
            "an outline must go once around its center, counterclockwise and without turning back"
        )
    ray = np.asarray(angle, dtype=np.float64)
    ray = (ray - turn[0]) % (2.0 * np.pi) + turn[0]
    side = np.searchsorted(turn, ray, side="right") - 1
    a, b = corners[side], corners[(side + 1) % len(corners)]
    edge = b - a
    x, y = unit_vectors(ray).T
    across = x * edge[:, 1] - y * edge[:, 0]
    return np.asarray((a[:, 0] * edge[:, 1] - a[:, 1] * edge[:, 0]) / across)


def deviation(beads: ArrayLike, outline: ArrayLike) -> NDArray[np.float64]:
    """|v| - g(theta) of each bead v, shape (N_v,) [length].

    Args:
        beads: positions about the center of the outline, shape (N_v, 2) [length].
        outline: as for `radial_distance`, of the line of bead centers in the law.
    """
    v = np.asarray(beads, dtype=np.float64)
    return np.hypot(v[:, 0], v[:, 1]) - radial_distance(outline, angles(v))


def shape_error(beads: ArrayLike, outline: ArrayLike, radius: float) -> float:
    """I = 1/(R N_v) sum | |v| - g(theta) |, arguments as for `deviation`, R the radius."""
    return float(np.mean(np.abs(deviation(beads, outline))) / radius)
