"""The law `curved` in Python: its contacts and outlines, and runs with it."""

import csv
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.store import SERIES, append_frame
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


def test_force_is_along_normals(states: dict[str, ld.State]) -> None:
    """Nothing but p L n: they sum to zero at rest, to the tolerance of the relaxation."""
    table = states["curved"].contacts
    out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
    force = np.zeros_like(states["curved"].packing.positions)
    np.add.at(force, table["i"], table["force"][:, None] * out)
    assert np.abs(force).max() < 2e-6 * table["force"].mean()


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


def test_runs(tmp_path: Path) -> None:
    """The law comes back."""
    jammed = ld.jam(ld.bidisperse(16, seed=1)).packing
    law, folder = ld.Ring(contact="curved"), tmp_path / "run"
    with ld.Simulation(jammed, law, comm=MPI.COMM_SELF) as sim:
        last = sim.compress(record=folder, strain=0.02, steps=2)[-1]
    with ld.Run(folder).simulation(MPI.COMM_SELF) as again:
        assert again.law == law
        assert again.state().energy == pytest.approx(last.energy, rel=1e-9)


def test_series_of_an_older_version(states: dict[str, ld.State], tmp_path: Path) -> None:
    """Rows that are appended have the columns that the series was begun with."""
    state = states["curved"]
    numbers = state._numbers()
    old = {name: value for name, value in numbers.items() if name != "stalled"}
    for number, values in enumerate((old, numbers)):
        append_frame(tmp_path, number, state.packing, state._particle_values(), values)
    with (tmp_path / SERIES).open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["frame", *old]
    assert [len(row) for row in rows] == [len(head)] * 2
    assert rows[0][1:] == rows[1][1:]


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
