"""Radii of atoms that the pair style does not take: one warning."""

import pytest
from combinations import Packing
from laws import EXACT, two_laws
from scene import PACKINGS

UNUSED = "another radius than its species"
GROW = """
variable grow equal 1+0.01*step
fix grow all adapt 1 atom diameter v_grow scale yes
neigh_modify every 1 delay 0 check no
run 3
run 3
"""


def logged(law, words, tmp_path, commands):
    log = tmp_path / "log"
    species = "any any" if words else "small large"
    packing = Packing(EXACT[law] + words, species=species, atoms="sphere 1", log=log)
    packing.run(commands)
    return packing.results()["energy"], log.read_text()


@two_laws
def test_growth_without_effect(law, tmp_path):
    """fix adapt and `radius type`; with `radius atom` particles grow."""
    start = logged(law, "", tmp_path, "run 0")
    assert UNUSED not in start[1]
    same, said = logged(law, "", tmp_path, GROW)
    assert same == pytest.approx(start[0], rel=1e-9)
    assert said.count(UNUSED) == 1
    grown, said = logged(law, " radius atom", tmp_path, GROW)
    assert grown > 2 * start[0]
    assert UNUSED not in said


def test_names_the_atom(tmp_path):
    assert PACKINGS[0]["type"][8] == 1
    said = logged("balanced", "", tmp_path, "set atom 9 diameter 1.01\nrun 0")[1]
    assert f"Atom 9 has {UNUSED}" in said
