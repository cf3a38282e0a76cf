"""Derivatives of states at rest by parameters, against differences of relaxed states."""

import math
from collections.abc import Mapping
from dataclasses import replace

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.lammps import place_particles
from lammps_deformable.particles.gravity import forces_of
from lammps_deformable.state.hessian import hessian_of
from lammps_deformable.state.terms import _moved, _turns
from scipy.linalg import expm

pytestmark = pytest.mark.usefixtures("exact_balance")

KINDS = {"kA": (1.0, 2.0), "kP": (0.3, 0.5), "skin": (0.02, 0.03), "tension": (0.1, 0.05)}
LAWS: dict[str, ld.SoftContact | ld.Ring] = {
    "soft": ld.SoftContact(2.0),
    "radical": ld.Ring(contact="radical", **KINDS),
    "balanced": ld.Ring(**KINDS),
    "curved": ld.Ring(contact="curved", **KINDS),
    "perimeter": ld.Ring((1.0, 2.0)),
    "emulsion": ld.Ring(math.inf, kP=0.0, tension=(1.0, 1.2), contact="curved"),
}
SCENES: dict[str, tuple[ld.Plane | ld.Sphere | ld.PolygonWall, ...]] = {
    "circle": (ld.Sphere(4, (0, 0)), ld.Sphere(0.6, (1, 0.5), inside=False)),
    "channel": (
        *(ld.Plane((0, y), (0, sign)) for y, sign in ((0, 1), (5, -1))),
        ld.PolygonWall(((1, 1.5), (3, 1.5), (2, 3.5))),
    ),
    "triangle": (
        ld.Plane((0, 0), (0.1, 1)),
        ld.Plane((6, 0), (-1, -0.5)),
        ld.Plane((0, 0), (1, -0.2)),
    ),
}
# Step of differences, and parameters whose differences have an error of the fourth order.
STEP, STEEP = 2e-5, ("radii", "box", "walls", "wall_angles", "gravity")


def at_rest(start: ld.Packing | ld.State, law, gravity=None) -> ld.State:
    """A state whose forces have vanished up to rounding, by Newton's method."""
    with ld.Simulation(start, law, gravity=gravity) as sim:
        state = sim.relax(1e-6) if isinstance(start, ld.Packing) else sim.state()
        for _ in range(8):
            if state.residual <= 2e-12:
                break
            hessian = hessian_of(state, rattlers=False)
            gradient = hessian.gradient.copy()
            if state.gravity is not None:
                weight = forces_of(state.gravity, state.packing.species)
                gradient[: hessian.size] -= weight.ravel()
            step = hessian.response(gradient)[: hessian.size]
            moved = state.packing.positions - step.reshape(-1, state.dimension)
            place_particles(sim.lmp, moved)
            state = sim.state()
    assert state.residual <= 1e-9
    return state


def with_change(state: ld.State, law, gravity, name: str, change) -> ld.State:
    """The state at rest after a change of a parameter."""
    packing, dimension = state.packing, state.packing.dimension
    still = np.eye(dimension)
    if name in ("radii", "box"):
        packing = packing.replace(**{name: getattr(packing, name) + change})
    elif name == "walls":
        moved = zip(packing.walls, change, strict=True)
        packing = packing.replace(walls=[_moved(wall, still, shift) for wall, shift in moved])
    elif name == "wall_angles":
        walls = []
        for wall, angle in zip(packing.walls, change.reshape(len(change), -1), strict=True):
            turn = expm(np.einsum("k,kab->ab", angle, _turns(dimension)))
            walls.append(_moved(wall, turn, np.zeros(dimension)))
        packing = packing.replace(walls=walls)
    elif name == "wall_adhesion":
        more = zip(packing.walls, change, strict=True)
        walls = [replace(wall, adhesion=wall.adhesion + w) for wall, w in more]
        packing = packing.replace(walls=walls)
    elif name == "gravity":
        gravity = gravity + change
    elif name == "adhesion":
        both = change + np.triu(change, 1).T
        law = replace(law, adhesion=(np.array(law.adhesion) + both).tolist())
    elif name == "k":
        law = ld.SoftContact(law.k + float(change))
    else:  # of species
        first = [int(np.flatnonzero(packing.species == kind)[0]) for kind in (0, 1)]
        law = replace(law, **{name: tuple(np.array(getattr(law, name)) + change[first])})
    return at_rest(replace(state, packing=packing, law=law, gravity=gravity), law, gravity)


def directions(state: ld.State, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, np.ndarray]:
    """A random change of each parameter, the same for all particles of a species."""
    rng = np.random.default_rng(5)
    found = {}
    for name, shape in shapes.items():
        change = rng.normal(size=shape)
        if name in ("kA", "kP", "skin", "tension"):
            change = np.array([1.0, -0.5])[state.packing.species]
        elif name == "box":
            shut = np.array([not each for each in state.packing.periodic])
            change = np.where(shut[:, None] | shut, 0.0, np.tril(change))
        elif name == "adhesion":
            change = np.triu(change)
        found[name] = change
    return found


def value(state: ld.State, quantity: str) -> np.ndarray:
    """The numbers of a quantity."""
    if quantity == "moduli":
        return state.moduli().tensor
    return state.contacts["force"] if quantity == "forces" else np.asarray(getattr(state, quantity))


def differences(state: ld.State, law, gravity, name: str, change, quantities) -> dict:
    """Rates of quantities by states at rest."""

    def after(step: float) -> dict:
        low, high = (with_change(state, law, gravity, name, s * step * change) for s in (-1.0, 1.0))
        return {each: (value(high, each) - value(low, each)) / (2.0 * step) for each in quantities}

    far = after(STEP)
    if name not in STEEP:
        return far
    near = after(0.5 * STEP)
    return {each: (4.0 * near[each] - rate) / 3.0 for each, rate in far.items()}


def agrees(state: ld.State, law, gravity=None, leave: str = "", tolerance: float = 1e-6) -> None:
    """All quantities along a direction of each parameter, against differences."""
    left = leave if gravity is not None else f"{leave} gravity"
    by = [name for name in state.derivatives("radii").parameters if name not in left.split()]
    found = state.derivatives(by=by)
    project = hessian_of(state, rattlers=False).project
    for name, change in directions(state, found.shapes).items():
        if not change.size or not change.any():
            continue
        rates = found.jvp(**{name: change})
        exact = differences(state, law, gravity, name, change, rates)
        exact["positions"] = project(exact["positions"].ravel())
        rates["positions"] = project(rates["positions"].ravel())
        for quantity, rate in rates.items():
            scale = max(np.abs(rate).max(), 1e-2 * np.abs(value(state, quantity)).max())
            close = pytest.approx(exact[quantity], abs=tolerance * scale)
            assert rate == close, (name, quantity)


@pytest.fixture(scope="module")
def packing() -> ld.Packing:
    jammed = ld.jam(ld.bidisperse(24, seed=3)).packing
    return jammed.at(jammed.phi + 0.04)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_plane(packing: ld.Packing, law) -> None:
    leave = {"perimeter": "kP skin", "emulsion": "kA kP skin"}
    agrees(at_rest(packing, law), law, leave=next((leave[n] for n in leave if LAWS[n] is law), ""))


@pytest.mark.parametrize(
    ("scene", "law"),
    [("circle", "curved"), ("channel", "balanced"), ("triangle", "radical"), ("triangle", "soft")],
)
def test_walls_and_gravity(scene: str, law: str) -> None:
    start = ld.bidisperse(30, seed=1).between(SCENES[scene]).at(0.93).push_off()
    gravity = None if law == "soft" else np.array([0.0, -0.01])
    agrees(at_rest(start, LAWS[law], gravity), LAWS[law], gravity)


def space(seed: int, phi: float) -> ld.Packing:
    """Twelve droplets of all sizes in a periodic box."""
    start = ld.bidisperse(12, sizes=(0.5, 0.6), dimension=3, seed=seed)
    jammed = ld.jam(start).packing.at(phi)
    sizes = 1.0 + 0.02 * np.random.default_rng(1).normal(size=12)
    return jammed.replace(radii=jammed.radii * sizes)


@pytest.mark.parametrize("adhesion", [0.0, ((0.1, 0.06), (0.06, 0.08))], ids=["bare", "films"])
def test_droplets(adhesion) -> None:
    law = ld.Droplet((1.0, 1.3), adhesion=adhesion)
    agrees(at_rest(space(3, 0.71), law), law)


def test_droplets_of_one_tension_have_caps() -> None:
    law = ld.Droplet((1.0, 1.0), adhesion=0.05)
    state = at_rest(space(2, 0.70), law)
    change = directions(state, {"radii": (12,)})["radii"]
    rates = state.derivatives(by="radii").jvp(radii=change)
    ask = "energy", "pressure", "pressures"
    exact = differences(state, law, None, "radii", change, ask)
    for quantity in ask:
        assert rates[quantity] == pytest.approx(exact[quantity], rel=1e-6)


@pytest.mark.parametrize("name", ["soft", "radical", "balanced", "curved", "space", "films"])
def test_moduli(packing: ld.Packing, name: str) -> None:
    adhesion = ((0.1, 0.06), (0.06, 0.08)) if name == "films" else 0.0
    law = LAWS.get(name, ld.Droplet((1.0, 1.3), adhesion=adhesion))
    state = at_rest(packing if name in LAWS else space(3, 0.71), law)
    by = [each for each in state.derivatives("radii").parameters if each != "gravity"]
    found = state.derivatives(by=by)
    table = found.jacobian("moduli")
    for each, change in directions(state, found.shapes).items():
        if not change.any():
            continue
        rate = np.tensordot(table[each], change, change.ndim)
        exact = differences(state, law, None, each, change, ["moduli"])["moduli"]
        assert rate == pytest.approx(exact, abs=1e-6 * np.abs(rate).max()), each
    slopes = found.vjp(shear_modulus=2.0, bulk_modulus=-1.0, pressure=0.5)["radii"]
    bulk = np.einsum("aaccn->n", table["radii"]) / state.dimension**2
    exact = 2.0 * table["radii"][0, 1, 0, 1] - bulk + 0.5 * found.jacobian("pressure")["radii"]
    assert slopes == pytest.approx(exact, rel=1e-9, abs=1e-11 * np.abs(exact).max())


@pytest.mark.parametrize(
    "walls",
    [
        ld.BoxWall((3.0, 2.8, 2.6), adhesion=0.06),
        (ld.Sphere(1.8, (0, 0, 0)), ld.Sphere(0.4, (0.3, 0.1, 0), inside=False)),
        (ld.Cylinder(1.4, "z"), ld.Plane((0, 0, 0), (0, 0.1, 1)), ld.Plane((0, 0, 3), (0, 0, -1))),
    ],
    ids=["sticky box", "ball", "tin"],
)
def test_droplets_between_walls(walls) -> None:
    start = ld.bidisperse(12, sizes=(0.5, 0.6), dimension=3, seed=2)
    start = start.between(walls).push_off().at(0.7)
    sizes = 1.0 + 0.02 * np.random.default_rng(1).normal(size=12)
    law = ld.Droplet((1.0, 1.3), adhesion=((0.05, 0.05), (0.05, 0.05)))
    is_round = isinstance(
        start.walls[0], ld.Sphere
    )  # in which a packing would hang like a pendulum
    gravity = None if is_round else np.array([0.0, 0.02, -0.1])
    state = at_rest(start.replace(radii=start.radii * sizes), law, gravity)
    sticks = any(wall.adhesion for wall in state.walls)
    agrees(state, law, gravity, leave="" if sticks else "wall_adhesion")


@pytest.mark.parametrize("scene", ["box", "pipe"])
def test_soft_spheres(scene: str) -> None:
    """Between walls that turn, and in a pipe."""
    walls = ld.BoxWall((4, 4, 4)) if scene == "box" else ld.Cylinder(2.0, "z", (2.0, 2.0, 0.0))
    start = ld.bidisperse(20, sizes=(0.4, 0.5), dimension=3, seed=2).between(walls).at(0.75)
    law = ld.SoftContact()
    agrees(at_rest(start.push_off(), law), law)


@pytest.mark.parametrize("name", ["radical", "curved", "space", "films"])
def test_scaling(packing: ld.Packing, name: str) -> None:
    """Scaling all lengths, and all energies, scales everything as its unit says."""
    adhesion = 0.05 if name == "films" else 0.0
    d, law = (2, LAWS[name]) if name in LAWS else (3, ld.Droplet((1.0, 1.3), adhesion=adhesion))
    state = at_rest(space(2, 0.7) if d == 3 else packing, law)
    of = law.species_parameters(state.packing.species_radii).of(state.packing.species)
    # powers of energy and length
    units = {"kA": (1, -4), "kP": (1, -2), "tension": (1, 1 - d if d == 3 else -1), "skin": (0, 1)}
    values = {key: getattr(of, key) for key in units} if d == 2 else {"tension": of.tension}
    units |= {"radii": (0, 1), "box": (0, 1), "adhesion": (1, -2)}
    values |= {"radii": state.radii, "box": state.box}
    if d == 3:
        units["tension"] = (1, -2)
        if adhesion:
            values["adhesion"] = np.triu(np.full((2, 2), adhesion))
    found = state.derivatives(by=list(values))
    own = {"energy": (1, 0), "pressure": (1, -d), "pressure_tensor": (1, -d), "forces": (1, -1)}
    for quantity, powers in own.items():
        numbers = value(state, quantity)
        for power in (0, 1):
            rates = {key: units[key][power] * each for key, each in values.items()}
            scale, exact = np.abs(numbers).max(), powers[power] * numbers
            assert found.jvp(**rates)[quantity] == pytest.approx(exact, abs=1e-10 * scale)
    moduli, table = value(state, "moduli"), found.jacobian("moduli")
    for power, exact in ((0, moduli), (1, -d * moduli)):
        rate = sum(
            units[key][power] * np.tensordot(table[key], each, np.ndim(each))
            for key, each in values.items()
        )
        assert rate == pytest.approx(exact, abs=1e-8 * np.abs(moduli).max())


def test_walls_that_move_together() -> None:
    """Nothing but the places changes."""
    start = ld.bidisperse(30, seed=1).between(SCENES["circle"]).at(0.93).push_off()
    state = at_rest(start, LAWS["curved"])
    found = state.derivatives(by="walls")
    rates = found.jvp(walls=np.tile([0.3, -0.4], (2, 1)))
    bearing = ~hessian_of(state, rattlers=False).free
    assert rates["positions"][bearing] == pytest.approx(
        np.tile([0.3, -0.4], (bearing.sum(), 1)), abs=1e-10
    )
    assert rates["forces"] == pytest.approx(0.0, abs=1e-10)
    assert rates["pressure"] == pytest.approx(0.0, abs=1e-10)


def test_walls_that_turn_together() -> None:
    """Droplets turn with them, and the pressure tensor does."""
    start = ld.bidisperse(12, sizes=(0.5, 0.6), dimension=3, seed=2)
    start = start.between(ld.BoxWall((3.0, 2.8, 2.6), adhesion=0.06)).push_off().at(0.7)
    state = at_rest(start, ld.Droplet(adhesion=0.05))
    found = state.derivatives(by=["walls", "wall_angles"])
    axis = np.array([0.3, -0.2, 0.5])
    moved = np.array([np.cross(axis, wall.origin) for wall in state.walls])
    rates = found.jvp(walls=moved, wall_angles=np.tile(axis, (6, 1)))
    for quantity in ("forces", "pressures"):
        scale = np.abs(value(state, quantity)).max()
        assert rates[quantity] == pytest.approx(0.0, abs=1e-10 * scale)
    turn = np.einsum("k,kab->ab", axis, _turns(3)) @ state.pressure_tensor
    scale = np.abs(state.pressure_tensor).max()  # times that of the room, which is a difference
    assert rates["pressure_tensor"] == pytest.approx(turn + turn.T, abs=1e-7 * scale)


def test_both_ways_agree(packing: ld.Packing) -> None:
    """Tables by quantities, by parameters, and one combination of both."""
    state = at_rest(packing, LAWS["balanced"])
    found = state.derivatives(by=["radii", "box"])
    tables = {name: found.jacobian(name) for name in ("positions", "pressure", "forces")}
    assert tables["positions"]["radii"].shape == (24, 2, 24)
    assert tables["pressure"]["box"].shape == (2, 2)
    rng = np.random.default_rng(2)
    change, weights = rng.normal(size=24), rng.normal(size=(24, 2))
    rates = found.jvp(radii=change)
    scale = np.abs(rates["positions"]).max()
    assert tables["positions"]["radii"] @ change == pytest.approx(
        rates["positions"], abs=1e-11 * scale
    )
    both = found.vjp(positions=weights, pressure=2.0)
    exact = np.sum(weights * rates["positions"]) + 2.0 * rates["pressure"]
    assert both["radii"] @ change == pytest.approx(exact, rel=1e-10)
    alone = state.derivatives(by="radii").vjp(positions=weights, pressure=2.0)
    assert alone == pytest.approx(both["radii"], rel=1e-12)
    assert repr(found) == "<Derivatives by radii (24,), box (2, 2)>"


def test_contacts_about_to_open() -> None:
    """Disks that press each other along x, and hardly touch along y."""
    law = ld.SoftContact()
    for gap, warns in ((1e-7, True), (1e-2, False)):
        square = np.array([(a, b) for a in (0.0, 0.9) for b in (0.0, 1.0 - gap)])
        packing = ld.Packing(square, 0.5, (1.8, 2.0 - 2.0 * gap))
        with ld.Simulation(packing, law) as sim:
            state = sim.state()
        if warns:
            with pytest.warns(ld.OpeningWarning, match="particle"):
                state.derivatives(by="radii")
        else:
            state.derivatives(by="radii")


def test_errors(packing: ld.Packing) -> None:
    with ld.Simulation(packing, LAWS["perimeter"]) as sim:
        moving, state = sim.state(), sim.relax()
    with pytest.raises(ld.ParameterError, match="not at rest"):
        moving.derivatives(by="radii")
    with pytest.raises(ld.ParameterError, match=r"by must be of .*radii.* not 'tension'"):
        state.derivatives(by=["radii", "tension"])
    found = state.derivatives(by="radii")
    with pytest.raises(ld.ParameterError, match=r"quantity must be of .*energy.* not 'entropy'"):
        found.jacobian("entropy")
    with pytest.raises(ld.ParameterError, match=r"positions must have shape \(24, 2\)"):
        found.vjp(positions=np.zeros(3))
    with pytest.raises(ld.ParameterError, match="tangents must be of radii, not 'box'"):
        found.jvp(box=np.eye(2))
