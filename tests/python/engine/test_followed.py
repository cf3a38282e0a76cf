"""Commands given to `sim.lmp`: a saved state has its energy, or one line says why not."""

from collections.abc import Iterator
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

SPECIES = "# UNITS: lj CONTRIBUTOR: a test\na 0.45 2 inf 0\nb 0.6 1 inf 0\n"

FOLLOWED = {
    "atoms": (
        "set atom 1 type 2\ngroup one id 3\ndelete_atoms group one\n"
        "create_atoms 1 single 0.5 0.5 0.0\ndelete_atoms overlap 0.9 all all\n"
    ),
    "reset_atoms id": "group g id 3\ndelete_atoms group g compress no\nreset_atoms id",
    "replicate": "replicate 2 1 1",
    "change_box of another origin": "change_box all x final -3 4 y delta 1 2 remap",
    "change_box to a tilted box": "change_box all xy delta 0.5 remap",
    "displace_atoms beyond the box": "displace_atoms all move 100.1 -50 0",
    "run": "fix a all nve\ntimestep 0.01\nvelocity all create 1e-4 3 mom yes\nrun 100",
    "fix with energy": "fix a all spring/self 0.1\nfix_modify a energy yes",
    "fix rigid": "fix r all rigid single\nrun 3",
    "domains": "comm_style tiled\nbalance 1.1 rcb\nrun_style respa 2 2",
    "IDs of a user": "compute virial all ke\ncompute beyond all ke\nfix results all nve",
}

REFUSED = {
    "pair_style none": ("pair_style none", "pair_style"),
    "another law": ("pair_style deformable/ring contact radical", "pair_style"),
    "another species file": ("pair_coeff * * {species} a b", "pair_coeff"),
    "ramp": (
        "variable k equal 2.0\nfix ramp all adapt 1 pair deformable/ring kA 1 1 v_k\nrun 1",
        "fix adapt",
    ),
    "clear": ("clear", "no particles"),
    "uncompute": ("uncompute deformable_virial", "deformable_virial"),
    "boundaries": ("change_box all boundary f f p", "boundary"),
    "mass": ("mass 2 3.0", r"atom \d+ is 3"),
    "gaps in IDs": ("group one id 3\ndelete_atoms group one compress no", "reset_atoms id"),
    "overlaps": ("displace_atoms all random 1 1 0 3", "contact line|bulges"),
}


@pytest.fixture
def sim(jammed: ld.Packing) -> Iterator[ld.Simulation]:
    with ld.Simulation(jammed.at(0.87), ld.Ring()) as sim:
        yield sim


def tell(sim: ld.Simulation, commands: str) -> None:
    for command in commands.splitlines():
        sim.lmp.command(command)


def assert_saved_as_it_is(state: ld.State, folder: Path) -> None:
    state.save(folder, mode="w")
    with ld.Run(folder).simulation() as again:
        found = again.state()
    # balanced contacts are known to 1e-8 of their forces
    assert found.energy == pytest.approx(state.energy, rel=1e-7, abs=1e-16)
    largest = np.abs(state.pressure_tensor).max()
    np.testing.assert_allclose(
        found.pressure_tensor, state.pressure_tensor, rtol=0, atol=1e-7 * largest + 1e-14
    )


@pytest.mark.filterwarnings("ignore::lammps_deformable.StalledWarning")
@pytest.mark.parametrize("commands", FOLLOWED.values(), ids=FOLLOWED)
def test_states_follow(commands: str, sim: ld.Simulation, tmp_path: Path) -> None:
    tell(sim, commands)
    for call in (sim.state, sim.relax):
        state = call()
        assert len(state.packing) == sim.lmp.get_natoms()
        assert_saved_as_it_is(state, tmp_path)


@pytest.mark.parametrize(("commands", "named"), REFUSED.values(), ids=REFUSED)
def test_the_rest_is_refused(commands: str, named: str, sim: ld.Simulation, tmp_path: Path) -> None:
    """By one line, as often as it is asked; `restart` brings the simulation back."""
    packing = sim.state().packing
    (tmp_path / "species").write_text(SPECIES)
    tell(sim, commands.format(species=tmp_path / "species"))
    for call in (sim.state, sim.relax, sim.state):
        with pytest.raises(ld.LammpsError, match=rf"\A[^\n]*({named})[^\n]*\Z"):
            call()
    sim.reset(packing)
    assert_saved_as_it_is(sim.state(), tmp_path)


def test_particles_of_atom_style_sphere_need_a_mass(tmp_path: Path) -> None:
    """New ones get another from LAMMPS."""
    loose = ld.polydisperse(4, [0.5, 0.4, 0.5, 0.4], phi=0.05, seed=2)
    with ld.Simulation(loose, ld.Ring()) as sim:
        tell(sim, "create_atoms 1 random 1 3 NULL overlap 1.5 maxtry 1000\nset atom 1 diameter 0.7")
        with pytest.raises(ld.LammpsError, match=r"atom 5 is 0.52.*set group all mass 1"):
            sim.state()
        tell(sim, "set group all mass 1")
        state = sim.relax()
    assert state.packing.radii.tolist() == [0.35, 0.4, 0.5, 0.4, 0.5]
    assert_saved_as_it_is(state, tmp_path)


@pytest.mark.parametrize(
    ("commands", "named"),
    [
        ("fix w all deformable/wall plane 0 0 0 1", "walls"),
        ("neigh_modify exclude type 1 1", "excluded pairs"),
        ("fix rub all deformable/friction 0.5 1 0", "friction of contacts"),
    ],
)
def test_what_is_not_saved_is_named(commands: str, named: str, tmp_path: Path) -> None:
    with ld.Simulation(ld.bidisperse(1, phi=0.2, seed=1), ld.Ring()) as sim:
        tell(sim, commands)
        state = sim.state()
    assert state.unsaved == named
    with pytest.warns(ld.UnsavedWarning, match=named):
        state.save(tmp_path)


def test_disks_follow_as_well(jammed: ld.Packing) -> None:
    commands = (
        "set atom 1 type 2\ngroup one id 3\ndelete_atoms group one\n"
        "change_box all xy delta 0.1 remap"
    )
    with ld.Simulation(jammed.at(0.87), ld.SoftContact()) as disks:
        tell(disks, commands)
        state = disks.relax()
    assert state.packing.species[0] == 1
    assert len(state.packing) == len(jammed) - 1
    with ld.Simulation(state.packing, ld.SoftContact()) as fresh:
        assert fresh.state().energy == pytest.approx(state.energy, rel=1e-9)


@pytest.mark.parametrize(
    ("commands", "named"),
    [
        ("pair_style none", "pair_style"),
        ("pair_coeff 1 2 3.0 0.5", "pair_coeff"),
        ("uncompute overlaps", "overlaps"),
    ],
)
def test_disks_and_beads_refuse_the_rest(commands: str, named: str) -> None:
    start = ld.Packing([[1, 1], [2.2, 1]], [0.5, 0.6], [[5.0, 0.0], [0.0, 5.0]], species=[0, 1])
    for sim in (
        ld.Simulation(start, ld.SoftContact()),
        ld.Simulation(start, ld.DeformablePolygon(20, smooth=False)),
    ):
        with sim:
            tell(sim, commands)
            for call in (sim.state, sim.relax):
                with pytest.raises(ld.LammpsError, match=rf"\A[^\n]*{named}[^\n]*\Z"):
                    call()


@pytest.mark.parametrize("commands", ["replicate 2 1 1", "unfix area0"])
def test_beads_stay(commands: str) -> None:
    start = ld.Packing([[1, 1], [2.2, 1]], [0.5, 0.6], [[5.0, 0.0], [0.0, 5.0]], species=[0, 1])
    with ld.Simulation(start, ld.DeformablePolygon(20, smooth=False)) as sim:
        tell(sim, commands)
        with pytest.raises(ld.LammpsError, match=r"beads|area0"):
            sim.state()


@pytest.mark.parametrize("periods", [1000, 1e305])
def test_obstacles_many_boxes_away(periods: float) -> None:
    """Their images are in the box; at any distance they are found at once."""
    energy = []
    for y in (0.7, 0.7 + 8.0 * periods):
        packing = ld.Packing([[1.0, 1.0]], 0.5, [[8.0, 0.0], [0.0, 8.0]])
        with ld.Simulation(packing, ld.Ring()) as sim:
            tell(sim, f"fix w all deformable/wall disk 1.6 {y!r} 0.2")
            energy.append(sim.state().energy)
    assert np.isfinite(energy).all()
    if periods < 1e9:  # beyond, the place within a period is lost in rounding
        assert energy[1] == pytest.approx(energy[0], rel=1e-7)
