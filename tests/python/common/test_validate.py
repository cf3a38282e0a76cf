"""Errors for wrong arguments name the argument and its value in one line."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Ring
from refusals import refused

from validation.finite_strain import shear_modulus

P = ld.bidisperse(4, seed=1)

# A call, the argument that is wrong, and its value as the message shows it.
CASES: list[tuple[Callable[[], Any], str, str]] = [
    (lambda: ld.Simulation(P, "ring"), "law", "'ring'"),
    (lambda: ld.Simulation(P, Ring), "law", "call it, Ring(...)"),
    (lambda: ld.Simulation("base", Ring()), "packing", "'base'"),
    (lambda: ld.jam(P, "ring").packing, "law", "'ring'"),
    (lambda: shear_modulus(P, 0.01), "state", "a Packing"),
    (lambda: ld.Run(3), "source", "3"),
    (lambda: ld.bidisperse("16", seed=1), "number", "'16'"),
    (lambda: ld.Sphere(np.True_), "radius of a Sphere", "True"),
    (lambda: ld.Simulation(P, Ring(), comm=1), "comm", "1"),
    (
        lambda: ld.Simulation._within(P, ld.DeformablePolygon(50, smooth=False), 3),
        "walls",
        "3",
    ),
    (lambda: ld.Run([P]).movie("a.gif"), "a state of a movie", "a Packing"),
    (lambda: ld.Run([]).movie(3), "path", "3"),
    (lambda: ld.compare(None), "start", "None"),
    (lambda: ld.compare(P, strain="a"), "strain", "'a'"),
    (lambda: ld.compare(P, steps="a"), "steps", "'a'"),
    (lambda: ld.compare(P, polygon=3), "polygon", "3"),
    (lambda: ld.compare(P, keep=True), "keep", "True"),
    (lambda: ld.jackknife(5), "values", "5"),
    (lambda: ld.jackknife([1, 2], 3), "f", "3"),
    (lambda: ld.parallel_map(3, [1]), "f", "3"),
    (lambda: ld.parallel_map(len, 3), "items", "3"),
    (lambda: ld.Simulation(P, ld.SoftContact()).relax(1e-3, max_steps=0), "max_steps", "0"),
    (lambda: ld.SoftContact(k=-1.0), "k", "-1.0"),
    (lambda: ld.Simulation(P, Ring()).reset(None), "packing", "None"),
    (
        lambda: ld.Simulation(P, ld.SoftContact()).compress(strain=0.1, steps=10**400)[1],
        "steps",
        "...",
    ),
]


def test_one_line_names_argument_and_value() -> None:
    for call, name, value in CASES:
        with refused(rf"^{re.escape(name)} must .*{re.escape(value)}$"):
            call()


def test_a_run_needs_its_folder_and_a_communicator(state: ld.State, tmp_path: Path) -> None:
    with pytest.raises(ld.FileError, match=r"\Ano saved run in 'typo': [^\n]*\Z"):
        ld.Run("typo")
    state.save(tmp_path)
    for call in (ld.Run(tmp_path).simulation, ld.Run(tmp_path).resume):
        with pytest.raises(ld.ParameterError, match="comm must be of the kind Comm, not 0"):
            call(comm=0)


def test_a_closed_simulation_refuses_calls(tmp_path: Path) -> None:
    sim = ld.Simulation(P, Ring())
    calls: list[Callable[[], Any]] = [
        sim.relax,
        sim.state,
        lambda: sim.box,
        lambda: sim.lmp,
        lambda: sim.deform(P.box),
        lambda: sim.compress(strain=0.01),
        lambda: sim.shear(0.01),
        lambda: sim.run(1, temperature=1.0),
        lambda: sim.reset(P),
        lambda: sim.compress(record=tmp_path, strain=0.01),
    ]
    assert not sim.closed
    sim.close()
    sim.close()  # which changes nothing
    assert sim.closed
    for call in calls:
        with pytest.raises(ld.ParameterError, match=f"this {type(sim).__name__} is closed"):
            call()


@pytest.mark.parametrize("folder", ["/dev/null/x", "/proc/none"])
def test_folders_that_cannot_be_written(folder: str, state: ld.State) -> None:
    for call in (
        lambda: state.save(folder),
        lambda: ld.Simulation(state, state.law).compress(strain=0.01, record=folder),
        lambda: ld.Run([state]).movie(f"{folder}/movie.gif"),
    ):
        told = rf"\A'{folder}[^\n]* cannot be written: |\A'/dev/null' is a file, not a folder: "
        with pytest.raises(ld.FileError, match=told):
            call()


def test_a_simulation_outlives_a_restart_that_is_refused(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, Ring(kA=[1.0, 2.0])) as sim:
        for wrong in (None, ld.bidisperse(4, fraction_large=0.0, seed=1).replace(species=range(4))):
            with pytest.raises(ld.ParameterError):
                sim.reset(wrong)
        assert sim.state().packing.phi == pytest.approx(jammed.phi)


def test_colors_have_names(state: ld.State) -> None:
    """Those of attributes, and those of a trajectory."""
    assert state._values("pressure").tolist() == state.pressures.tolist()
    assert state._values("vx").tolist() == state.velocities[:, 0].tolist()
    for wrong in ("energy", "beauty", 3, None):
        with pytest.raises(ld.ParameterError, match=r"area_deficit.*pressure.*not"):
            state._values(wrong)


def test_a_mask_makes_two_species() -> None:
    radius = np.array([0.5, 0.7])
    packing = ld.Packing([[1, 1], [3, 1]], radius, (4, 2), species=radius > 0.6)
    assert packing.species.tolist() == [0, 1]
