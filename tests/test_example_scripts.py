"""The Python examples run and print what their logs have."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from programs import BIN
from programs import output as text

EXAMPLES = Path(__file__).parents[1] / "examples"


def rows(*command: str, cwd: Path) -> np.ndarray:
    """Numbers in the lines of a script's output that begin with phi, one row a line."""
    return numbers(text(*command, cwd=cwd))


def numbers(printed: str) -> np.ndarray:
    lines = [line for line in printed.splitlines() if line.startswith("phi")]
    rows = [re.findall(r" (\d\S*)", line) for line in lines]
    return np.array(rows, dtype=float)


def test_compress_prints_its_log(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    shutil.copy(EXAMPLES / "compress" / "compress.py", tmp_path)
    phi, pressure, z = rows("python", "compress.py", cwd=tmp_path).T
    expected = numbers((EXAMPLES / "compress" / "compress.log").read_text()).T
    # the packing depends on the last digit, so that another processor may find another one
    assert phi == pytest.approx(expected[0], abs=0.02)
    assert z == pytest.approx(expected[2], abs=0.3)
    assert (np.diff(pressure) > 0).all()
    assert (tmp_path / "packing.png").stat().st_size > 10_000
    assert (tmp_path / "run" / "summary.json").exists()


def test_drum(tmp_path: Path) -> None:
    """Pressure rises, walls are in balance, and LAMMPS alone takes up the last state."""
    pytest.importorskip("matplotlib")
    shutil.copy(EXAMPLES / "drum" / "drum.py", tmp_path)
    printed = text("python", "drum.py", cwd=tmp_path)
    phi, pressure, on_disk = numbers(printed).T
    expected = numbers((EXAMPLES / "drum" / "drum.log").read_text()).T
    # the packing depends on the last digit, so that another processor may find another one
    assert phi == pytest.approx(expected[0], abs=0.03)
    assert pressure[-1] > 10 * pressure[0] > 0
    assert (on_disk > 0).all()
    # relaxed to 1e-4 of the mean contact force, which is far below that on a wall
    assert float(printed.split()[-1]) < 150 * 1e-4
    assert (tmp_path / "drum.png").stat().st_size > 10_000
    energy = text("lmp", "-in", "in.lammps", "-log", "none", cwd=tmp_path / "run")
    row = energy[energy.index("PotEng") :].splitlines()[1].split()
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert float(row[1]) == pytest.approx(summary["state"]["energy"], rel=1e-12)
    assert len(summary["walls"]) == 4


def test_compress_mpi_gives_the_same_on_two_ranks(tmp_path: Path) -> None:
    shutil.copy(EXAMPLES / "mpi" / "compress_mpi.py", tmp_path)
    serial = rows("python", "compress_mpi.py", cwd=tmp_path)
    command = ("mpiexec", "-n", "2", str(BIN / "python"), "-m", "mpi4py", "compress_mpi.py")
    assert len(serial) == 2
    assert rows(*command, cwd=tmp_path) == pytest.approx(serial, rel=1e-4)


def test_soft_and_stiff_share_their_contacts(tmp_path: Path) -> None:
    """Contact lines move into the soft particles, and LAMMPS alone finds the same pressures."""
    pytest.importorskip("matplotlib")
    folder = shutil.copytree(EXAMPLES / "soft_and_stiff", tmp_path / "example")
    (folder / "packing.png").unlink()
    printed = text("python", "soft_and_stiff.py", cwd=folder)
    _, pressure, _ = numbers(printed).T
    summary = printed[printed.rindex("phi") :].partition("\n")[2]
    count, share, radical, longer, p_soft, lost_soft, p_stiff, lost_stiff = map(
        float, re.findall(r"\d[\d.]*(?:e[-+]\d+)?", summary)
    )
    assert count > 30
    assert share > radical + 0.05
    # the force p L is the same on both sides
    assert longer > 1.5
    assert p_stiff > p_soft
    assert lost_stiff < lost_soft
    assert (folder / "packing.png").stat().st_size > 10_000

    log = text("lmp", "-in", "in.soft_and_stiff", cwd=folder)
    pattern = r"^strain .* pressure = (\S+), .* soft (\S+), of stiff (\S+)$"
    found, soft, stiff = np.array(re.findall(pattern, log, re.MULTILINE), dtype=float).T
    # the pressure of a minimum is less accurate than its forces
    assert found == pytest.approx(pressure, rel=1e-3)
    assert (soft > 1.5 * stiff).all()


def printed(folder: Path, script: str, *arguments: str) -> list[list[float]]:
    """Numbers on each line of a script's output."""
    return lines(text("python", script, *arguments, cwd=folder))


def lines(text: str) -> list[list[float]]:
    return [
        [float(word) for word in re.findall(r"[ ^](\d\S*?|-\d\S*?),?(?=\s|$)", line)]
        for line in text.splitlines()
    ]


@pytest.mark.slow
def test_fluid_diffuses_and_glass_does_not(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for script in ("thermal.py", "analysis.py"):
        shutil.copy(EXAMPLES / "thermal" / script, tmp_path)
    temperatures = printed(tmp_path, "thermal.py")
    runs = [f"{name}/trajectory.lammpstrj" for name in ("fluid", "glass")]
    found = printed(tmp_path, "analysis.py", *runs)
    committed = lines((EXAMPLES / "thermal" / "thermal.log").read_text())
    page = (EXAMPLES / "thermal" / "README.md").read_text()
    (_, t_fluid), (_, t_glass), fluid, glass = committed
    assert f"| 0.6 | {t_fluid} | {fluid[1]} | {fluid[2]:.1e} |".replace("e-0", "e-") in page
    assert f"| 0.9 | {t_glass} | {glass[1]} | |" in page
    for printed_lines in (temperatures + found, committed):
        (_, t_fluid), (_, t_glass), fluid, glass = printed_lines
        # 63 pairs of degrees of freedom over 25 times 1/friction, at four sigma
        assert max(abs(t_fluid - 1.0), abs(t_glass - 1.0)) < 4.0 / (63 * 25) ** 0.5
        assert 0.5 < fluid[1] < 1.3  # diffusion begins; seeds differ by 0.1
        assert 1e-5 < fluid[2] < 2e-4  # slower than a single particle, temperature/friction
        assert abs(glass[1]) < 0.2  # a plateau
        assert glass[0] < 0.1**2  # within the cages
        for structure in (fluid, glass):
            assert 0.9 < structure[4] < 1.7  # neighbors touch
            assert structure[5] == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_pictures_of_a_run(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for script in ("pictures.py", "analysis.py"):
        shutil.copy(EXAMPLES / "pictures" / script, tmp_path)
    shapes = np.array(printed(tmp_path, "pictures.py"))
    assert len(shapes) == 15
    assert (np.diff(shapes, axis=0) > 0.0).all()  # denser and less round
    for picture in ("pictures.png", "compression.gif"):
        assert 10_000 < (tmp_path / picture).stat().st_size < 1_000_000
    phi, z, s, k = np.array(printed(tmp_path, "analysis.py")).T
    assert phi[1:] == pytest.approx(
        shapes[2::3, 0], abs=1e-4
    )  # of each third frame from the start on
    assert (np.diff(z) > 0.0).all()
    assert (s > 1.5).all()
    assert k * 1.2 == pytest.approx(2.0 * np.pi, rel=0.3)  # wavelength of a particle's diameter


def test_errors_over_times(tmp_path: Path) -> None:
    """The picture of README follows from the report."""
    pytest.importorskip("matplotlib")
    text("python", str(EXAMPLES / "pictures" / "accuracy.py"), cwd=tmp_path)
    assert (tmp_path / "accuracy.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.slow
def test_animation(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    shutil.copy(EXAMPLES / "pictures" / "shear.py", tmp_path)
    text("python", "shear.py", cwd=tmp_path)
    assert 500_000 < (tmp_path / "shear.gif").stat().st_size < 1_500_000


def test_shear_begins_at_the_modulus_and_yields(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    script = (EXAMPLES / "shear" / "shear.py").read_text()
    for whole, part in (
        ("STRAIN, STEPS = 0.90, 1.0, 200", "STRAIN, STEPS = 0.90, 0.3, 30"),
        ("bidisperse(64, ", "bidisperse(24, "),
    ):
        assert whole in script
        script = script.replace(whole, part)
    (tmp_path / "shear.py").write_text(script)
    printed = text("python", "shear.py", cwd=tmp_path)
    (pressure,) = re.findall(r"^phi .* pressure (\S+) ", printed, re.M)
    (stress,) = re.findall(r"largest stress (\S+) ", printed)
    (events,) = re.findall(r"plastic events (\d+)", printed)
    assert 0.0 < float(stress) < float(pressure)
    assert int(events) > 0
    assert (tmp_path / "shear.png").stat().st_size > 10_000


def test_ensemble_has_the_same_digits_on_ranks(tmp_path: Path) -> None:
    shutil.copy(EXAMPLES / "mpi" / "ensemble.py", tmp_path)
    python = (str(BIN / "python"), "-m", "mpi4py", "ensemble.py")
    printed = {text("python", "ensemble.py", cwd=tmp_path)}
    printed |= {text("mpiexec", "-n", "2", *python, cwd=tmp_path)}
    (line,) = printed
    pressure = float(line.split()[1])
    assert 1e-6 < pressure < 1e-2


def test_emulsion_jams_and_becomes_dense(tmp_path: Path) -> None:
    """Pressures rise to those of hexagonal arrays, and droplets have six neighbors in the end."""
    pytest.importorskip("matplotlib")
    script = (EXAMPLES / "emulsion" / "emulsion.py").read_text()
    for whole, part in (
        ("NUMBER, SEEDS = 64, range(1, 9)", "NUMBER, SEEDS = 16, range(1, 4)"),
        ("parallel_map(measure, SEEDS)", "parallel_map(measure, SEEDS, workers=1)"),
        ('if __name__ == "__main__":', "if True:"),
    ):
        assert whole in script
        script = script.replace(whole, part)
    (tmp_path / "emulsion.py").write_text(script)
    printed = text("python", "emulsion.py", cwd=tmp_path)
    (onset,) = re.findall(r"^phi_J = (\S+) ± ", printed, re.M)
    assert float(onset) == pytest.approx(0.83, abs=0.03)
    for packing in json.loads((tmp_path / "emulsion.json").read_text()):
        rows = np.array(packing["rows"])
        pressure, z = rows[-2:, 0], rows[-2:, 1]
        # of sizes that differ, 16 droplets in a square box are not quite the hexagonal array
        phi = np.array([0.98, 0.99])
        hexagonal = np.sqrt(phi / 0.9069) * (np.sqrt(0.0931 / (1.0 - phi)) - 1.0)
        assert pressure == pytest.approx(hexagonal, rel=0.1)
        assert z[-1] == pytest.approx(6.0, abs=1e-9)
    assert (tmp_path / "emulsion.png").stat().st_size > 10_000


def test_funnel(tmp_path: Path) -> None:
    """Its volume is exact, and it carries all that is in it."""
    pytest.importorskip("matplotlib")
    shutil.copy(EXAMPLES / "funnel" / "funnel.py", tmp_path)
    printed = text("python", "funnel.py", cwd=tmp_path).splitlines()
    expected = (EXAMPLES / "funnel" / "funnel.log").read_text().splitlines()
    assert printed[0] == expected[0]
    assert float(printed[1].split()[-4]) == pytest.approx(1.0, abs=1e-3)
    assert (tmp_path / "funnel.png").stat().st_size > 10_000
