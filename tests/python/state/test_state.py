"""Values of a state: energy, contacts, outlines and pictures."""

from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from brute_force import brute_force_contacts, brute_force_rattlers, check_pressure, shapes
from lammps_deformable.engine.lammps import gather
from lammps_deformable.particles.laws import LAWS, Law

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(scope="module")
def many() -> ld.Packing:
    """24 particles with radii of their own in a tilted box."""
    draw = np.random.default_rng(4).lognormal(-0.7, 0.15, 24)
    return ld.jam(ld.polydisperse(24, draw, tilt=0.3, seed=4)).packing


def test_energy_and_areas_are_those_of_the_kernels(state: ld.State, many: ld.Packing) -> None:
    with ld.Simulation(many.at(1.02 * many.phi), ld.Ring(kA=2.0)) as sim:
        of_many = sim.relax()
    assert len(np.unique(of_many.packing.radii)) == 24
    for found in (state, of_many):
        check_energy_and_areas(found)


def check_energy_and_areas(state: ld.State) -> None:
    deficit = np.array([shape.area_deficit for shape in shapes(state)])
    # from the pressures, and from the indentations: they agree as far as forces are balanced
    assert state.area_deficit == pytest.approx(deficit, rel=1e-8, abs=1e-15)
    assert state.pressures == pytest.approx(2.0 * deficit, rel=1e-8, abs=1e-15)
    assert state.energy == pytest.approx(np.sum(2.0 * deficit**2 / 2.0), rel=1e-9)


def test_pressure_is_the_derivative_of_the_energy(jammed: ld.Packing, many: ld.Packing) -> None:
    for packing in (jammed, many):
        check_pressure(packing.at(packing.phi * 1.05))


@pytest.mark.parametrize(("law", "name"), [(ld.Ring(skin=0.02), "many"), (ld.Sector(), "jammed")])
def test_outlines_have_the_areas(law: Law, name: str, request: pytest.FixtureRequest) -> None:
    """Though they are polygons of about 180 corners, a part 2e-4 of their areas smaller."""
    packing = request.getfixturevalue(name)
    with ld.Simulation(packing.at(packing.phi * 1.05), law) as sim:
        state = sim.relax(1e-4) if isinstance(law, ld.Ring) else sim.state()
    skin = law.species_parameters(state.packing.species_radii).skin[state.packing.species]
    whole = state.results["area"] + skin * state.perimeters + np.pi * skin**2
    for outline, area in zip(state.outlines, whole, strict=True):
        x, y = (outline - outline.mean(axis=0)).T
        polygon = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        assert polygon == pytest.approx(area, rel=1e-7)
    assert state.phi == pytest.approx(whole.sum() / state.packing.volume)


def test_force_vectors_sum_to_the_forces(jammed: ld.Packing) -> None:
    """The parts along the contacts, of balanced lines 4 to 9 % of a contact force, are in them."""
    for law in LAWS.values():
        with ld.Simulation(jammed.at(jammed.phi * 1.05), law) as sim:
            state = sim.state()
            force = np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, :2]
        table = state.contacts
        net = np.zeros_like(force)
        np.add.at(net, table["i"], table["force_vector"])
        rounding = 1e-14 * table["force"].max()
        np.testing.assert_allclose(net, force, rtol=0, atol=rounding, err_msg=law.name)
        if state.law.name != "curved":
            out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
            (nx, ny), (fx, fy) = out.T, table["force_vector"].T
            assert np.abs(nx * fy - ny * fx).max() > 1e-3 * table["force"].max()


@pytest.mark.parametrize(
    "start",
    [
        ld.bidisperse(3, seed=1),
        ld.bidisperse(24, aspect=0.7, tilt=0.6, seed=1),
        ld.polydisperse(24, np.linspace(0.4, 0.65, 24), tilt=0.3, seed=4),
    ],
)
def test_contacts_and_rattlers_against_brute_force(start: ld.Packing) -> None:
    jammed = ld.jam(start).packing
    law = ld.Ring(contact="radical")
    with ld.Simulation(jammed.at(jammed.phi * 1.01), law) as sim:
        state = sim.relax()
    contacts = brute_force_contacts(state)
    table = state.contacts
    seen = zip(table["i"], table["j"], *table["image"].T, strict=True)
    assert {tuple(map(int, key)) for key in seen} == {key for key, c in contacts.items() if c}
    # both sides of every contact are on one line
    height = state.packing.radii[table["i"]] - table["indentation"]
    out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
    foot = state.packing.positions[table["i"]] + height[:, None] * out
    np.testing.assert_allclose(foot, table["position"], rtol=0, atol=1e-13)
    sides = {}
    for row in table:
        here = (int(row["i"]), int(row["j"]), *row["image"].tolist())
        sides[here] = row["position"]
    for (i, j, a, b), place in sides.items():
        other = sides[j, i, -a, -b] + np.array([a, b]) @ state.packing.box
        np.testing.assert_allclose(place, other, rtol=0, atol=1e-13)
    rattlers = brute_force_rattlers(contacts, len(jammed))
    assert set(np.flatnonzero(state.rattlers).tolist()) == rattlers
    held = [i not in rattlers and j not in rattlers for (i, j, _, _), c in contacts.items() if c]
    assert state.coordination == pytest.approx(sum(held) / (len(jammed) - len(rattlers)))


def test_state_stays_while_the_simulation_goes_on(state: ld.State) -> None:
    with pytest.raises(ValueError, match="read-only"):
        state.perimeters[0] = 0.0


def test_plot_draws_every_particle(state: ld.State) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    axes = state.plot(color="area_deficit")
    polygons = axes.collections[0]
    assert len(polygons.get_paths()) >= len(state.packing)
    assert set(state.area_deficit) == set(polygons.get_array())
    assert state.plot(ax=axes) is axes
    with pytest.raises(ld.ParameterError, match="'beauty'"):
        state.plot(color="beauty")


@pytest.mark.parametrize("law", [ld.Ring(kP=2.0, skin=0.05), ld.Sector()], ids=["ring", "sector"])
@pytest.mark.usefixtures("exact_balance")
def test_plot_draws_every_contact(jammed: ld.Packing, law: ld.Ring | ld.Sector) -> None:
    """Each side has the length of its contact, at every image that reaches into the box."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    with ld.Simulation(jammed, law) as sim:
        sim.deform(0.98 * sim.box)
        state = sim.state()
    lines = state.plot(contacts=True).collections[1]
    ends = np.array(lines.get_segments())
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    expected = state.contacts["length"]
    expected = expected[expected > 0.0]
    assert len(expected) > len(jammed)
    # differences of rounded coordinates
    rounding = 16.0 * np.finfo(float).eps * np.abs(ends).max()
    nearest = np.abs(length[:, None] - expected).min(axis=0)
    assert nearest.max() < rounding
    assert np.abs(length[:, None] - expected).min(axis=1).max() < rounding
    assert len(state.plot().collections) == 1


@pytest.mark.parametrize("law", [ld.Ring(), ld.Sector(), ld.Droplet(), ld.SoftContact()], ids=repr)
def test_forces_are_those_of_lammps(law: Any) -> None:
    dimension = 3 if isinstance(law, ld.Droplet) else 2
    jammed = ld.jam(ld.bidisperse(12, dimension=dimension, seed=1)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.03), law) as sim:
        state = sim.state()
        forces = gather(sim.lmp, "f", 3)[:, :dimension]
    assert state.forces == pytest.approx(forces, abs=1e-12 * np.abs(forces).max())
    for name in ("positions", "radii", "box"):
        assert np.array_equal(getattr(state, name), getattr(state.packing, name))
