"""Where films of large contact angles exist: a closed form, which the solver finds, and a word."""

import re
from pathlib import Path

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from parallel import finished
from scipy.optimize import brentq
from test_films import doublet, droplets, pair_at

WORD = "presses against what it sticks to, but without a film"
WALL = "fix w all deformable/wall plane 0 0 0 1 adhesion {}\n"


def farthest(theta):
    """Of a film of a droplet alone, from its center, over R: there it has no length left.

    The free outline is an arc of radius q that leaves the wall and comes back in one point, where
    f = -2 T sin theta acts; see `contact_curve.h`.
    """
    s, c = np.sin(theta), np.cos(theta)
    area = np.pi - theta - s * c - s**2 / (2 * np.pi)  # over q^2
    return (c + s / (2 * np.pi)) * np.sqrt(np.pi / area)


LIMIT = 1 - np.cos(brentq(lambda theta: farthest(theta) - 1, 0.5, 1.2))


def at_wall(h, w, folder, **options):
    walls = WALL.format(w) + CONTACTS
    return droplets([[0, h]], folder, 0.0, commands=walls, boundary="p f p", box=(-5, 5, -1, 9),
                    **options)  # fmt: skip


def test_limit():
    """The pages and the source have its digits."""
    assert pytest.approx(LIMIT, abs=0.005) == 0.41
    root = Path(__file__).parents[2]
    assert "LARGEST_AT_TOUCH = 0.41;" in (root / "src" / "laws" / "contact_curve.h").read_text()
    page = (root / "docs" / "theory" / "contacts.md").read_text()
    w, d = (
        [float(word) for word in re.search(rf"\| {name}/[TR] \| (.*) \|", page)[1].split("|")]
        for name in "wd"
    )
    np.testing.assert_allclose(2 * farthest(np.arccos(1 - 0.5 * np.array(w))), d, atol=6e-4)
    assert np.degrees(np.arccos(1 - LIMIT)) == pytest.approx(53.8, abs=0.05)


@pytest.mark.parametrize("w", [0.1, 0.4, 0.42, 0.8])
def test_films_at_a_wall(w, tmp_path):
    """New droplets whose circle overlaps with the wall have a film where there is one."""
    end = farthest(np.arccos(1 - w))
    seen = contacts(at_wall(0.995 * min(end, 1.0), w, tmp_path))
    assert (seen["attached"] < 0).all()
    if end < 1:  # there it has next to no length
        assert 0 < seen["length"][0] < 0.1
        assert seen["force"][0] == pytest.approx(-2 * np.sqrt(w * (2 - w)), rel=0.05)
        seen = contacts(at_wall(1.005 * end, w, tmp_path))
        assert (seen["attached"] == 0).all()
        assert (seen["force"] > 0).all()


@pytest.mark.parametrize(("w", "attaches"), [(0.8, True), (0.84, False), (1.2, False)])
def test_two_droplets_come_together(w, attaches, tmp_path):
    """They attach at touch, or are free, with a word, until they are pressed to the film's end."""
    scene = doublet(2.001, tmp_path, w, log=tmp_path / "log", commands=CONTACTS)
    end = 2 * min(farthest(np.arccos(1 - 0.5 * w)), 1.0)
    scene.energy(pair_at(2 - 1e-4))
    free = (contacts(scene)["attached"] == 0).all()
    assert free != attaches
    if free:
        scene.energy(pair_at(end * 1.005))
        assert (contacts(scene)["attached"] == 0).all()
        scene.energy(pair_at(end * 0.995))
    assert (contacts(scene)["attached"] == 1).all()
    scene.lmp.close()
    assert (tmp_path / "log").read_text().count(WORD) == (not attaches)


def test_ranks_say_it_once(tmp_path):
    (tmp_path / "species").write_text("drop 1.0 inf 0 tension 1\nadhesion drop drop 1.0\n")
    script = """
log log.lammps
processors 2 1 1
dimension 2
atom_modify map yes
region box block -5 5 -5 5 -0.5 0.5
create_box 1 box
create_atoms 1 single -1.0 0 0
create_atoms 1 single 0.99 0 0
mass * 1
pair_style deformable/ring contact curved
pair_coeff * * species drop
fix still all move linear 0 0 0
run 5
run 5
"""
    finished(2, script, tmp_path)
    assert (tmp_path / "log.lammps").read_text().count(WORD) == 1


def test_replicate(tmp_path):
    """LAMMPS refuses it beside memory; before the style, circles that overlap are attached."""
    scene = doublet(1.98, tmp_path, 0.2)
    energy = scene.energy()
    with pytest.raises(Exception, match="Cannot replicate with fixes that store"):
        scene.run("replicate 2 1 1")
    scene.run(f"write_data {tmp_path}/data nocoeff nofix\nclear\ndimension 2\natom_modify map yes")
    scene.run(
        f"read_data {tmp_path}/data\nreplicate 2 3 1\npair_style deformable/ring contact curved"
    )
    scene.run(f"pair_coeff * * {tmp_path}/species drop0\nthermo_modify norm no\nrun 0")
    assert scene.lmp.get_thermo("pe") == pytest.approx(6 * energy, rel=1e-6)
    assert energy < -0.05
