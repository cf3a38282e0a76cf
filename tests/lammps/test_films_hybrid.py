"""Films where several styles of a hybrid one stick."""

import pytest
from laws import EXACT
from parallel import finished
from test_films_memory import STRETCHED, TOUCH, W

ONE = "pair_style {law}\npair_coeff * * species drop drop"
EACH = """
pair_coeff * * deformable/ring 1 species drop NULL
pair_coeff * * deformable/ring 2 species NULL drop
pair_coeff 1 2 none
"""
STYLES = {
    "hybrid": f"pair_style hybrid {{law}} {{law}}{EACH}",
    "hybrid/overlay": f"pair_style hybrid/overlay {{law}} {{law}}{EACH}",
}
TWO_PAIRS = """units lj
dimension 2
region box block -6 6 -4 4 -0.5 0.5
create_box 2 box
create_atoms 1 single -4 0 0
create_atoms 1 single {left} 0 0
create_atoms 2 single 1 0 0
create_atoms 2 single {right} 0 0
mass * 1
{style}
group pulled id 2 4
thermo_modify norm no
run 0
displace_atoms pulled move {pull} 0 0
run 0
run 0
print "$(pe:%.17g)" file energy
"""


@pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
def test_two_styles(style, tmp_path):
    """Each of two curved styles knows its own films."""
    (tmp_path / "species").write_text(f"drop 1.0 inf 0 tension 1\nadhesion drop drop {W}\n")
    places = {"left": -4 + TOUCH, "right": 1 + TOUCH, "pull": STRETCHED - TOUCH}
    found = []
    for text in (ONE, style):
        finished(1, TWO_PAIRS.format(style=text.format(law=EXACT["curved"]), **places), tmp_path)
        found.append(float((tmp_path / "energy").read_text()))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0] > 0.01


SWAPPED = STYLES["hybrid"].replace("ring 1", "ring 3").replace("ring 2", "ring 1")
SWAPPED = SWAPPED.replace("ring 3", "ring 2")
AGAIN = """{style}
run 0
print "$(pe:%.17g)" file energy
"""


@pytest.mark.parametrize("then", [ONE, SWAPPED], ids=["one style", "another order"])
@pytest.mark.parametrize("style", [ONE, STYLES["hybrid"]], ids=["one", "hybrid"])
def test_styles_are_defined_otherwise(style, then, tmp_path):
    """Films belong to particles, not to a style or its number."""
    (tmp_path / "species").write_text(f"drop 1.0 inf 0 tension 1\nadhesion drop drop {W}\n")
    places = {"left": -4 + TOUCH, "right": 1 + TOUCH, "pull": STRETCHED - TOUCH}
    found = []
    law = EXACT["curved"]
    first = TWO_PAIRS.format(style=style.format(law=law), **places)
    for more in ("", AGAIN.format(style=then.format(law=law))):
        finished(1, first + more, tmp_path)
        found.append(float((tmp_path / "energy").read_text()))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0] > 0.01
