"""Particles that leave the plane: one warning, at the first z or vz that is not zero."""

import pytest
from combinations import Packing
from laws import EXACT
from parallel import finished, in_process
from scene import SPECIES

BATH = "fix move all nve\nfix bath all langevin 1e-5 1e-5 5 4711\n"
PLANE = "fix plane all enforce2d\n"
LEAVES = "leaves the plane"
READ = f"""
units lj
dimension 2
newton on
atom_modify map yes
read_data data
pair_style {EXACT["radical"]}
pair_coeff * * {SPECIES} small large
"""


def warnings(log):
    return [line for line in log.read_text().splitlines() if LEAVES in line]


def moved(tmp_path, law, commands):
    packing = Packing(EXACT[law], log=tmp_path / "log")
    packing.run(commands)
    return packing, warnings(tmp_path / "log")


def test_heat_bath(tmp_path):
    """One warning however many runs; the particles can't be read back."""
    packing, said = moved(tmp_path, "balanced", BATH + "run 5\nrun 200\nrun 5")
    assert len(said) == 1
    assert "Atom " in said[0]
    assert "enforce2d" in said[0]
    with pytest.raises(Exception, match="z coord"):
        packing.fresh(tmp_path)


def test_a_plane_that_is_not_the_last_fix(tmp_path):
    """The bath acts after it: the warning names it, and not only the command that is there."""
    _, said = moved(tmp_path, "radical", PLANE + BATH + "run 200")
    assert len(said) == 1
    assert "define fix plane enforce2d anew after all other fixes" in said[0]


def test_heat_bath_in_the_plane(tmp_path):
    packing, said = moved(tmp_path, "balanced", BATH + PLANE + "run 200")
    assert said == []
    packing.fresh(tmp_path)


@pytest.mark.parametrize("where", ["z 1e-9", "vz -1e-30"])
def test_names_the_atom(where, tmp_path):
    """At the start of a run, and of a minimization."""
    for go in ("run 0", "minimize 0 1e-9 2 2"):
        said = moved(tmp_path, "radical", f"set atom 7 {where}\n{go}")[1]
        assert len(said) == 1
        assert "Atom 7 " in said[0]


def test_set_back(tmp_path):
    """The command that the warning names makes the particles readable."""
    packing, said = moved(tmp_path, "balanced", BATH + PLANE + "set atom 7 z 1e-3\nrun 20")
    assert "'set group all z 0 vz 0'" in said[0]
    packing.run("set group all z 0 vz 0")
    packing.fresh(tmp_path)


@pytest.mark.parametrize(
    "noise",
    [
        "fix move all gjf 1e-5 1e-5 5 4711",
        "fix move all nve\nfix b all wall/flow x 0.02 1e-5 4711 2 1.5 3.5",
    ],
    ids=["gjf", "wall/flow"],
)
def test_noise(noise, tmp_path):
    """It moves particles out of the plane even with enforce2d, but not their forces."""
    packing, said = moved(tmp_path, "balanced", f"{noise}\n{PLANE}run 200")
    assert len(said) == 1
    packing.run("set group all z 0 vz 0\nrun 0")
    assert packing.fresh(tmp_path).results()["energy"] == pytest.approx(
        packing.results()["energy"], rel=1e-9
    )


def test_tilted_boxes(tmp_path):
    """Rounding of z is not motion."""
    Packing(EXACT["radical"]).run(f"write_data {tmp_path / 'data'} nofix")
    data = (tmp_path / "data").read_text()
    (tmp_path / "data").write_text(data.replace("-0.5 0.5 zlo", "-0.3 0.6 zlo"))
    shear = """
change_box all triclinic
fix deform all deform 1 xy erate 0.02 remap v
fix move all nvt/sllod temp 1e-5 1e-5 5
run 100
write_dump all custom z z modify format float %g
"""
    said = in_process(READ + shear, tmp_path)
    assert any(z != "0" for z in (tmp_path / "z").read_text().splitlines()[9:])
    assert LEAVES not in said


def test_on_any_rank(tmp_path):
    """Every rank finds its own particles; the first one warns."""
    Packing(EXACT["radical"]).run(f"write_data {tmp_path / 'data'} nofix")
    for atom in (1, 24):
        said = finished(2, READ + f"fix move all nve\nset atom {atom} vz 1e-3\nrun 20", tmp_path)
        assert said.count(LEAVES) == 1
        assert f"Atom {atom} " in said
