"""Droplets in space that stick, from Python: films, walls, files, runs."""

import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

BOX = (12.0, 12.0, 12.0)
STICKY = ld.Droplet(adhesion=0.2)
PLANE = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved", adhesion=0.2)


def doublet(distance: float, **more: object) -> ld.Packing:
    return ld.Packing([[4.0, 6.0, 6.0], [4.0 + distance, 6.0, 6.0]], 1.0, BOX, **more)


def test_a_doublet_at_rest() -> None:
    """Two truncated spheres: v = (pi/3)(1 - C)^2 (2 + C), L = (1 - 3 v/4 pi)^(-1/3), d = 2 L C."""
    with ld.Simulation(doublet(1.95), STICKY) as sim:
        state = sim.relax()
    cosine = 1.0 - 0.2 / 2.0
    stretch = (1.0 - (1.0 - cosine) ** 2 * (2.0 + cosine) / 4.0) ** (-1.0 / 3.0)
    table = state.contacts
    assert table["distance"] == pytest.approx(2.0 * stretch * cosine, rel=1e-4)
    assert table["attached"].all()
    assert table["contact_angle"] == pytest.approx(math.acos(cosine))
    sine = math.sqrt(1.0 - cosine**2)
    assert table["facet_radius"] == pytest.approx(stretch * sine, rel=1e-3)
    assert state.energy == pytest.approx(8.0 * math.pi * (1.0 / stretch - 1.0), rel=2e-3)
    assert np.abs(table["force"]).max() < 1e-6
    assert state.films.tolist() == [[1, 2]]
    assert state.pressures == pytest.approx(2.0 / stretch, rel=1e-3)


def test_a_film_pulls_and_is_torn() -> None:
    with ld.Simulation(doublet(1.95), STICKY) as sim:
        sim.relax()
        forces = []
        for distance in np.arange(1.84, 2.3, 0.02):
            lmp, x = sim.lmp, np.array([[4.0, 6.0, 6.0], [4.0 + distance, 6.0, 6.0]])
            lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(x.ravel()))
            state = sim.state()
            forces.append(state.contacts["force"][0] if len(state.contacts) else 0.0)
        assert state.films.size == 0
    assert min(forces) < -0.1
    assert forces[-1] == 0.0


def test_a_drop_on_a_wall() -> None:
    """It wets the wall with the angle of Young's law; gravity presses it."""
    wall = ld.Plane((0, 0, 1), (0, 0, 1), adhesion=0.1)
    lid = ld.Plane((0, 0, 11), (0, 0, -1))
    packing = ld.Packing([[6.0, 6.0, 1.98]], 1.0, BOX, walls=(wall, lid))
    with ld.Simulation(packing, ld.Droplet()) as sim:
        state = sim.relax()
    (row,) = state.contacts
    assert row["contact_angle"] == pytest.approx(math.acos(0.9))
    stretch = (1.0 - 0.01 * 2.9 / 4.0) ** (-1.0 / 3.0)
    assert row["distance"] == pytest.approx(0.9 * stretch, rel=1e-3)
    with ld.Simulation(packing, ld.Droplet(), gravity=(0.0, 0.0, -0.05)) as sim:
        heavy = sim.relax()
    assert heavy.contacts["force"][0] == pytest.approx(0.05, rel=1e-5)
    assert heavy.contacts["facet_radius"][0] > row["facet_radius"]
    other = packing.replace(walls=(ld.Plane((0, 0, 1), (0, 0, 1), adhesion=0.6), lid))
    with pytest.raises(ld.ParameterError, match=r"^plane 1, species 0: adhesion 0\.6 makes"):
        ld.Simulation(other, ld.Droplet())


def test_files_and_runs_keep_films(tmp_path: Path) -> None:
    law = ld.Droplet((1.0, 1.5), adhesion=((0.1, 0.2), (0.2, 0.0)))
    packing = ld.Packing(
        [[4.0, 6.0, 6.0], [5.9, 6.0, 6.0], [7.8, 6.0, 6.0]], 1.0, BOX, species=[0, 1, 0]
    )
    with ld.Simulation(packing, law) as sim:
        run = sim.compress(strain=1e-3, steps=2, record=tmp_path / "run")
    state = run[-1]
    assert state.films.tolist() == [[1, 2], [2, 3]]
    again = ld.State.from_file(
        tmp_path / "run" / "trajectory.lammpstrj", tmp_path / "run" / "species.deformable"
    )
    assert again.law == law
    assert again.energy == pytest.approx(state.energy, rel=1e-6)
    with ld.Run(tmp_path / "run").simulation() as sim:
        assert sim.law == law
        assert sim.state().films.tolist() == state.films.tolist()
        # Velocities follow from the digits of positions: a short step is right for any of them.
        moved = sim.run(2000, temperature=1e-4, timestep=0.01)
    ledger = [
        each.energy + each.lost_energy + 0.5 * float(np.sum(each.velocities**2)) for each in moved
    ]
    assert ledger[-1] == pytest.approx(ledger[0], abs=1e-6)


def test_a_recorded_run_has_what_films_have_lost(tmp_path: Path) -> None:
    """Two droplets attach in motion: frames, table and what goes on have the energy lost."""
    with ld.Simulation(doublet(2.01), STICKY) as sim:
        sim.lmp.command("set atom 2 vx -0.02")
        run = sim.run(400, every=200, timestep=0.01, record=tmp_path / "run")
        lost = sim.state().lost_energy
    assert lost > 0.01
    assert run[-1].lost_energy == run.table()["lost_energy"][-1] == pytest.approx(lost)
    with run.simulation() as sim:
        assert sim.state().lost_energy == pytest.approx(lost)


@pytest.mark.parametrize(("law", "side"), [(STICKY, 4.07), (PLANE, 4.4)], ids=["space", "plane"])
def test_a_state_has_the_films_with_several_images(law: ld.Droplet | ld.Ring, side: float) -> None:
    """Two particles in a box so small that both of their films are stretched."""
    low = law.dimension - 1
    centers = np.full((2, law.dimension), 6.0)
    centers[:, low] = 1.0, 2.99
    box = np.full(law.dimension, 12.0)
    box[low] = 3.985
    with ld.Simulation(ld.Packing(centers, 1.0, box), law) as sim:
        sim.state()
        sim.deform(sim.box * np.where(np.arange(law.dimension) == low, side / box[low], 1.0))
        state = sim.state()
    assert (state.contacts["attached"].sum(), state.contacts["distance"].min() > 2.0) == (4, True)
    assert state.films.tolist() == [[1, 2], [1, 2]]
    with ld.Simulation(state, law) as sim:
        again = sim.state()
    assert again.energy == pytest.approx(state.energy, rel=1e-9)
    assert again.films.tolist() == state.films.tolist()


def test_what_is_refused() -> None:
    for given, told in (
        ({"adhesion": 2.0}, "adhesion 2 "),
        ({"adhesion": -0.1}, "adhesion must"),
        ({"adhesion": 1.2}, "makes a contact angle"),
        ({"adhesion": ((0.0, 0.1), (0.2, 0.0))}, "symmetric"),
    ):
        with pytest.raises(ld.ParameterError, match=told):
            ld.Droplet(**given)
    packing = ld.bidisperse(8, dimension=3, seed=1)
    with pytest.raises(ld.ParameterError, match="no pressure at an onset"):
        ld.jam(packing, STICKY)
    assert repr(STICKY) == "Droplet(adhesion=0.2)"
    assert repr(ld.Droplet()) == "Droplet()"


def test_what_does_not_know_films(tmp_path: Path) -> None:
    with ld.Simulation(doublet(1.95), STICKY) as sim:
        state = sim.relax()
    with pytest.raises(ld.ParameterError, match="droplets in space without adhesion"):
        state.export(tmp_path / "a.fe")
    some = ld.Droplet((1.0, 1.0), adhesion=((0.0, 0.1), (0.1, 0.0)))
    with pytest.raises(ld.ParameterError, match="give each pair an adhesion, or none"):
        ld.compare(ld.crystal("fcc", 1, phi=0.75), law=some)


@pytest.mark.parametrize(
    ("radii", "tensions", "adhesion"),
    [
        ((1.0, 2.0), (1.0, 0.5), 0.01),
        ((1.0, 1.0), (1.0, 0.3), 0.006),
        ((1.0, 3.0), (1.0, 1.0), 0.2),
    ],
)
def test_a_torn_film_leaves_nothing(
    radii: tuple[float, float], tensions: tuple[float, float], adhesion: float
) -> None:
    """Apart, droplets of unlike radii and tensions have no energy, from the step of the tear on."""
    law = ld.Droplet(tensions, adhesion=((0.0, adhesion), (adhesion, 0.0)))
    apart = [[3.0, 8.0, 8.0], [2.97 + sum(radii), 8.0, 8.0]]
    packing = ld.Packing(apart, radii, (16.0,) * 3, species=[0, 1])
    with ld.Simulation(packing, law) as sim:
        assert sim.state().films.tolist() == [[1, 2]]
        sim.lmp.command("group second id 2")
        sim.lmp.commands_string("timestep 0.05\nthermo_style custom step pe\nthermo 1")
        sim.lmp.command("fix pull second move linear 0.01 0 0")
        energies = []
        for _ in range(600):
            sim.lmp.command("run 1 post no")
            energies.append(sim.lmp.get_thermo("pe"))
        assert sim.state().films.size == 0
    size = np.abs(energies)
    torn = int(np.argmax(size < 1e-12))
    assert size[torn - 1] > 1e-6
    assert (size[torn:] < 1e-12).all()
    assert energies[-1] == 0.0


def test_droplets_that_hardly_touch() -> None:
    """Their energy is below 0 by rounding, -6e-32, which is no impossible shape."""
    start = ld.bidisperse(120, sizes=(0.9, 1.1), phi=0.25, dimension=3, seed=8).push_off()
    with ld.Simulation(start, ld.Droplet()) as sim:
        state = sim.compress(phi=0.3, tolerance=1e-4)[-1]
    assert abs(state.energy) < 1e-20


def test_a_floppy_gel_comes_to_rest() -> None:
    """Its films bear nothing, so that its forces are small beside their largest pull only."""
    start = ld.bidisperse(60, sizes=(0.9, 1.1), phi=0.25, dimension=3, seed=1).push_off()
    with ld.Simulation(start, ld.Droplet(adhesion=0.05)) as sim:
        sim.run(500, temperature=0.005, drag=0.3, seed=1)
        state = sim.relax(1e-4)
        assert state.converged
        assert state.minimizer == "lbfgs"
        assert len(state.films) > 20
        assert np.abs(state.contacts["force"]).max() < 1e-3 * 0.05
        state = sim.compress(phi=0.35, tolerance=1e-4)[-1]
    assert state.converged
    assert state.iterations < 1000
