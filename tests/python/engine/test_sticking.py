"""Droplets that stick: their states and outlines, and what is attached."""

import math
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from mpi4py import MPI
from shapely.geometry import Polygon

W = 0.3
STRETCHED = 2.2  # beyond touch; the film of two droplets lets go at 2.287


def droplets(adhesion: Any = W, **settings: Any) -> ld.Ring:
    given: dict[str, Any] = {"kA": math.inf, "kP": 0.0, "tension": 1.0}
    return ld.Ring(contact="curved", adhesion=adhesion, **(given | settings))


def pair(distance: float, second: float = 1.0, walls: Any = ()) -> ld.Packing:
    x = np.array([[2.0, 2.0], [2.0 + distance, 2.0]])
    box, radii = np.diag([8.0, 4.0]), np.array([1.0, second])
    return ld.Packing(
        x, np.asarray(radii)[np.array([0, 1])], box, species=np.array([0, 1]), walls=tuple(walls)
    )


def place(sim: ld.Simulation, distance: float) -> ld.State:
    """The state with the second particle at this distance from the first one."""
    sim.lmp.command(f"set atom 2 x {2.0 + distance!r}")
    return sim.state()


@pytest.fixture(scope="module")
def stretched() -> ld.State:
    with ld.Simulation(pair(1.99), droplets(), comm=MPI.COMM_SELF) as sim:
        sim.state()
        return place(sim, STRETCHED)


def test_doublet() -> None:
    """Distance and energy at rest are those of the double bubble (docs/theory.md)."""
    second, distance, energy = 1.4, 2.0849686005, -0.251651222926
    with ld.Simulation(pair(0.95 * (1 + second), second), droplets()) as sim:
        state = sim.relax()
    assert state.converged
    assert state.energy == pytest.approx(energy, abs=1e-10)
    apart = np.subtract(*state.packing.positions)
    assert np.hypot(*apart) == pytest.approx(distance, abs=1e-5)
    table = state.contacts
    assert table["attached"].tolist() == [True, True]
    np.testing.assert_allclose(np.cos(table["contact_angle"]), 1 - W / 2, rtol=1e-9)
    assert state.films is not None
    assert state.films.tolist() == [[1, 2]]
    one, other = map(Polygon, state.outlines)
    for outline, area in zip((one, other), state.results["area"], strict=True):
        assert outline.area == pytest.approx(area, rel=1e-5)
    # they share the film: its ends, and what lies between
    assert one.intersection(other).area < 1e-6
    shared = [p for p in state.outlines[0] if np.hypot(*(p - state.outlines[1]).T).min() < 1e-5]
    height = np.ptp(shared, axis=0)[1]
    bend = abs(table["half_angle"][0])
    assert height == pytest.approx(table["length"][0] * np.sinc(bend / np.pi), rel=1e-4)


def test_outlines_away_from_rest(stretched: ld.State) -> None:
    """The centers are held: outlines still share the ends of their film, and push nothing."""
    one, other = stretched.outlines
    shared = [p for p in one if np.hypot(*(p - other).T).min() < 1e-7]
    assert len(shared) == 2
    assert (stretched.contacts["force"] < -0.5).all()


def test_packing() -> None:
    """A floc of unequal droplets: areas of outlines, and forces that pull."""
    law = droplets([[0.2, 0.1], [0.1, 0.15]], kP=0.3)
    jammed = ld.jam(ld.bidisperse(12, seed=2)).packing
    with ld.Simulation(jammed, law, comm=MPI.COMM_SELF) as sim:
        sim.deform(sim.box * 0.99)
        state = sim.relax()
    assert state.residual <= 1e-6
    assert (state.contacts["force"] < 0).any()
    areas = [Polygon(outline).area for outline in state.outlines]
    np.testing.assert_allclose(areas, state.results["area"], rtol=1e-4)
    overlap = sum(
        Polygon(state.outlines[row["i"]])
        .intersection(Polygon(state.outlines[row["j"]] + row["image"] @ state.packing.box))
        .area
        for row in state.contacts
    )
    assert overlap < 1e-4 * sum(areas)


def test_picture(stretched: ld.State) -> None:
    """Contacts and forces of films are drawn, those that pull in another color."""
    pytest.importorskip("matplotlib")
    axes = stretched.plot(contacts=True, forces=True)
    films, forces = axes.collections[-2:]
    ends = np.array([film[[0, -1]] for film in films.get_segments()])
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    np.testing.assert_allclose(length, stretched.contacts["length"], rtol=1e-6)
    assert (np.array(forces.get_linewidths()) > 0).all()
    assert len({tuple(color) for color in forces.get_colors()}) == 1
    axes.figure.clear()


def test_memory(stretched: ld.State, tmp_path: Path) -> None:
    """Positions do not tell whether a pair is attached; a state does, and its files."""
    assert stretched.energy > 0.005
    stretched.save(tmp_path / "stretched")
    with ld.Run(tmp_path / "stretched").simulation(MPI.COMM_SELF) as sim:
        assert sim.state().energy == pytest.approx(stretched.energy, rel=1e-12)
        assert place(sim, 2.5).energy == 0.0  # it has let go
        free = place(sim, STRETCHED)
    assert free.energy == 0.0
    assert free.films is not None
    assert free.films.shape == (0, 2)
    free.save(tmp_path / "free")
    with ld.Run(tmp_path / "free").simulation(MPI.COMM_SELF) as sim:
        assert sim.state().energy == 0.0


def test_free_circles_that_overlap(tmp_path: Path) -> None:
    """None attached is a memory too: without one, they would attach."""
    with ld.Simulation(pair(1.99), droplets(0.0), comm=MPI.COMM_SELF) as sim:
        free = sim.state()
    assert free.films is None
    assert "attached" not in (free.save(tmp_path), (tmp_path / "packing.data").read_text())[1]


def test_a_simulation_of_a_state(stretched: ld.State) -> None:
    with ld.Simulation(stretched, stretched.law, comm=MPI.COMM_SELF) as sim:
        assert sim.state().energy == pytest.approx(stretched.energy, rel=1e-12)
        sim.reset(stretched.packing)
        assert sim.state().energy == 0.0
        sim.reset(stretched)
        assert sim.state().energy == pytest.approx(stretched.energy, rel=1e-12)


def test_script(stretched: ld.State, tmp_path: Path) -> None:
    """LAMMPS by itself attaches the same pairs."""
    stretched.save(tmp_path)
    script = (tmp_path / "in.lammps").read_text().splitlines()
    first = script.index("fix_modify deformable_films attached none")
    assert script[first + 1] == "fix_modify deformable_films attached 1 2"
    assert first < script.index("run 0")


def test_walls(tmp_path: Path) -> None:
    """A droplet on a wall, alone: Young's angle; and pulled off by a part."""
    walls = ld.BoxWall((8, 4), adhesion=0.4).parts
    start = pair(4.0, walls=walls)
    law = droplets(0.1)
    with ld.Simulation(start, law, comm=MPI.COMM_SELF) as sim:
        sim.lmp.command("set atom 1 x 0.99")
        state = sim.relax()
        (row,) = state.contacts
        assert (row["j"], row["attached"]) == (-1, True)
        assert np.cos(row["contact_angle"]) == pytest.approx(1 - 0.4, rel=1e-9)
        # the cap of a circle that meets the wall at this angle
        angle = np.pi - np.arccos(0.6)
        q = np.sqrt(np.pi / (angle - np.sin(angle) * np.cos(angle)))
        film = 2 * q * np.sin(angle)
        assert row["length"] == pytest.approx(film, rel=1e-6)
        energy = 2 * q * angle + 0.6 * film - 2 * np.pi
        assert state.energy == pytest.approx(energy, abs=1e-9)
        assert Polygon(state.outlines[0]).area == pytest.approx(np.pi, rel=1e-5)
        sim.lmp.command("set atom 1 x 1.005")
        off = sim.state()
        sim.reset(off.packing)
        assert sim.state().energy == 0.0  # the circle does not reach the wall
    assert off.contacts["force"] < 0
    off.save(tmp_path)
    with ld.Run(tmp_path).simulation(MPI.COMM_SELF) as sim:
        again = sim.state()
    assert again.energy == pytest.approx(off.energy, rel=1e-12)
    assert again.packing.walls == walls


def test_what_refuses() -> None:
    """One line each."""
    with ld.Simulation(pair(1.8), droplets(), comm=MPI.COMM_SELF) as sim:
        state = sim.relax()
    sticky = ld.BoxWall((8, 4), adhesion=0.1).parts
    for call in (
        lambda: ld.jam(pair(3.0), droplets()).packing,
        lambda: ld.jam(pair(3.0, walls=sticky), droplets(0.0)).packing,
        state.hessian,
        state.moduli,
        state.modes,
        lambda: state._parallels(np.full(2, 0.1)),
    ):
        with pytest.raises(ld.ParameterError, match="particles have an adhesion") as error:
            call()
        assert "\n" not in str(error.value)


def test_lost_energy() -> None:
    """Two droplets meet: what they lose as they attach completes the balance of energy."""
    with ld.Simulation(pair(2.02), droplets(), comm=MPI.COMM_SELF) as sim:
        sim.lmp.command("set atom 2 vx -0.1")
        start = sim.state()
        end = sim.run(400, every=100, timestep=0.01)[-1]
    assert start.lost_energy == start.energy == 0.0
    assert end.films is not None
    assert len(end.films) == 1
    assert end.lost_energy > 0.01
    whole = end.energy + end.kinetic_energy + end.lost_energy
    assert whole == pytest.approx(start.kinetic_energy, abs=1e-3 * end.lost_energy)


@pytest.mark.parametrize(("kA", "kP", "w"), [(20.0, 0.0, 0.3), (10.0, 0.1, 0.3)])
def test_last_film_lets_go(kA: float, kP: float, w: float) -> None:
    """Also of cells, whose tensions are known to rounding, where no other contact bears a force."""
    with ld.Simulation(pair(1.99), droplets(w, kA=kA, kP=kP)) as sim:
        assert place(sim, STRETCHED).contacts["attached"].all()
        assert len(place(sim, 2.31).contacts) == 0
