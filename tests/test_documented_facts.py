"""What pages say of the package beside measurements: defaults, limits, versions, units."""

import json
import re
from math import pi, sqrt
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.relax import balance
from lammps_deformable.particles import laws

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    """The words of a page, without its line breaks."""
    return " ".join((ROOT / name).read_text().split())


def constant(file: str, name: str) -> float:
    text = (ROOT / "src" / file).read_text()
    return float(re.search(rf"\b{name} = ([\d.e+-]+)[;,]", text)[1])


def test_defaults() -> None:
    reach, radical = ld.Ring().reach, ld.Ring(contact="radical").reach
    ring = page("docs/pair_deformable_ring.md")
    assert f"reach = {reach} ({radical} with *contact radical*)" in ring
    balance = constant("styles/pair/pair_deformable.h", "tolerance")
    droplets = constant("styles/pair/pair_deformable_droplet.cpp", "TOLERANCE")
    assert f"balance = {balance:.0e} 1000".replace("e-0", "e-") in ring
    droplet = f"{droplets:.0e}".replace("e-0", "e-")
    assert f"balance = {droplet} 1000" in page("docs/pair_deformable_droplet.md")
    assert f"of droplets in space {droplet}" in page("docs/units.md")
    assert f"in space (3D) to {droplet}" in page("docs/guide/motion.md")
    assert f"is *contact {ld.Ring().contact}* with *reach* {reach}" in page("CHANGELOG.md")


def test_limits() -> None:
    limits, ring = page("docs/limits.md"), page("docs/pair_deformable_ring.md")
    touch = constant("laws/contact_curve.h", "LARGEST_AT_TOUCH")
    assert f"Above w = {2 * touch} tensions" in limits
    assert f"Above `w = {2 * touch} T`, at a wall above {touch} T" in ring
    load = constant("laws/droplet.h", "LARGEST_LOAD")
    assert f"warning above {load}, counted" in limits
    reach = constant("styles/pair/pair_deformable_ring.cpp", "LARGEST_REACH")
    assert f"`reach` up to {reach:.0f}" in limits
    assert f"{reach:.0f} is the largest" in ring


def test_requirements() -> None:
    """As the build has them."""
    (oldest,) = re.findall(r'requires-python = ">=(.+)"', (ROOT / "pyproject.toml").read_text())
    assert f"Python {oldest} or later" in page("README.md")
    assert f"Python >= {oldest}" in page("docs/start.md")
    assert f"{oldest} and later" in page("docs/install.md")
    assert "set(CMAKE_CXX_STANDARD 17)" in page("CMakeLists.txt")
    for name in ("README.md", "docs/start.md", "docs/install.md"):
        assert "C++17" in page(name)


def test_the_example_of_units() -> None:
    """R = 10 um, 5 mN/m, 1000 kg/m^3, 300 K."""
    R, tension, heat = 1e-5, 5e-3, 1.380649e-23 * 300
    m = 4 / 3 * pi * R**3 * 1000
    table = page("docs/units.md")
    for unit, value, said in (
        ("γ/R", tension / R, "500 Pa"),
        ("γ R", tension * R / 1e-9, "50 nN"),
        ("γ R²", tension * R**2, "5e-13 J"),
        ("4/3 π R³ ρ", m, "4.2e-12 kg"),
        ("sqrt(m/γ)", sqrt(m / tension) / 1e-6, "29 µs"),
        ("k T/(γ R²)", heat / (tension * R**2), "8e-9"),
    ):
        assert f"| {unit} | {said} |" in table
        assert value == pytest.approx(float(said.split()[0]), rel=0.04)
    assert f"a pressure of 0.1 is {0.1 * tension / R:.0f} Pa" in table


def test_each_style_has_a_page_and_is_in_the_lists() -> None:
    """But those that a pair style makes for itself."""
    sources = "".join(path.read_text() for path in (ROOT / "src").rglob("*.h"))
    styles = set(re.findall(r"Style\((deformable/\w+),", sources))
    styles -= {"deformable/films", "deformable/restart"}
    assert len(styles) > 8
    pages = {path.stem for path in (ROOT / "docs").glob("*_deformable_*.md")}
    index, install = page("docs/README.md"), page("docs/install.md").split("## What each style")[1]
    for style in styles:
        name = style.partition("/")[2]
        assert any(stem.endswith(f"_deformable_{name}") for stem in pages), style
        assert style in index, style
        assert name in install, style


def test_the_readme_has_lines_of_the_whole_input() -> None:
    text = (ROOT / "README.md").read_text().partition("## In LAMMPS")[2].partition("\n## ")[0]
    lines = [" ".join(line.split()) for line in text.splitlines() if line.startswith("    ")]
    whole = [
        " ".join(line.split()) for line in (ROOT / "docs" / "start.md").read_text().splitlines()
    ]
    assert len(lines) > 6
    assert [line for line in lines if line not in whole and line[0] != "#"] == []


def test_calls_that_lbfgs_saves() -> None:
    """In the plane, medians over packings with a step of 0.1 %."""
    rows = json.loads((ROOT / "benchmarks" / "results" / "at_rest.json").read_text())["summary"]
    saved = [
        row["calls"]
        for row in rows
        if row["minimizer"] == "lbfgs"
        and row["law"] in ("radical", "balanced", "curved")
        and row["step"] == 0.001
        and row["calls"]
    ]
    for name in ("docs/min_deformable_lbfgs.md", "docs/howto_deformable.md"):
        low, high = map(float, re.search(r"takes (\d+) to (\d+) times fewer", page(name)).groups())
        assert low <= min(saved) < 1.5 * low
        assert high / 1.5 < max(saved) <= high


def test_pictures_of_the_readme_load_quickly() -> None:
    pictures = re.findall(r"!\[.*?\]\((.+?)\)", (ROOT / "README.md").read_text())
    assert any(name.endswith(".gif") for name in pictures)
    assert max((ROOT / name).stat().st_size for name in pictures) < 1_500_000


def test_examples_name_species_of_their_file() -> None:
    """Those of the package's files."""
    files = {path.name: path.read_text() for path in (ROOT / "potentials").glob("*.deformable")}
    command = re.compile(r"pair_coeff\b.*? (\w+\.deformable)((?: +[\w-]+)+)")
    found = 0
    for path in [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]:
        for file, words in command.findall(path.read_text()):
            if file in files:
                known = re.findall(r"^(\w+)", files[file], re.MULTILINE)
                assert set(words.split()) <= {*known, "NULL"}, path
                found += 1
    assert found > 5


def test_the_default_time_step() -> None:
    """Of a state, and the longest one that Python accepts."""
    said = page("docs/units.md")
    plane, space = map(
        float,
        re.search(r"takes ([\d.]+) sqrt\(m/p\) in the plane and ([\d.]+) sqrt", said).groups(),
    )
    unstable = float(re.search(r"Ring without tension .*? \| ([\d.]+) sqrt\(m/p\) \| the", said)[1])
    assert "above five times these: in the plane a quarter of what is unstable" in said
    assert steps(laws.ACCURATE) == pytest.approx((plane, space), rel=0.02)
    longest = steps(1.0)
    assert longest == pytest.approx((5 * plane, 5 * space), rel=0.02)
    assert longest[0] == pytest.approx(unstable / 4, rel=0.2)


def steps(part: float) -> tuple[float, float]:
    """A part of the longest steps, in the plane at p = 1, in space at a tension of 1."""
    flat, round_ = ld.Packing([[1, 1]], 0.5, (4, 4)), ld.Packing([[1, 1, 1]], 0.5, (4, 4, 4))
    return (
        part * laws.longest_step(flat, ld.Ring(), 1.0, 0.0),
        part * laws.longest_step(round_, ld.Droplet(), 0.0, 0.0),
    )


def test_errors_of_forces() -> None:
    """By the default imbalance, beside one at rounding."""
    assert "Relative errors of forces are up to ten times *tol*" in page("docs/limits.md")
    jammed = ld.jam(ld.bidisperse(64, seed=1)).packing
    dense = jammed.at(jammed.phi + 0.1)
    forces = []
    for tolerance in (1e-8, 1e-13):
        with ld.Simulation(dense, ld.Ring(kA=np.inf, kP=0, tension=1)) as sim:
            balance(sim, dense, tolerance)
            forces.append(sim.state().contacts["force"])
    found, exact = forces
    assert 1e-8 < abs(found - exact).max() / exact.max() < 1e-7


def test_public_attributes_of_a_state_have_a_place() -> None:
    """In the guide, or among the attributes of its docstring."""
    guide = " ".join(path.read_text() for path in (ROOT / "docs" / "guide").glob("*.md"))
    said = set(re.findall(r"\w+", guide + ld.State.__doc__))
    former = {"to_surface_evolver"}  # of 0.1.0: now `export`
    assert {name for name in dir(ld.State) if name[0] != "_"} - said == former
