"""Droplets in three dimensions under valgrind, as test_memory.py has it for the other styles."""

import pytest
from droplet_walls import CUBE, SCENES, SIDE
from droplets import CASES, sheared, species
from test_memory import findings, valgrind  # noqa: F401  a fixture

pytestmark = pytest.mark.slow

OUTPUT = """
compute contacts all deformable/contact
compute stress all stress/atom NULL virial
compute energy all pe/atom
compute sums all reduce sum c_contacts[4] c_contacts[5] inputs local
compute model all pair deformable/droplet
fix results all pair 1 deformable/droplet area 0 contacts 0 contact_area 0 pressure 0 load 0
dump contacts all local 1 contacts.dump c_contacts[*]
thermo_style custom step pe press c_sums[*] c_model[*]
thermo 2
"""
MOTION = """
min_style fire
minimize 0 1e-12 4 8
velocity all create {0} 4711 loop all
fix move all nve
timestep 0.05
run {1}
"""
RAMP = """
variable grows equal 1+0.01*step
fix ramp all adapt 1 pair deformable/droplet tension * * v_grows
"""


def begin(case, file, words="", tilt=(0, 0, 0), boundary="p p p", atoms="atomic"):
    """Commands for the droplets of a case, up to its pair style; and those of the pair style."""
    types, coeff = species(case, file)
    low = case.get("low", 0.0)
    box = " ".join(f"{low:.17g} {low + edge:.17g}" for edge in case["box"])
    places = "\n".join(
        f"create_atoms {kind} single {x:.17g} {y:.17g} {z:.17g}"
        for kind, (x, y, z) in zip(types, sheared(case, tilt).tolist(), strict=True)
    )
    radii = dict(zip(types, case["radius"], strict=True))
    masses = "mass * 1.0"
    if atoms == "sphere":
        sizes = [f"set type {kind} diameter {2 * radius}\n" for kind, radius in radii.items()]
        masses = "".join(sizes) + "set group all mass 1.0"
    pair = f"pair_style deformable/droplet {words}\n{coeff}\n"
    return (
        f"""
units lj
dimension 3
boundary {boundary}
atom_style {atoms}
atom_modify map yes
box tilt large
region box prism {box} {tilt[0]} {tilt[1]} {tilt[2]}
create_box {max(types)} box
{places}
{masses}
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
{pair}""",
        pair,
    )


def scenes(folder):
    """Small boxes, where droplets touch images; ramps, walls, restarts, lost and new droplets."""
    cube = {"x": CUBE, "box": [SIDE] * 3, "low": -0.5 * SIDE, "radius": [1.0] * 8}
    cube["tension"] = [1.0] * 8
    small, _ = begin(CASES[2], folder / "small")
    tilted, _ = begin(CASES[3], folder / "tilted", tilt=(0.3, -0.2, 0.1))
    spheres, pair = begin(CASES[3], folder / "spheres", "radius atom", atoms="sphere")
    walls, _ = begin(cube, folder / "walls", boundary="f f f")
    goes_on = f"""
write_restart droplets.restart
clear
read_restart droplets.restart
{pair}
fix move all nve
run 4
group lost id 3
delete_atoms group lost
run 4
create_atoms 1 random 1 7 NULL overlap 1.0
set type 1 diameter 2.0
run 4
{pair}
run 1
"""
    yield small + OUTPUT + MOTION.format(0.02, 20)
    yield tilted + OUTPUT + RAMP + MOTION.format(0.02, 20)
    yield spheres + OUTPUT + MOTION.format(1e-3, 4) + goes_on
    for name in ("block", "rims of a cone", "sphere", "tetrahedron"):
        yield walls + SCENES[name] + OUTPUT + MOTION.format(1e-4, 6)
    words = "fix walls all deformable/wall zlo -1.9 ball 0 0 0 0.7"
    yield walls + words + OUTPUT + MOTION.format(1e-4, 4)


@pytest.mark.parametrize("ranks", [1, 2])
def test_droplets(ranks, valgrind, tmp_path):  # noqa: F811
    these = [*scenes(tmp_path)]
    found, output = findings(valgrind, "clear\n".join(these), tmp_path, ranks)
    assert output.count("Loop time") >= 2 * len(these)
    assert found == []
