"""Input scripts and snippets of the documentation run as they are, with the right results."""

import json
import os
import re
import shlex
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import typer
from lammps_deformable.cli.main import app
from programs import output

ROOT = Path(__file__).parents[1]
BIN = Path(sys.executable).parent
ENVIRONMENT = os.environ | {
    "PATH": f"{BIN}:{os.environ['PATH']}",  # as after activating the environment
    "MPLBACKEND": "agg",
    # without these, more ranks than cores take a hundred times as long
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1",
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT": "16",
}
NUMBER = r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?"


@pytest.fixture
def tree(tmp_path):
    """A copy of the examples and species files, to write in."""
    for name in ("examples", "potentials"):
        shutil.copytree(ROOT / name, tmp_path / name)
    return tmp_path


def run(folder, *command):
    """Output of a command of this environment."""
    return output(*command, cwd=folder, **ENVIRONMENT)


def test_logs_name_no_folder_of_a_machine():
    logs = [path for path in ROOT.glob("examples/*/log.*") if path.name != "log.lammps"]
    assert logs
    for log in logs:
        assert re.findall(r"(?<![\w.)])/\w+/.*", log.read_text()) == [], log


def table(log, header):
    """The last table of thermodynamic output with this header."""
    lines = log.splitlines()
    start = max(n for n, line in enumerate(lines) if line.split()[: len(header)] == header) + 1
    rows = []
    for line in lines[start:]:
        if not re.fullmatch(rf"\s*(?:{NUMBER}\s*)+", line):
            break
        rows.append([float(word) for word in line.split()])
    return np.array(rows).T


def numbers(log, pattern):
    """All numbers on the lines that a pattern matches."""
    lines = [line for line in log.splitlines() if re.match(pattern, line)]
    return np.array([[float(word) for word in re.findall(NUMBER, line)] for line in lines])


def test_beads(tree):
    """The area deficit is K a^2, reduced by the spacing of the beads and the stretch of springs."""
    log = run(tree / "examples" / "beads", "lmp", "-in", "in.beads")
    ((found, a2, exact),) = numbers(log, "area deficit")  # the 2 of "a^2" is a number too
    assert a2 == 2
    stretch, spacing = 0.785**2 / (1e4 / 96), np.pi**2 / (3 * 96**2 * 0.02)
    # to first order in each; the finite stiffness of the walls adds 2 K a L0/kr = 9e-5
    assert abs(found / exact - 1 + stretch + spacing) < 0.2 * (stretch + spacing)


def test_polygons(tree):
    """The area deficit is K a^2, less the stretch of springs; smooth polygons have no friction."""
    log = run(tree / "examples" / "polygons", "lmp", "-in", "in.polygons")
    ((found, _, exact),) = numbers(log, "area deficit")
    stretch = 0.785**2 / (1e4 / 96)
    # to first order; kr and the spacing of vertices add terms of second order
    assert abs(found / exact - 1 + stretch) < 0.5 * stretch


def test_hexagon(tree):
    log = run(tree / "examples" / "hexagon", "lmp", "-in", "in.hexagon")
    step, a, deficit, _, force, _, energy = table(log, ["Step", "v_a"])
    k = 33.74416677654674
    assert np.allclose(a, 0.005 * step, rtol=1e-14, atol=0.0)
    assert len(a) == 11
    # The default tolerance, 1e-8, is about a force that changes alone: da = G(0)/p df, with
    # G(0) = 3/(4 pi). All six together have da = a/(3 f) df, with p = k a^2, so they may be off by
    # more. The deficit is in proportion to f^(2/3), the energy is off by the square, and by the
    # rounding of steps that are small, up to 1e4 tolerances, in single precision.
    together = 1e-8 * k * 0.75 / np.pi
    for found, exact, error in (
        (deficit, k * a**2, 2 / 3 * together),
        (force, k**2 * a**3 / 3, together),
        (energy, k**2 * a**4 / 2, 1e4 * 1e-8 * 2.0**-24),
    ):
        assert np.abs(found - exact).max() < error * np.abs(exact).max()

    ((x, y, relaxed, exact),) = numbers(log, "back at")
    assert abs(x) < 1e-12
    assert abs(y) < 1e-12
    assert relaxed == exact == pytest.approx(k**2 * 0.05**4 / 2, rel=1e-11)


def committed(name):
    """The page of an example, and its log."""
    folder = ROOT / "examples" / name
    return (folder / "README.md").read_text(), (folder / f"log.{name}").read_text()


@pytest.mark.parametrize("name", ["hexagon", "hopper"])
def test_logs_are_up_to_date(name):
    """They have all commands of the input scripts."""
    _, log = committed(name)
    for line in (ROOT / "examples" / name / f"in.{name}").read_text().splitlines():
        assert line.rstrip(" &") in log


def test_pages_name_the_warnings_of_their_logs():
    """Those of the styles; others are LAMMPS' own, of its commands."""
    for log in ROOT.glob("examples/*/log.*"):
        warned = "are beyond the model" in log.read_text()
        page = (log.parent / "README.md").read_text()
        assert not warned or "beyond the model" in " ".join(page.split()), log


def test_pages_have_the_numbers_of_their_logs():
    page, log = committed("hexagon")
    rows = [line.split() for line in log.splitlines() if re.match(r"\s+\d+\s+0\.0[15] ", line)]
    for _, a, *found in rows:
        assert f"| {a} | {' | '.join(found[:4])} |" in page
    page, log = committed("hopper")
    steps = {int(row[0]): row for row in numbers(log, r"\s+\d+0000 ") if len(row) == 6}
    shown = re.findall(r"^\| (\d+) \| (\d+) \| ([\d.]+) \|", page, re.MULTILINE)
    assert [
        (n, f"{steps[int(n)][4]:.0f}", f"{-steps[int(n)][5] / 0.021 + 0:.3f}") for n, *_ in shown
    ] == shown


def test_pillar(tree):
    """Comes off faces and corners with the energy that it had; the lines are those on record."""
    folder = tree / "examples" / "pillar"
    log = run(folder, "lmp", "-in", "in.pillar")
    hits, expected = (
        numbers(text, r"\w+ hit at") for text in (log, (folder / "log.pillar").read_text())
    )
    assert hits.shape == (48, 4)
    assert np.abs(hits[:, 3]).max() < 1e-5
    assert hits[:, :3] == pytest.approx(expected[:, :3], abs=1e-3)
    assert (hits[:, 1] < 0).sum() > 20  # turned back


def test_outlines(tree):
    """A picture, and lines that close each of 50 outlines."""
    folder = tree / "examples" / "outlines"
    run(folder, "lmp", "-in", "in.outlines")
    (picture,), (dump,) = (sorted(folder.glob(f"outlines.*.{kind}")) for kind in ("ppm", "dump"))
    assert picture.stat().st_size > 3 * 700**2
    rows = np.loadtxt(dump, skiprows=9)[:, 1:]
    turns = np.bincount(rows[:, 0].astype(int), rows[:, 7])[1:]
    np.testing.assert_allclose(turns, 2 * np.pi, rtol=1e-4)
    assert len(turns) == 50


def test_dish(tree):
    """Cells double while there is room, then the dish is full."""
    folder = tree / "examples" / "dish"
    log = run(folder, "lmp", "-in", "in.dish")
    (_, atoms, slow, fast, *_), (_, expected, *_) = (
        numbers(text, r" +\d000 ").T for text in (log, (folder / "log.dish").read_text())
    )
    np.testing.assert_allclose(atoms, expected, rtol=0.1)
    assert atoms[-1] - atoms[-3] <= 3
    assert (atoms == slow + fast + 2).all()
    assert (folder / "dish.8000.ppm").exists()


def test_hopper(tree):
    """Energy is kept without drag; with drag all particles fall through and lie on the floor."""
    folder = tree / "examples" / "hopper"
    log = run(folder, "lmp", "-in", "in.hopper")
    first = log[: log.index("Loop time")]
    total, kinetic = table(first, ["Step", "PotEng"])[[3, 2]]
    assert len(total) == 11
    assert np.abs(total - total[0]).max() < 1e-4 * kinetic.max()
    ((out, atoms, weight),) = numbers(log, r"\d+ of \d+ particles")
    assert out == atoms == 42
    assert weight == pytest.approx(1, abs=1e-3)


def test_emulsion_si(tree):
    """Pressures are those of droplets of this size; its page has the numbers of the log."""
    folder = tree / "examples" / "emulsion_si"
    committed = (folder / "log.emulsion_si").read_text()
    log = run(folder, "lmp", "-in", "in.emulsion_si")
    steps, expected = (numbers(text, "phi 0") for text in (log, committed))
    phi, osmotic, emulsions, load, inside = steps.T
    assert phi == pytest.approx([0.7, 0.75, 0.8, 0.85])
    small, large = 10e-6, 11e-6
    scale = 5e-3 * (small**2 + large**2) / (small**3 + large**3)
    assert osmotic[-1] == pytest.approx(0.2765 * scale, rel=0.05)  # examples/emulsion_3d
    assert osmotic == pytest.approx(expected[:, 1], rel=0.5)  # another random packing
    assert emulsions == pytest.approx(3.2 * (phi - 0.64) ** 2 / np.sqrt(1 - phi) * scale, abs=0.1)
    assert load.max() < 0.4
    assert (np.diff([5e-3 * (1 / small + 1 / large), *inside]) > 0).all()
    _, _, _, kinetic, total = table(log, ["Step", "Time"])
    assert np.ptp(total) < 0.01 * kinetic.min()

    page = (folder / "README.md").read_text()
    rows = [
        [float(n) for n in re.findall(NUMBER, row)] for row in re.findall(r"^\| 0\..*", page, re.M)
    ]
    np.testing.assert_array_equal(rows, expected[:, [0, 3, 4, 1, 2]])
    _, _, _, kinetic, total = table(committed, ["Step", "Time"])
    assert np.ptp(total) / kinetic.min() == pytest.approx(1.1e-3, rel=0.1)


def test_mpi_input(tree):
    log = run(tree / "examples" / "mpi", "mpiexec", "-n", "2", "lmp", "-in", "in.mpi")
    reference = (ROOT / "examples" / "mpi" / "log.mpi").read_text()

    steps, expected = (numbers(text, "strain 0") for text in (log, reference))
    assert steps.shape == (8, 5)
    strain, phi, z, pressure, energy = range(5)
    assert steps[:, strain] == pytest.approx(0.001 * np.arange(1, 9))
    assert steps[:, phi] == pytest.approx(expected[:, phi], rel=1e-6)
    assert steps[:, z] == pytest.approx(expected[:, z], abs=0.1)
    # quartic energies: pressure and energy of a minimum are less accurate than forces are small
    assert steps[:, pressure] == pytest.approx(expected[:, pressure], rel=1e-3)
    assert steps[:, energy] == pytest.approx(expected[:, energy], rel=1e-3)

    total = table(log, ["Step", "v_phi"])[-1]
    assert len(total) == 21
    assert np.abs(total / total[0] - 1.0).max() < 2e-6


def test_large(tree):
    """Copies of a cell from random positions; nothing depends on the number of ranks."""
    folder = tree / "examples" / "large"
    log = run(folder, "lmp", "-in", "in.cell", "-var", "particles", "250")
    disks = numbers(log, "disks: phi = 0")
    assert disks[-2, 1] < 1e-4 < disks[-1, 1]
    assert disks[:, 0] == pytest.approx(0.8 * 0.9975 ** (-2.0 * np.arange(len(disks))), abs=1e-4)
    values = {"nx": 2, "ny": 2, "calls": 50, "motion": 20}
    command = (
        "lmp",
        "-in",
        "in.large",
        *(w for k, v in values.items() for w in ("-var", k, str(v))),
    )
    logs = [run(folder, *command), run(folder, "mpiexec", "-n", "2", *command)]

    short = (*command, "-var", "contact", "balanced", "-var", "steps", "1", "-var", "motion", "1")
    balanced = run(folder, *short)
    ((less,), (more,)) = (numbers(log, "Total dynamically") for log in (logs[0], balanced))
    # a dozen numbers for each of about five contacts on a particle, less the rows of `radical`
    assert more > less + 0.3e-3 * 1000  # Mbyte

    serial, shared = (numbers(log, "strain 0") for log in logs)
    strain, pressure, energy, largest, beyond = range(5)
    assert serial[:, strain] == pytest.approx(0.002 * np.arange(1, 6))
    # 250 iterations are too few for rounding errors of 1e-16 to grow so far
    assert shared[:, : largest + 1] == pytest.approx(serial[:, : largest + 1], rel=1e-9)
    assert (np.diff(serial[:, [pressure, energy]], axis=0) > 0.0).all()
    assert (serial[:, beyond] == 0).all()
    for log, found in zip(logs, (serial, shared), strict=True):
        net = numbers(log, "net force")
        assert (np.abs(net).max(axis=1) < 1e-12 * found[:, largest]).all()
        ((before, after, kinetic),) = numbers(log, "energy at")
        # benchmarks/nve.py and balanced.py: 1e-5 at this time step
        assert 0.0 < abs(after - before) < 1e-4 * kinetic


def snippets(page, language):
    text = (ROOT / page).read_text()
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def test_python_snippets_of_the_readme(tmp_path):
    (tmp_path / "script.py").write_text("\n".join(snippets("README.md", "python")))
    output = run(tmp_path, "python", "script.py")
    assert (tmp_path / "packing.png").stat().st_size > 10_000
    assert f"`{output.strip()}`" in (ROOT / "README.md").read_text()


GUIDE = """
import os, pathlib, runpy
for script in sorted(pathlib.Path.cwd().glob("*/script.py")):
    os.chdir(script.parent)
    runpy.run_path(str(script), run_name="__main__")
"""


def test_python_snippets_of_the_guide(tmp_path):
    """All snippets of a page, one after the other; pages by one process, which imports once."""
    for page in ROOT.glob("docs/guide/*.md"):
        script = tmp_path / page.stem / "script.py"
        script.parent.mkdir()
        script.write_text("\n".join(snippets(page, "python")))
    output("python", "-c", GUIDE, cwd=tmp_path, timeout=900, **ENVIRONMENT)


def test_the_first_script_runs_twice(tmp_path):
    (script,) = snippets("docs/start.md", "python")
    (tmp_path / "script.py").write_text(script)
    first, second = (run(tmp_path, "python", "script.py") for _ in range(2))
    assert first == second
    assert "Warning" not in first


def test_lammps_snippet(tmp_path):
    """In an empty folder, as after `pip install`."""
    (script,) = snippets("docs/start.md", "lammps")
    (tmp_path / "in.soft").write_text(script)
    log = run(tmp_path, "mpiexec", "-n", "2", "lmp", "-in", "in.soft")
    _, potential, kinetic, total, _ = table(log, ["Step", "PotEng", "KinEng"])
    assert len(total) == 11
    assert np.abs(total / total[0] - 1.0).max() < 1e-4
    assert kinetic.min() > 0.0
    assert potential.min() > 0.0
    assert (tmp_path / "shapes.dump").read_text().count("ITEM: TIMESTEP") == 11
    assert "Stopping criterion = force tolerance" in log
    assert "WARNING" not in log


def test_contacts_snippet(tmp_path):
    """The lines of the page, in the script of the README."""
    (script,), (lines,) = (
        snippets(page, "lammps") for page in ("docs/start.md", "docs/compute_deformable_contact.md")
    )
    script = re.sub(r"thermo_style.*\n", lambda _: lines, script)
    (tmp_path / "in.soft").write_text(script)
    _, _, largest, length = table(
        run(tmp_path, "lmp", "-in", "in.soft"), ["Step", "PotEng", "c_largest"]
    )
    assert len(length) == 11
    assert 0.0 < length.min() < length.max() < 1.0
    assert 0.0 < largest.min() < largest.max() < 0.1


def test_droplets_snippet(tmp_path):
    """The script of the page comes to rest, and moves at constant energy."""
    (script,) = snippets("docs/pair_deformable_droplet.md", "lammps")
    (tmp_path / "in.droplets").write_text(script)
    moved = run(tmp_path, "mpiexec", "-n", "2", "lmp", "-in", "in.droplets")
    _, _, kinetic, total, _ = table(moved, ["Step", "PotEng", "KinEng"])
    # the error of velocity Verlet is 1 % of it at this time step
    assert np.abs(total - total[0]).max() < 0.05 * kinetic[0]
    assert moved.count("Stopping criterion = force tolerance") == 1
    assert "WARNING" not in moved


def commands(page):
    """Arguments of each line `deformable ...` of a page."""
    lines = re.findall(r"^    deformable (.+)$", page.read_text(), re.MULTILINE)
    return [shlex.split(line, comments=True) for line in lines]


PAGES = [p for pattern in ("*.md", "docs/**/*.md", "examples/*/*.md") for p in ROOT.glob(pattern)]


def test_shell_commands_are_understood():
    """The command line accepts every option and value that pages show."""
    group = typer.main.get_command(app)
    found = [words for page in PAGES for words in commands(page)]
    assert len(found) > 5
    for name, *arguments in found:
        group.commands[name].make_context(name, arguments)


def test_links():
    """The targets of links inside the repository exist."""
    for page in PAGES:
        for target in re.findall(r"\]\((?!http)([^)]+)\)", page.read_text()):
            name, _, section = target.partition("#")
            file = (page.parent / name) if name else page
            assert file.exists(), (page, target)
            if section:
                heads = re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)
                slugs = [re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads]
                assert section in slugs, (page, target)


def test_thermal_input(tree):
    """In the heat bath at phi = 0.9, from random positions: particles stay in their cages."""
    log = run(tree / "examples" / "thermal", "lmp", "-in", "in.thermal", "-var", "phi", "0.9")
    ((temperature, displacement),) = numbers(log, "mean temperature")
    # 63 pairs of degrees of freedom over 25 times 1/friction, at four sigma
    assert abs(temperature - 1.0) < 4.0 / np.sqrt(63 * 25)
    assert displacement < 0.1**2
    frames = (tree / "examples" / "thermal" / "thermal.lammpstrj").read_text()
    assert frames.count("ITEM: TIMESTEP") == 201


DESIGN = """
import numpy as np
from moduli import NUMBER, Design
ratio, slopes = Design().slopes(np.zeros(NUMBER))
step = 1e-3 * np.sign(slopes)
high, low = (Design().ratio(sign * step) for sign in (1.0, -1.0))
print(abs(slopes).sum(), (high - low) / 2e-3)
"""


def test_design(tree):
    """The gradient of a ratio of moduli; a committed design that met its target."""
    folder = tree / "examples" / "design"
    exact, difference = map(float, run(folder, "python", "-c", DESIGN).split())
    assert exact == pytest.approx(difference, rel=1e-4)
    results = json.loads((folder / "moduli.json").read_text())
    assert results["gradient"]["off"] < 1e-9
    assert results["gradient"]["relaxations"] < 0.1 * results["differences"]["relaxations"]


def test_stable_packings():
    """The table is that of the committed packings; radii are spread as before."""
    folder = ROOT / "examples" / "design"
    rows = json.loads((folder / "stable.json").read_text())
    page = (folder / "README.md").read_text()
    keys = {"pressure": ".2g", "coordination": ".2f", "lowest": ".3f", "yield_strain": ".3f"}
    for name in ("compressed", "radii", "as soft"):
        of = [row for row in rows if row["packing"] == name]
        cells = [format(np.median([row[key] for row in of]), how) for key, how in keys.items()]
        assert f"| {' | '.join(cells)} |" in page
    by_seed = {(row["seed"], row["packing"]): row for row in rows}
    for seed in range(1, 11):
        before, after, soft = (by_seed[seed, name] for name in ("compressed", "radii", "as soft"))
        assert after["spread"] == pytest.approx(before["spread"], rel=1e-9)
        assert after["pressure"] == pytest.approx(soft["pressure"], rel=2e-6)
        assert after["yield_strain"] > 2 * max(before["yield_strain"], soft["yield_strain"])


@pytest.mark.parametrize("library", ["jax", "torch"])
def test_relaxation_with_a_gradient(tree, library):
    pytest.importorskip(library)
    lines = run(tree / "examples" / "design", "python", f"in_{library}.py").splitlines()
    assert lines[-1].startswith("step 5: pressure 0.002000")
