"""Balanced contacts where only a few rings of many move: they are corrected on their own."""

import numpy as np
import pytest
from balanced import DEFAULT, of_compute_pair
from scene import HEADER, PACKINGS, SPECIES, Scene
from test_parallel import lmp

TOLERANCE = 1e-8
COPIES = 40  # of a packing of 24: 75 blocks of 512 rings
MOVERS = (2, 9, 20)  # of one copy
GRIDS = {"1": (1, "1 1 1"), "2, across x": (2, "2 1 1"), "2, across y": (2, "1 2 1")}
SCRIPT = (
    HEADER.format(boundary="p p p")
    + f"""
processors {{grid}}
read_data {{data}}
replicate {COPIES} {COPIES} 1
pair_style {DEFAULT} balance {TOLERANCE} 100
pair_coeff * * {SPECIES} small large
neighbor 0.3 bin
group movers id {{movers}}
velocity movers create 1e-3 4711 loop geom
fix move movers nve
timestep 0.05
compute contact all deformable/contact
compute largest all reduce max c_contact[5] inputs local
compute pair all pair deformable/ring
thermo_style custom step c_pair[3] c_largest
thermo_modify norm no format float %.17g
thermo 1
run 12
write_dump all custom moved.atoms id fx fy modify sort id format float %.17g
pair_style {DEFAULT} balance 1e-12 100
pair_coeff * * {SPECIES} small large
run 0
write_dump all custom exact.atoms id fx fy modify sort id format float %.17g
"""
)


@pytest.mark.parametrize("away", [0, 1, 4])
@pytest.mark.parametrize(("ranks", "grid"), GRIDS.values(), ids=GRIDS)
def test_few_rings_that_move(ranks, grid, away, tmp_path):
    """The forces are those of the same places from scratch; away from the border of two ranks."""
    scene = Scene.packing(PACKINGS[0], DEFAULT)
    scene.run(f"write_data {tmp_path}/data nofix")
    n = len(scene.x)
    copy = (COPIES // 2 + away) * (COPIES + 1)
    movers = [n * copy + rest for rest in MOVERS]
    script = SCRIPT.format(grid=grid, data=tmp_path / "data", movers=" ".join(map(str, movers)))
    result = lmp(ranks, script, tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    report = [line.split() for line in result.stdout.splitlines()]
    steps = np.array([row for row in report if len(row) == 3 and row[0].isdigit()], float)
    evaluations, largest = steps[:-1, 1], steps[-1, 2]
    assert evaluations[1:].max() <= 5  # forces have no history at first
    assert evaluations[4:].max() <= 4
    moved, exact = (
        np.loadtxt(tmp_path / f"{name}.atoms", skiprows=9)[:, 1:] for name in ("moved", "exact")
    )
    assert np.abs(moved - exact).max() <= 10 * TOLERANCE * largest


def test_two_rings_that_touch_alone():
    """All rings shrink until none touches; then two are large again. No force tells compliances."""
    case = PACKINGS[0]
    radii = np.array([0.5, 0.7])[np.array(case["type"]) - 1]
    style = f"{DEFAULT} radius atom"
    scene = Scene.packing(case, style, ("any", "any"), radii=radii)
    scene.run("unfix shape\nneighbor 0.5 bin\nreplicate 26 26 1\nrun 8 post no")
    atoms = scene.lmp.numpy
    radius, ids, x = (atoms.extract_atom(name) for name in ("radius", "id", "x"))
    large = np.array(radius).ravel()
    middle = scene.lmp.extract_setting("nlocal") // 2
    gap = np.hypot(*(x - x[middle])[:, :2].T) - large - large[middle]
    gap[ids == ids[middle]] = np.inf
    two = np.isin(ids, [ids[middle], ids[np.argmin(gap[: 2 * middle])]])
    for touching in (two & False, two):
        radius[:] = np.where(touching, large, 0.7 * large).reshape(np.shape(radius))
        scene.run("run 1 pre no post no")
    evaluations, imbalance = of_compute_pair(scene)
    assert evaluations <= 3
    assert imbalance <= 1e-8
