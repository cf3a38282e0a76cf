"""Threads that share the balance of contacts: the same bits for any number, asleep when idle."""

import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from droplets import CASES, Droplets
from laws import BALANCED, CURVED
from parallel import finished
from programs import program
from scene import PACKINGS, SPECIES, Scene

NUMBERS = (1, 2, 5)  # more than there are cores, too
MOTION = """
velocity all create 1e-4 4711 loop all
fix move all nve
timestep 0.02
thermo_style custom step pe press pxx pyy pxy
thermo 5
run 12
unfix move
min_style deformable/lbfgs
minimize 0 1e-8 8 20
"""
CORES = len(os.sched_getaffinity(0))
two_cores = pytest.mark.skipif(CORES < 2, reason="needs two cores")


def tiled(case, times):
    """The case so many times along each axis of its periodic box."""
    box = np.broadcast_to(case.get("L", case.get("box")), len(times)).astype(float)
    shifts = np.stack(np.meshgrid(*map(np.arange, times), indexing="ij"), -1).reshape(-1, len(box))
    count = len(shifts)
    x = (shifts[:, None] * box + np.array(case["x"])).reshape(-1, len(box))
    values = {key: case[key] * count for key in ("type", "radius", "tension") if key in case}
    return values | {"x": x.tolist(), "box": (box * times).tolist()}


def rings(style, *, boundary="p p p", walls="", species=("small", "large"), coeff=None):
    """1176 rings, which are three blocks; with films fewer, and looser."""
    packing = tiled(PACKINGS[0], (7, 7)) if coeff is None else tiled(PACKINGS[1], (5, 5))
    lx, ly = packing["box"]
    kinds = [species[t - 1] for t in packing["type"]]
    options = {"boundary": boundary, "commands": walls.format(lx=lx, ly=ly), "coeff": coeff}
    return Scene(packing["x"], kinds, (0, lx, 0, ly), style, **options)


def sticky(folder):
    file = folder / "sticky"
    species = "a 0.5 1.0 0 tension 0.05\nb 0.7 1.0 0 tension 0.05\n"
    pairs = "".join(f"adhesion {pair} 0.005\n" for pair in ("a a", "a b", "b b"))
    file.write_text("# UNITS: lj\n" + species + pairs)
    return f"pair_coeff * * {file} a b"


def droplets(folder, adhesion=0.0):
    case = tiled(CASES[3], (5, 5, 3))
    return Droplets(case | {"adhesion": adhesion}, folder, style="deformable/droplet")


WALLS = "fix wall all deformable/wall xlo 0.05 xhi $({lx}-0.05)"
SCENES = {
    "balanced": lambda _: rings(BALANCED),
    "curved": lambda _: rings(CURVED),
    "between walls": lambda _: rings(BALANCED, boundary="f p p", walls=WALLS),
    "with perimeters": lambda _: rings(BALANCED, species=("both", "bothlarge")),
    "films": lambda folder: rings(f"{CURVED} reach 0.8", coeff=sticky(folder)),
    "droplets": droplets,
    "sticking droplets": lambda folder: droplets(folder, 0.05),
}


def found(scene):
    """All numbers that may differ."""
    scene.run(MOTION)
    scalars = [scene.lmp.get_thermo(name) for name in ("pe", "pxx", "pxy", "pyy")]
    atoms = [np.array(scene.lmp.gather(name, 1, 3)) for name in ("x", "f", "v")]
    return np.concatenate([scalars, *atoms])


@pytest.mark.parametrize("name", SCENES)
def test_bits(name, tmp_path, monkeypatch):
    first = None
    for number in NUMBERS:
        monkeypatch.setenv("DEFORMABLE_TUNING", f"threads={number}")
        these = found(SCENES[name](tmp_path))
        first = these if first is None else first
        assert np.isfinite(first).all()
        assert first.tobytes() == these.tobytes(), number


TWO_RANKS = f"""
units lj
dimension 2
atom_style atomic
atom_modify map yes
processors 2 1 1
lattice hex 1.1
region box block 0 40 0 20 -0.5 0.5
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.3 12
mass * 1.0
displace_atoms all random 0.05 0.05 0 11
pair_style {BALANCED} reach 0.8
pair_coeff * * {SPECIES} small large
fix move all nve
timestep 0.02
run 10
write_dump all custom atoms id x y fx fy modify sort id format float %.17g
"""


def test_beside_ranks(tmp_path, monkeypatch):
    texts = []
    for number in (1, 2):
        monkeypatch.setenv("DEFORMABLE_TUNING", f"threads={number}")
        finished(2, TWO_RANKS, tmp_path)
        texts.append((tmp_path / "atoms").read_text())
    assert texts[0] == texts[1]


def tasks():
    """Threads of this process."""
    return set(os.listdir("/proc/self/task"))


@two_cores
def test_they_sleep_between_calls_and_end_with_the_style():
    before = tasks()
    scene = rings(f"{BALANCED} threads 2")
    scene.run("run 2")
    assert len(tasks() - before) == 1
    time.sleep(0.05)
    begin = time.process_time()
    time.sleep(0.3)
    assert time.process_time() - begin < 0.1
    (other,) = tasks() - before
    status = Path(f"/proc/self/task/{other}/status").read_text()
    (blocked,) = (line.split()[1] for line in status.splitlines() if line.startswith("SigBlk"))
    assert int(blocked, 16) & 1 << 1  # SIGINT is for the main thread
    scene.lmp.close()
    assert tasks() == before


def test_no_more_than_cores(tmp_path):
    log = tmp_path / "log"
    before = tasks()
    packing = PACKINGS[0]
    scene = Scene.packing(packing, f"{BALANCED} threads 1000", log=log)
    scene.run("run 0")
    assert len(tasks() - before) == CORES - 1
    assert f"{CORES} thread(s) share the balance of contacts" in log.read_text()


@pytest.mark.parametrize("value", ["0", "-2", "two", "1.5"])
def test_a_wrong_number(value):
    with pytest.raises(Exception, match=f"threads {value} must be 'auto', or a number from 1 on"):
        Scene.packing(PACKINGS[0], f"{BALANCED} threads {value}")


def test_radical_has_no_balance():
    with pytest.raises(Exception, match="threads is for 'contact balanced' and 'curved' only"):
        Scene.packing(PACKINGS[0], "deformable/ring contact radical threads 2")


def test_a_simulation_in_each_of_several_threads(monkeypatch):
    monkeypatch.setenv("DEFORMABLE_TUNING", "threads=2")
    with ThreadPoolExecutor(3) as pool:
        energies = list(pool.map(lambda _: found(rings(BALANCED)), range(3)))
    for these in energies[1:]:
        np.testing.assert_array_equal(these, energies[0])


FORK = """
import os
from pathlib import Path
import test_balance_threads
os.environ["DEFORMABLE_TUNING"] = "threads=2"
scene = test_balance_threads.rings(test_balance_threads.BALANCED)
scene.run("run 1")
child = os.fork()
energy = test_balance_threads.found(scene).tobytes()
name = "parent" if child else "child"
Path(name).write_bytes(energy)
if not child:
    scene.lmp.close()
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
"""


def test_a_fork_goes_on_alone(tmp_path):
    (tmp_path / "fork.py").write_text(FORK)
    path = os.pathsep.join(map(str, (Path(__file__).parent, Path(__file__).parents[1])))
    done = program("python", "fork.py", cwd=tmp_path, PYTHONPATH=path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "parent").read_bytes() == (tmp_path / "child").read_bytes()


def test_lammps_own_number(tmp_path):
    """That of `package omp`, whose threads spin."""
    script = TWO_RANKS.replace("processors 2 1 1", "package omp 2")
    (tmp_path / "in.omp").write_text(script)
    for policy in ("active", "passive"):
        done = program("lmp", "-in", "in.omp", "-log", "none", cwd=tmp_path, OMP_WAIT_POLICY=policy)
        assert done.returncode == 0, done.stdout
        assert f"{min(2, CORES)} thread(s) share" in done.stdout
        spins = policy == "active" and CORES > 1
        assert ("set the environment variable OMP_WAIT_POLICY=passive" in done.stdout) == spins
