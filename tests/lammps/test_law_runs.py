"""All ring laws in motion: on several ranks, energy, relaxations, files."""

import numpy as np
import pytest
from balanced import of_compute_pair
from laws import EXACT, RADICAL, STYLES, kinds, laws, rings
from scene import HEADER, PACKINGS, SPECIES, Scene
from tense import droplets
from test_parallel import run as run_ranks
from test_restart import RUN, Continued
from test_soft_rings import pushed

LOOSE = {law: f"{STYLES[law]} balance 1e-8 100" for law in ("balanced", "tilted")}
# pair style, species, copies of the packing; differences of the first step, and of all
RANKS = {
    "balanced": (LOOSE["balanced"], "fixed skinned", 1, 1e-12, 3e-7),
    "balanced, 16 copies": (LOOSE["balanced"], "fixed skinned", 4, 1e-12, 3e-7),
    "balanced, exact": (EXACT["balanced"], "fixed skinned", 4, 1e-12, 1e-11),
    "tilted": (LOOSE["tilted"], "fixed skinned", 1, 1e-12, 1e-12),
    "tilted, 16 copies": (LOOSE["tilted"], "fixed skinned", 4, 1e-12, 1e-12),
    "balanced, droplets": (STYLES["balanced"], "drop large", 1, 1e-11, 3e-7),
    "tilted, droplets": (STYLES["tilted"], "drop large", 1, 1e-11, 1e-11),
}

FORCES, PRESSURE, CONTACT_LENGTH = slice(3, 5), 12, 14  # columns of what `run_ranks` gives


@pytest.mark.parametrize("case", RANKS.values(), ids=RANKS)
def test_ranks(case, tmp_path):
    """Forces and tilts are the same on both ranks that share a pair, also when those change.

    If they were not, forces would not add up to zero. With `balanced` a rank relaxes pairs that are
    inside of it, so answers differ by the tolerance, 1e-8: forces by a few times that, as the
    smallest eigenvalue of the compliances is below that of a pair, and stresses are sums of six.
    Otherwise all ranks take the same steps, and answers differ by rounding, which a few violent
    steps multiply. The force on a particle is a sum of larger contact forces, p L, which round.
    Droplets are beside rings that conserve their perimeter.
    """
    style, species, copies, first, later = case
    fields = {
        "style": style,
        "name": "deformable/ring",
        "species": f"{SPECIES} {species}",
        "data": tmp_path / "data",
        "boundary": "p p p",
        "commands": f"""
replicate {copies} {copies} 1
velocity all create 1e-3 4711 loop geom
neighbor 0.05 bin
""",
    }
    Scene.packing(PACKINGS[0], RADICAL).run(f"write_data {fields['data']} nofix")
    grids = [(1, "1 1 1"), (2, "2 1 1"), (4, "2 2 1")]
    reference, *others = (
        run_ranks(ranks, grid, tmp_path / grid.replace(" ", ""), **fields) for ranks, grid in grids
    )
    assert reference[0][0][0] > 1e-6
    for found in others:
        for steps, (scalars, atoms) in reference.items():
            tolerance = first if steps == 0 else later
            np.testing.assert_allclose(found[steps][0], scalars, rtol=tolerance)
            scale = np.abs(atoms).max(axis=0)
            scale[FORCES] = (atoms[:, PRESSURE] * atoms[:, CONTACT_LENGTH]).max()
            assert (np.abs(found[steps][1] - atoms) <= tolerance * scale).all()
            rest = found[steps][1][:, FORCES].sum(axis=0)
            assert (np.abs(rest) <= 1e-14 * len(atoms) * scale[FORCES]).all()


@pytest.mark.parametrize(("law", "cold", "warm"), [("balanced", 5, 2), ("tilted", 8, 3)])
@pytest.mark.parametrize("lists", ["every 10 check yes", "every 1 delay 0 check no"])
def test_forces_continue(law, cold, warm, lists):
    """Few evaluations along a trajectory, also with a new neighbor list in every step."""
    scene = rings(PACKINGS[0], STYLES[law], commands=f"neigh_modify {lists}")
    scene.run("velocity all create 1e-8 4711 loop all\nfix nve all nve\ntimestep 0.001\nrun 4")
    new = rings(PACKINGS[0], STYLES[law])
    new.energy()
    assert of_compute_pair(new)[0] >= cold
    evaluations = []
    for _ in range(10):
        scene.run("run 1 pre no post no")
        evaluations.append(of_compute_pair(scene)[0])
    assert max(evaluations) <= warm


@pytest.mark.parametrize(("kind", "dt"), [(rings, 0.2), (droplets, 0.1)])
def test_corrections_are_as_accurate_as_planned(kind, dt):
    """Chebyshev's iterations, in a motion whose steps ask for two corrections.

    The second one is to leave 0.1 of the tolerance, and so each call has three evaluations. Some
    have one more, where contacts open or close. Coefficients that are 15 % off, or wrong bounds of
    the spectrum, need more, or leave more.
    """
    tolerance, steps = 1e-8, 60
    style = f"{STYLES['balanced']} balance {tolerance} 100"
    scene = kind(PACKINGS[0], style, commands="replicate 4 4 1")
    scene.run(f"velocity all create 1e-6 4711 loop geom\nfix nve all nve\ntimestep {dt}\nrun 5")
    evaluations, imbalance = np.empty((2, steps))
    for n in range(steps):
        scene.run("run 1 pre no post no")
        evaluations[n], imbalance[n] = of_compute_pair(scene)
    assert np.median(evaluations) == 3
    assert np.mean(evaluations > 3) < 0.2
    assert np.median(imbalance) <= 0.2 * tolerance


def energy_error(kind, style, dt, time=40.0):
    """Standard deviation of the total energy along a trajectory, and the mean kinetic energy."""
    scene = kind(PACKINGS[0], style)
    scene.run(f"timestep {dt}\nvelocity all create 1e-5 4711 loop all\nfix nve all nve\nrun 0")
    scene.run("thermo_style custom step pe ke etotal\nthermo_modify norm no")
    rows = []
    for _ in range(40):
        scene.run(f"run {round(time / dt / 40)} post no")
        rows.append([scene.lmp.get_thermo(key) for key in ("etotal", "ke")])
    total, kinetic = np.array(rows).T
    return total.std(), kinetic.mean()


@kinds
@laws
def test_energy_is_conserved(kind, style):
    """To second order in the time step."""
    (coarse, _), (fine, kinetic) = (energy_error(kind, style, dt) for dt in (0.4, 0.1))
    assert 8 < coarse / fine < 32
    assert fine < (1e-4 if kind is rings and style != RADICAL else 1e-3) * kinetic


@kinds
@laws
def test_descent(kind, style):
    """FIRE to 1e-6 of the mean contact force."""
    scene = kind(PACKINGS[0], style)
    shape = scene.evaluate(pushed(PACKINGS[0])).shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    scene.run(f"min_style fire\nmin_modify dmax 0.002\ntimestep {0.5 if kind is rings else 0.3}")
    scene.run(f"minimize 0 {1e-7 * force} 20000 20000")
    evaluations, imbalance = of_compute_pair(scene)
    # contacts have come to balance as the particles have come to rest
    assert evaluations <= 3
    assert imbalance <= 1e-7
    energy = scene.lmp.get_thermo("pe")
    state = scene.evaluate()
    assert energy == pytest.approx(state.energy, rel=1e-11)
    shape = state.shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    assert np.hypot(*state.force.T).max() <= 1e-6 * force
    assert state.energy > 1e-6


# scene, its species, and the error of positions: droplets are balanced to 1e-8 of the largest force
FILES = {f"{law}, droplets": (droplets, STYLES[law], "drop droplarge", 1e-9) for law in STYLES}
FILES |= {"tilted, exact": (Scene.packing, EXACT["tilted"], "small large", 1e-11)}


@pytest.mark.parametrize("file", ["restart", "data"])
@pytest.mark.parametrize(("kind", "style", "species", "atol"), FILES.values(), ids=FILES)
def test_files(kind, style, species, atol, file, tmp_path):
    path = tmp_path / "file"
    scene = kind(PACKINGS[0], style, commands=RUN)
    scene.run(f"velocity all create 1e-4 4711 loop all\nrun 20\nwrite_{file} {path}\nrun 20")
    header = "" if file == "restart" else HEADER.format(boundary="p p p")
    continued = Continued(f"{header}read_{file} {path}", style, species)
    continued.run("run 20")
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=atol)
    assert continued.evaluate().energy == pytest.approx(scene.evaluate().energy, rel=1e-9)
