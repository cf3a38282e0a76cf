"""The law `curved` in Python: its contacts and outlines, and runs with it."""

import lammps_deformable as ld
import numpy as np
import pytest
from mpi4py import MPI


@pytest.fixture(scope="module")
def states() -> dict[str, ld.State]:
    """A packing strained by 3 % beyond jamming, with each ring law."""
    jammed = ld.jam(ld.bidisperse(16, seed=1)).packing
    found = {}
    for law in ("balanced", "curved", "radical"):
        with ld.Simulation(jammed, ld.Ring(contact=law), comm=MPI.COMM_SELF) as sim:
            sim.deform(sim.box * 0.97)
            found[law] = sim.relax()
    return found


def test_energy(states: dict[str, ld.State]) -> None:
    """Tilts and curves lower the energy by about a per cent at this strain, on any way to rest."""
    below = 1.0 - states["curved"].energy / states["balanced"].energy
    assert 0.004 < below < 0.02
    assert states["curved"].residual <= 1e-6


def test_contacts(states: dict[str, ld.State]) -> None:
    """Forces and tilts are equal from both sides, and partners stand where they are."""
    state = states["curved"]
    table, centers = state.contacts, state.packing.positions
    rows = {(row["i"], row["j"], *row["image"]): row for row in table}
    for (i, j, a, b), row in rows.items():
        other = rows[j, i, -a, -b]
        assert row["force"] == other["force"]
        assert row["tilt"] == pytest.approx(other["tilt"], rel=1e-12)
        assert row["half_angle"] == -other["half_angle"]
        assert row["length"] == pytest.approx(other["length"], rel=1e-6)
        apart = centers[j] + np.array([a, b]) @ state.packing.box - centers[i]
        direction = np.arctan2(apart[1], apart[0])
        turn = np.remainder(row["angle"] - row["tilt"] - direction + np.pi, 2 * np.pi) - np.pi
        assert abs(turn) < 1e-12
        heights = state.packing.radii[[i, j]] - (row["indentation"], other["indentation"])
        assert sum(heights) == pytest.approx(row["distance"] * np.cos(row["tilt"]), rel=1e-9)
    assert 0.01 < np.abs(table["tilt"]).max() < 0.1
    assert (states["balanced"].contacts["tilt"] == 0).all()


def test_outlines(states: dict[str, ld.State]) -> None:
    """They are drawn with the arcs: their areas and perimeters are those of the law."""
    state = states["curved"]
    assert np.abs(state.contacts["half_angle"]).max() > 0.01
    for outline, area in zip(state._parallels(same_area=True), state.results["area"], strict=True):
        x, y = outline.T
        found = 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))
        assert found == pytest.approx(area, rel=1e-6)
    for outline, perimeter in zip(state._parallels(points=2000), state.perimeters, strict=True):
        edges = np.roll(outline, -1, axis=0) - outline
        assert np.hypot(*edges.T).sum() == pytest.approx(perimeter, rel=2e-6)


def test_confluence() -> None:
    """Free arcs vanish near it; beyond, the undeformed disks overlap by a tenth of the box."""
    jammed = ld.jam(ld.bidisperse(8, seed=1)).packing
    law = ld.Ring(contact="curved", reach=1.0)
    for phi in (1.0, 1.1):
        with ld.Simulation(jammed.at(phi), law) as sim:
            state = sim.relax()
            assert sim.lmp.extract_global("ntimestep") < 20_000  # not the patience of 60 000
        assert (not state.converged) == (state.residual > 1e-6)
        assert np.isfinite(state.energy)
        assert (state.results["area"] > 0).all()


# number, seed and packing fraction; particles are then moved by a tenth of their diameter
CROWDED = [(12, 25, 1.05), (8, 4, 1.0), (8, 11, 1.05), (8, 22, 1.05), (12, 8, 1.05), (16, 5, 1.05)]


def crowded(number, seed, phi):
    packing = ld.jam(ld.bidisperse(number, seed=seed)).packing.at(phi)
    moved = np.random.default_rng(seed).normal(0.0, 0.08, packing.positions.shape)
    return ld.Packing(
        packing.positions + moved, packing.radii, packing.box, species=packing.species
    )


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_lines_begin_straight_where_they_lead_astray():
    """Those that may turn from there have less energy; those that are held, as much."""
    for case in CROWDED:
        found = {}
        for contact in ("balanced", "curved"):
            law = ld.Ring(kA=1.0, kP=0.1, contact=contact)
            with ld.Simulation(crowded(*case), law) as sim:
                state = sim.state()
                limited = sim.lmp.numpy.extract_compute("deformable_beyond", 0, 1)[4]
            assert np.isfinite([state.energy, state.pressure, *state.pressure_tensor.flat]).all()
            assert state.beyond > 0
            found[contact] = state
        assert state.energy <= found["balanced"].energy * (1 + 1e-6)
        if limited == len(state.contacts) / 2:
            assert state.energy == pytest.approx(found["balanced"].energy, rel=1e-6)
