"""Relaxation of deformable particles in LAMMPS."""

import warnings
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from brute_force import shapes
from contact_laws import simulate
from lammps_deformable.engine.relax import TOLERANCE

pytestmark = pytest.mark.filterwarnings("error")


def mean_contact_force(state: ld.State) -> float:
    lengths = [shape.contact_length for shape in shapes(state)]
    forces = [p * length for p, length in zip(state.pressures, lengths, strict=True)]
    active = np.concatenate(forces)
    return float(np.mean(active[active > 0.0]))


@pytest.mark.parametrize(("number", "seed"), [(8, 1), (32, 4), (64, 3)])
def test_ring_always_reaches_the_tolerance(number: int, seed: int) -> None:
    jammed = ld.jam(ld.bidisperse(number, seed=seed)).packing
    with warnings.catch_warnings(), ld.Simulation(jammed, ld.Ring()) as sim:
        warnings.simplefilter("ignore", ld.UnjammedWarning)  # small packings may give way

        def check(state: ld.State) -> None:
            assert state.converged
            assert state.residual <= TOLERANCE
            largest = np.linalg.norm(sim.lmp.numpy.extract_atom("f")[:number], axis=1).max()
            if state.residual > 0.0:  # not loose
                assert largest <= 1.0001 * TOLERANCE * mean_contact_force(state)

        sim.compress(strain=0.02, steps=4, callback=check)


@pytest.mark.slow
@pytest.mark.parametrize(("strain", "seed"), [(0.01, 1), (0.03, 2), (0.05, 3)])
def test_ring_reaches_the_tolerance_in_large_steps(seed: int, strain: float) -> None:
    jammed = ld.jam(ld.bidisperse(256, seed=seed)).packing
    with ld.Simulation(jammed, ld.Ring()) as sim:
        for state in sim.compress(strain=strain, steps=2)[1:]:
            assert state.converged


def test_loose_particles_do_nothing() -> None:
    with ld.Simulation(ld.bidisperse(2, phi=0.01, seed=1), ld.Ring()) as sim:
        state = sim.relax()
    assert (state.energy, state.pressure, state.residual, state.coordination) == (0, 0, 0, 0)
    assert state.rattlers.all()
    assert state.phi == pytest.approx(0.01)


def test_single_contact_of_the_sector_law_opens() -> None:
    pair = ld.Packing([[1.0, 2.0], [1.9, 2.0]], 0.5, [[4.0, 0.0], [0.0, 4.0]])
    with ld.Simulation(pair, ld.Sector()) as sim:
        assert sim.state().energy == pytest.approx(0.5 * 0.1**2)
        state = sim.relax()
    assert state.energy < 1e-11
    assert 1.0 - 1e-5 < state.packing.positions[1, 0] - state.packing.positions[0, 0] < 1.01


def test_commands_of_the_user_stay_in_force(jammed: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        sim.lmp.command(f"dump positions all custom 1000 {tmp_path / 'dump'} id x y")
        sim.lmp.command("fix move all nve")
        before = sim.state().packing.positions
        assert sim.state().packing.positions == pytest.approx(before, abs=1e-13)
        sim.compress(strain=0.01, steps=2)
        assert sim.lmp.has_id("dump", "positions")


def test_sector_warns_that_it_stalls(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Sector()) as sim:
        sim.deform(0.98 * sim.box)
        with pytest.warns(ld.StalledWarning, match=r"stalled at phi = 0\.8"):
            state = sim.relax()
    assert not state.converged
    assert state.residual > TOLERANCE


def test_past_confluence_warns(jammed: ld.Packing) -> None:
    with (
        ld.Simulation(jammed.at(1.1), ld.Ring(reach=0.5)) as sim,
        pytest.warns(ld.BeyondModelWarning, match="beyond the model"),
    ):
        state = sim.relax(tolerance=0.1)
    assert state.beyond > 0
    assert (state.arc_radii < 0).sum() == state.beyond


def row(*radii: float) -> ld.Packing:
    """Particles side by side that bear a force across the box as long as they are in line."""
    radius = np.array(radii)
    x = np.cumsum(radius + np.roll(radius, -1) - 0.01)
    _, species = np.unique(radius, return_inverse=True)
    places = np.column_stack([np.roll(x, 1) % x[-1], np.full(len(x), 5.0)])
    return ld.Packing(places, radius, [[x[-1], 0.0], [0.0, 10.0]], species=species)


def give_way(sim: ld.Simulation) -> None:
    sim.lmp.command("displace_atoms all random 0 0.3 0 4 units box")
    sim.relax()


def test_unjamming_warns() -> None:
    with ld.Simulation(row(0.5, 0.5, 0.5, 0.5), ld.Ring()) as sim:
        assert sim.relax().energy > 0
        with pytest.warns(ld.UnjammedWarning, match="lost its rigidity") as warned:
            give_way(sim)
        sim.relax()
    assert len(warned) == 1


def test_warnings_are_of_the_line_that_called(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        with pytest.warns(ld.UnjammedWarning) as by_strain:
            sim.compress(strain=-0.05)
        sim.compress(pressure=1e-5)
        with pytest.warns(ld.UnjammedWarning) as to_target:
            sim.compress(phi=0.8, steps=2)
    assert {each.filename for each in (*by_strain, *to_target)} == {__file__}


@pytest.mark.parametrize(("balanced", "restarted"), [("as disks", False), ("by the law", True)])
def test_unjamming_in_the_first_relaxation_warns(balanced: str, restarted: bool) -> None:
    """As after `jam`, whose packing is at rest under the forces of disks or of the law."""
    law = ld.Ring(contact="radical")
    packing = start = row(0.3, 0.3, 0.9, 0.9)
    if balanced == "by the law":
        with ld.Simulation(packing, law) as sim:
            start = sim.relax().packing
    with ld.Simulation(start, ld.SoftContact()) as disks, ld.Simulation(start, law) as sim:
        assert (disks.state().residual < 0.1) == (balanced == "as disks")
        assert (sim.state().residual < 0.1) == (balanced == "by the law")
    opened = row(0.3, 0.3).at(0.5).push_off() if restarted else start
    with ld.Simulation(opened, law) as sim:
        if restarted:
            sim.reset(start)
        told = rf"lost its rigidity at phi = {start.phi:.5f}"
        with pytest.warns(ld.UnjammedWarning, match=told) as warned:
            give_way(sim)
        sim.relax()
    assert len(warned) == 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("change", [-1e-3, 1e-3])
def test_loose_packings_need_not_be_rigid(change: float) -> None:
    """Neither those that were loose at the start, nor those that have expanded since."""
    law = ld.Ring(contact="radical")
    loose = ld.bidisperse(16, phi=0.6, seed=1).push_off()
    jammed = ld.jam(ld.bidisperse(16, seed=1)).packing
    for packing in (loose, jammed)[: 2 if change < 0.0 else 1]:
        with ld.Simulation(packing, law) as sim:
            sim.deform(sim.box * (1.0 - change))
            assert sim.relax().pressure < 1e-12


def test_deform_shears_affinely(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        box = sim.box + np.array([[0.0, 0.0], [0.1, 0.0]])
        sim.deform(box)
        moved = sim.state().packing
    assert moved.box == pytest.approx(box)
    fraction = moved.positions @ np.linalg.inv(box) - jammed.positions @ np.linalg.inv(jammed.box)
    assert fraction - np.rint(fraction) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("box", [[[-5, 0], [0, 5]], [[5, 0], [np.nan, 5]]])
def test_bad_boxes_change_nothing(jammed: ld.Packing, box: list[list[float]]) -> None:
    with ld.Simulation(jammed.at(0.87), ld.Ring()) as sim:
        before = sim.state().energy
        with pytest.raises(ld.ParameterError, match="box must be"):
            sim.deform(np.array(box))
        assert before > 0
        assert sim.state().energy == pytest.approx(before, rel=1e-12)


def test_folders_with_spaces(
    jammed: ld.Packing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "a b"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    with ld.Simulation(jammed, ld.Ring()) as sim:
        assert sim.state().phi > 0.5


def test_users_pay_no_per_atom_results(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        sim.relax()
        assert sim.lmp.available_ids("fix") == ["deformable_restart"]


def test_simulations_outlive_errors_of_lammps(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        box = sim.box
        before = sim.relax()
        for _ in range(2):
            sim.deform(0.03 * box)  # an error before particles move
            with pytest.raises(ld.LammpsError):
                sim.relax()
        sim.deform(box)
        assert sim.state().pressure == pytest.approx(before.pressure, rel=1e-6)


@pytest.mark.parametrize("law", [ld.Ring(), ld.Sector()])
def test_errors_for_deep_overlaps_name_push_off(law: ld.Ring | ld.Sector) -> None:
    packing = ld.bidisperse(16, phi=0.9, seed=1)
    with ld.Simulation(packing, law) as sim:
        for call in (sim.relax, sim.state):
            with pytest.raises(ld.LammpsError, match=r"contact line.*push_off"):
                call()
    with ld.Simulation(packing.push_off(), law) as sim:
        assert sim.state().energy > 0.0


@pytest.mark.parametrize(
    ("law", "tilt", "phi"), [(None, 1.3, 0.88), (ld.Ring(), 1.3, 1.0), (ld.Sector(), 0.3, 1.0)]
)
@pytest.mark.usefixtures("exact_balance")  # stresses are right to the tolerance of the forces
def test_a_particle_in_a_box_smaller_than_itself(
    law: ld.Ring | ld.Sector | None, tilt: float, phi: float
) -> None:
    """Its own images are neighbors like those in four such boxes."""
    one = ld.bidisperse(1, sizes=(0.5, 0.5), phi=phi, tilt=tilt, seed=1)
    cells = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    four = ld.Packing(one.positions + cells @ one.box, 0.5, 2.0 * one.box, species=[1] * 4)
    with simulate(one, law) as small, simulate(four, law) as large:
        found, expected = small.state(), large.state()
    assert (found.energy > 0.0) == (phi > 0.8)
    assert 4.0 * found.energy == pytest.approx(expected.energy, rel=1e-11)
    assert found.phi == pytest.approx(expected.phi, rel=1e-11)
    np.testing.assert_allclose(
        found.pressure_tensor,
        expected.pressure_tensor,
        rtol=0,
        atol=1e-11 * np.abs(expected.pressure_tensor).max(),
    )


@pytest.mark.parametrize("number", [1, 4])
def test_states_without_area_are_refused(number: int) -> None:
    """Beyond the reach of the laws, a packing fraction would be negative."""
    cells = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])[:number]
    box = 0.6 * np.eye(2) * np.sqrt(number)
    packing = ld.Packing(0.1 + 0.6 * cells, 0.5, box)
    with (
        ld.Simulation(packing, ld.Ring()) as sim,
        pytest.raises(ld.LammpsError, match=r"\A[^\n]*tom \d[^\n]* no area[^\n]*\Z"),
    ):
        sim.state()


def test_an_interrupted_close_frees_lammps_once(
    jammed: ld.Packing, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C while LAMMPS ends: a second time would crash."""
    sim = ld.Simulation(jammed, ld.Ring())
    library, freed = sim.lmp.lib, []
    close = library.lammps_close

    def interrupted(instance: object) -> None:
        freed.append(instance)
        close(instance)
        raise KeyboardInterrupt

    monkeypatch.setattr(library, "lammps_close", interrupted)
    with pytest.raises(KeyboardInterrupt):
        sim.close()
    sim._lmp.close()  # as when the instance is deleted
    assert len(freed) == 1
    assert sim.closed


def test_a_larger_diameter() -> None:
    """The species file is LAMMPS' way; `Simulation` writes that file itself."""
    packing = ld.polydisperse(3, [0.5, 0.6, 0.7], phi=0.4, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.lmp.command("set atom 1 diameter 3")
        with pytest.raises(ld.LammpsError, match="in Python: reset to a packing with"):
            sim.state()


def test_beyond_the_model_says_how_many_and_what() -> None:
    packing = ld.jam(ld.bidisperse(12, seed=2)).packing.at(1.15)
    with (
        ld.Simulation(packing, ld.Ring()) as sim,
        pytest.warns(
            ld.BeyondModelWarning,
            match=r"\d+ of 12 particles .* negative radius .* without a known error",
        ),
    ):
        sim.relax(1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_boxes_of_thousands_of_radii(dimension: int) -> None:
    """LAMMPS has too many bins of its usual size there."""
    law = ld.Ring() if dimension == 2 else ld.Droplet()
    centers = np.full((2, dimension), 1.0)
    centers[1, 0] += 0.99
    energies = []
    for length in (4.0, 20_000.0):
        pair = ld.Packing(centers, 0.5, (length,) * dimension)
        with ld.Simulation(pair, law) as sim:
            energies.append(sim.state().energy)
            sim.run(5, timestep=0.01, temperature=1e-9, seed=1)
        with ld.Simulation(pair, ld.SoftContact()) as sim:
            assert sim.state().pressure > 0.0
    assert energies[1] == pytest.approx(energies[0], rel=1e-6)
