"""Arguments of all commands that are refused, each by one line that names the bad word."""

import pytest
from droplets import CASES, Droplets
from laws import LAWS, laws
from polygons import Polygons
from scene import PACKINGS, Scene
from smooth_polygons import two_polygons
from test_refusals import refuses, two_particles
from test_stick import PLANE, Beads

BAD = {
    "pair_style deformable/ring": {
        "contact radical reach 0": "reach 0 must be positive",
        "reach nan": "reach nan|'nan'",
        "reach": "deformable/ring reach command: missing argument",
        "range 0.1": "keyword 'range'.*'reach'",
        "contact flat": "contact 'flat'",
        "contact": "contact command: missing argument",
        "contact balanced balance 0 100": "tolerance 0 ",
        "contact balanced balance 1e-8 1": "balance: 1 ",
        "contact radical balance 1e-8 100": "balance is for 'contact balanced'",
        "balance 1e-8 100 contact radical": "balance is for 'contact balanced'",
        "tolerance 1": "Unknown .*'tolerance'",
        "radius": "deformable/ring radius command: missing argument",
        "radius 0.5": "radius '0.5'",
    },
    "pair_style deformable/sector": {
        "reach 0.1": "Unknown .*/sector keyword 'reach'",
        "radius all": "radius 'all'",
    },
    "fix w all deformable/wall": {
        "": "fix deformable/wall command: missing argument",
        "nowhere": "Region 'nowhere'",
        "box 3": "Unknown .*'3'",
        "box adhesion": "deformable/wall adhesion command: missing argument",
        "box adhesion -0.1": "Fix w .*adhesion must be 0 or positive and finite, not -0.1",
        "box adhesion nan": "not nan|'nan'",
        "box adhesion 0.1 disk 0 0 1": "unknown word 'disk' after adhesion: .*come last",
        "plane 0 0 1 0 adhesion 0.1 adhesion 0.2": "adhesion is there twice",
    },
    "fix stick all deformable/stick": {
        "": "fix deformable/stick command: missing argument",
        "nowhere 1.0": "Region 'nowhere'",
        "wall 0": "k is '0'",
        "wall nan": "k is 'nan'|'nan'",
        "wall 1.0 range 0.1": "keyword 'range'",
        "wall 1.0 radius": "fix deformable/stick radius command: missing argument",
        "wall 1.0 radius 0": "radius is '0'",
        "wall 1.0 radius 0.1 0.2": "argument '0.2'",
    },
    "fix area all deformable/polygon": {
        "": "fix deformable/polygon command: missing argument",
        "inf": "kA is 'inf'|'inf'",
        "1.0 area 2.0": "keyword 'area'",
        "1.0 rest": "fix deformable/polygon rest command: missing argument",
        "1.0 rest 0": "rest is '0'",
        "1.0 rest initial more": "keyword 'more'",
    },
    "pair_style deformable/edge": {
        "": "pair_style deformable/edge has 0 arguments",
        "0.4 0.1": "pair_style deformable/edge has 2 arguments",
        "0": "l is '0'",
        "nan": "l is 'nan'|'nan'",
    },
    "pair_coeff": {  # of deformable/edge
        "* * 3.0": "pair_coeff of deformable/edge has 3 arguments",
        "* * -3.0 0.15": "kr is '-3.0'",
        "* * inf 0.15": "kr is 'inf'|'inf'",
        "* * 3.0 0": "c is '0'",
        "2* *1 3.0 0.15": r"pair_coeff 2\* \*1 .* no pair of types",
        "1 3 3.0 0.15": "3",
    },
}
SCENES = {
    "stick": lambda: Beads([(0, 0)], PLANE).lmp,
    "polygon": lambda: Polygons(commands="").lmp,
    "edge": lambda: two_polygons(types=[1, 2]).lmp,
    "pair_coeff": lambda: two_polygons(types=[1, 2]).lmp,
}


@pytest.mark.parametrize("command", BAD)
def test_arguments(command):
    scene = SCENES.get(command.split("/")[-1], two_particles)()
    for arguments, message in BAD[command].items():
        with refuses(message):
            scene.command(f"{command} {arguments}")


@laws
def test_a_run_after_wrong_arguments(law):
    """The caller has caught the error: all is as it was."""
    some = Scene.packing(PACKINGS[0], LAWS[law])
    energy = some.energy()
    with refuses("Unknown .*'range'"):
        some.run(f"pair_style {LAWS[law]} radius atom range 0.1")
    assert some.energy() == pytest.approx(energy, rel=1e-9)


def test_edges_after_wrong_arguments():
    some = two_polygons()
    some.lmp.command("run 0")
    energy = some.lmp.get_thermo("pe")
    with refuses("l is '-0.001'"):
        some.lmp.command("pair_style deformable/edge -0.001")
    some.lmp.command("run 0")
    assert some.lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-12)


def test_droplets_after_wrong_arguments(tmp_path):
    some = Droplets(CASES[0], tmp_path)
    energy = some.energy
    with refuses("Unknown .*'range'"):
        some.run("pair_style deformable/droplet radius atom range 0.1")
    some.run("run 0")
    assert some.energy == pytest.approx(energy, rel=1e-9)
