"""Bonds beside the pair styles: special_bonds must keep all contacts."""

import pytest
from combinations import Packing
from laws import EXACT
from scene import SPECIES
from test_refusals import refuses
from turns import in_turn

SPACE = "bond/types 1 extra/bond/per/atom 10 extra/special/per/atom 60"
BONDED = """
bond_style zero
bond_coeff *
create_bonds many all all 1 0.9 1.1
"""


def bonded(law, commands):
    packing = Packing(EXACT[law], atoms="bond", extra=SPACE)
    assert packing.lmp.extract_global("nbonds") == 0
    packing.run(BONDED + commands)
    assert packing.lmp.extract_global("nbonds") > 5
    return packing


@pytest.mark.parametrize(
    ("law", "factors"), [("radical", "lj/coul 1 1 1"), ("balanced", "lj 1 1 1 coul 0 0 0")]
)
def test_bonded_particles_keep_their_contacts(law, factors):
    expected, found = Packing(EXACT[law]), bonded(law, f"special_bonds {factors}")
    for packing in (expected, found):
        packing.run("run 0")
    assert found.results()["energy"] == expected.results()["energy"]


@pytest.mark.parametrize(
    ("factors", "law"),
    in_turn(["", "0.5 0.5 0.5", "1 0 1"], ["balanced", "radical"]),
)
def test_other_factors_are_refused(law, factors):
    """Of two bonded atoms, which the message names. Without bonds all factors are right."""
    command = f"special_bonds lj/coul {factors}" if factors else ""
    unbonded = Packing(EXACT[law], atoms="bond", extra=SPACE)
    unbonded.run(f"{command}\nrun 0")
    with refuses("special_bonds .*atoms [0-9]+ and [0-9]+.*special_bonds lj/coul 1 1 1"):
        bonded(law, f"{command}\nrun 0")


def test_bonds_of_another_style():
    """Bonds of atoms that are NULL for the style are not its concern."""
    name = EXACT["balanced"].split()[0]
    packing = Packing(EXACT["balanced"], atoms="bond", extra=SPACE)
    packing.run(f"""
pair_style hybrid {EXACT["balanced"]} lj/cut 1.0
pair_coeff * * {name} {SPECIES} small NULL
pair_coeff * 2 lj/cut 1e-9 1.0 1.6
bond_style zero
bond_coeff *
group small type 1
group large type 2
create_bonds many small large 1 0.9 1.3
create_bonds many large large 1 0.9 1.5
special_bonds lj/coul 0 1 1
run 0
""")
    assert packing.lmp.extract_global("nbonds") > 5
    with refuses("special_bonds"):
        packing.run("special_bonds lj/coul 0 0 0\ncreate_bonds many small small 1 0.9 1.1\nrun 0")


def test_factors_of_a_hybrid_style():
    """The factors that matter are those of this part of it."""
    name = EXACT["balanced"].split()[0]
    hybrid = f"""
special_bonds lj/coul 1e-20 1e-20 1e-20
pair_style hybrid/overlay {EXACT["balanced"]} lj/cut 1.0
pair_coeff * * {name} {SPECIES} small large
pair_coeff * * lj/cut 1.0 0.9
"""
    with refuses("special_bonds .*atoms [0-9]+ and [0-9]+"):
        bonded("balanced", hybrid + "pair_modify pair lj/cut special lj/coul 1 1 1\nrun 0")
    found = bonded("balanced", hybrid + f"pair_modify pair {name} special lj/coul 1 1 1\nrun 0")
    expected = Packing(EXACT["balanced"])
    expected.run("run 0")
    assert found.results()["energy"] == pytest.approx(expected.results()["energy"], rel=1e-9)
