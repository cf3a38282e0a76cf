"""Which pair styles the compute and the fixes take for deformable ones: by type, not by name."""

import numpy as np
import pytest
from laws import BALANCED
from polygons import Polygons
from smooth_polygons import BOX, FIRST, HEADER, NO_SPRINGS, SECOND, TWO, two_polygons
from test_refusals import refuses
from turns import in_turn

ASKING = {
    "compute deformable/contact": "compute some all deformable/contact\n",
    "compute deformable/outline": "compute some all deformable/outline\n",
    "wall": "fix some all deformable/wall disk -1.5 0.3 0.3\n",
    "friction": "fix some all deformable/friction 0.5 1 0\n",
}
# styles without contacts of deformable particles
OTHERS = {
    "deformable/edge": TWO,
    "hybrid/overlay": "pair_style hybrid/overlay deformable/edge 0.4 zero 1.0\n"
    "pair_coeff * * deformable/edge 3.0 0.15\npair_coeff * * zero\n",
    "zero": "pair_style zero 1.0\npair_coeff * *\n",
}


@pytest.mark.parametrize(("what", "style"), in_turn(ASKING, OTHERS))
def test_other_styles(what, style):
    scene = two_polygons(pair=OTHERS[style], commands=ASKING[what])
    with refuses(f"(?:Fix|Compute) some .* needs .*deformable/ring.*pair_style is {style}"):
        scene.energy()


# two rings beside the polygons, in contact with each other and with the wall
RINGS = [(-1.5, -0.45), (-0.6, -0.5)]


def rings(folder, edges, number):
    """Rings among polygons, whose vertices have the style deformable/edge or none."""
    (folder / "species").write_text("ring 0.5 1 inf\n")
    styles = ["zero 0.5", *["deformable/edge 0.4"] * edges, *[BALANCED] * number]
    coeff = f"{folder / 'species'} NULL ring\n"
    some = f"pair_style hybrid/overlay {' '.join(styles)}\n"
    names = (
        ["deformable/ring"] if number == 1 else [f"deformable/ring {n + 1}" for n in range(number)]
    )
    some += "".join(f"pair_coeff * * {name} {coeff}" for name in names)
    some += "pair_coeff 1 1 deformable/edge 3.0 0.15\n" if edges else "pair_coeff 1 1 zero\n"
    some += "pair_coeff 1 2 zero\n"
    commands = (
        "group rings type 2\ncompute rows rings deformable/contact\n"
        "fix wall rings deformable/wall disk -1.5 0.3 0.3\n"
        "fix rub rings deformable/friction 0.5 1 0\nfix move rings nve\ntimestep 0.01\n"
        "velocity rings set 0.02 0.01 0\nset atom 29 vx 0.05\n"
    )
    scene = Polygons(
        (FIRST, SECOND), BOX, others=RINGS, other_type=2, header=HEADER, springs=some + NO_SPRINGS,
        commands="",
    )  # fmt: skip
    scene.run(commands + "run 5")
    count = scene.lmp.extract_compute("rows", 2, 3)
    rows = np.array(scene.lmp.numpy.extract_compute("rows", 2, 2))
    wall = [scene.lmp.extract_fix("wall", 0, 1, k) for k in range(2)]
    rubs = [scene.lmp.extract_fix("rub", 0, 1, k) for k in range(6)]
    return len(rows), rows[:2, :14], np.array(wall), np.array(rubs), count


@pytest.mark.parametrize("number", [1, 2])
def test_rings_among_polygons(number, tmp_path):
    """In a hybrid style the deformable ones count, and edges change nothing for them."""
    alone, among = (rings(tmp_path, edges, number) for edges in (False, True))
    for one, other in zip(alone, among, strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-15)
    assert np.abs(alone[2]).max() > 0  # the wall bears a force
    assert alone[3][4] == 2 * number  # contacts with friction
