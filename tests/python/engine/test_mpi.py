"""The same script on one process and on two ranks."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ranks import python

# what a script has seen is the same on all ranks
SEEN = """
import json
from mpi4py import MPI
import lammps_deformable as ld

{}
assert MPI.COMM_WORLD.allgather(seen) == [seen] * MPI.COMM_WORLD.size
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(seen))
"""
COMPRESSED = """
sim = ld.Simulation(start, ld.Ring())
state = sim.compress(strain=0.02, steps=2, tolerance={tolerance}, record="run")[-1]
assert state._root == (MPI.COMM_WORLD.rank == 0)
with ld.Run("run").simulation() as again:
    assert abs(again.state().energy / state.energy - 1) < 1e-12
table = state.contacts
seen = [state.phi, state.pressure, state.energy, state.coordination]
"""
CONTACTS = "seen += [*table['i'].tolist(), *table['j'].tolist()]"
JAMMED = "start = ld.jam(ld.{}).packing"
POLYGONS = """
jammed = ld.jam(ld.bidisperse(6, tilt=0.2, seed=3)).packing
with ld.Simulation(jammed, ld.DeformablePolygon({beads})) as rings:
    rings.deform({stretch} * rings.box)
    {relax}
    state = rings.state()
seen = [state.energy, *state.pressure_tensor.ravel(), *state.results["area"], *state.perimeters]
table = state.contacts
for values in state.packing.positions, *(table[n] for n in ("force_vector", "i", "j", "image")):
    seen += values.ravel().tolist()
"""
SMOOTH = "vertices=30, radius=0.025, kL=180.0, kr=10.0, smooth=True"
WALLS = """
scene = [ld.Sphere(6, (0, 0)), ld.Sphere(1, (2, 0), inside=False)]
scene.append(ld.Segment((-3, -2), (-3, 2)))
loose = ld.bidisperse(32, seed=3).between(scene, seed=1)
start = loose.at(0.84).push_off()
"""
WALLS_IN_SPACE = """
lids = [ld.Plane((0, 0, z), (0, 0, 1 - z)) for z in (0, 2)]
scene = [ld.Cylinder(2, "z", (0, 0, 0)), *lids, ld.Sphere(0.4, (1, 0, 1), inside=False)]
loose = ld.bidisperse(20, dimension=3, seed=3).between(scene, seed=1)
start = loose.at(0.6).push_off()
with ld.Simulation(start, ld.Droplet()) as sim:
    state = sim.compress(strain=0.02, tolerance=1e-8)[-1]
seen = [state.phi, state.pressure, state.energy, *state.wall_forces.ravel()]
"""
MOTION = """
packing = ld.bidisperse(32, phi=0.9, seed=3).push_off()
with ld.Simulation(packing, ld.Ring()) as sim:
    free = sim.run(50, timestep=0.2, temperature=1e-6, seed=1)[-1]
    bath = sim.run(50, timestep=0.2, temperature=1e-6, drag=0.1, every=25, seed=1)[-1]
alike = MPI.COMM_WORLD.allgather(bath.temperature)  # each rank has its own noise
assert alike == alike[:1] * len(alike)
seen = [free.energy, free.kinetic_energy]
rough = ld.Friction(0.4, kt=0.01, gt=0.001, restitution=0.5)
with ld.Simulation(packing, ld.Ring(), friction=rough) as sim:
    rubbed = sim.run(50, timestep=0.2, temperature=1e-4, seed=1)[-1]
with ld.Simulation(rubbed, ld.Ring()) as sim:  # springs reach their ranks
    further = sim.run(50, timestep=0.2)[-1]
assert further.contacts["sliding"].any()
seen += [further.lost_energy, further.spring_energy, *further.spins]
"""
# all particles in one corner of the box, so that one rank has none
CORNER = """
seen = []
x = [[2.0, 2.0], [3.9, 2.1], [2.9, 3.7]]
plane = ld.Packing(x, [1.0] * 3, (20, 20), seed=1)
space = ld.Packing([[*places, 2.0] for places in x], [1.0] * 3, (20, 20, 20), seed=1)
film = ld.Ring(contact="curved", kA=float("inf"), kP=0.0, tension=1.0, adhesion=0.1)
drop, gas = ld.Droplet(), ld.Ring(contact="curved", kA=3.0, kP=0.0, tension=1.0)
for start, law in (
    *((plane, law) for law in (ld.Ring(), film, ld.Sector(), ld.SoftContact())),
    (space, drop),
    (space, ld.SoftContact()),
):
    with ld.Simulation(start, law) as sim:
        seen.append(sim.state().energy)
        seen.append(sim.relax().energy)
    if isinstance(law, ld.Sector):
        continue
    with ld.Simulation(start, law) as sim:
        seen += [state.energy for state in sim.shear(0.02, steps=2)]
        seen += [state.energy for state in sim.compress(strain=0.02, steps=2)]
        if not isinstance(law, ld.SoftContact):
            seen += [state.energy for state in sim.grow(factor=1.02, steps=2)]
            seen += [state.energy for state in sim.oscillate(0.01, period=1, steps=8, drag=0.5)]
rough = ld.Friction(0.4, kt=0.01, gt=0.001)
for start, law in ((plane, ld.Ring()), (space, drop)):
    with ld.Simulation(start, law, friction=rough) as sim:
        rubbed = sim.run(50, timestep=0.02, propulsion=0.1, persistence=1.0, drag=0.5, seed=1)[-1]
    seen += [rubbed.energy, rubbed.lost_energy]
    with ld.Simulation(start, law) as sim:
        grown = sim.proliferate(0.5, division=4.0, time=1.0, steps=2, seed=1)[-1]
    seen += [len(grown.packing.radii), *grown.packing.radii]
with ld.Simulation(plane, gas) as sim:
    seen += sim.coarsen(0.1, time=0.1)[-1].packing.radii.tolist()
"""
TIGHT, ROUGH = COMPRESSED.format(tolerance=1e-9), COMPRESSED.format(tolerance=1e-6)
PART = 'rings.lmp.command("minimize 0 0 100 200")'
# and how well one and two ranks agree: rel, abs
SCENES = {
    # relaxations end within 1e-6 of the mean contact force, in slightly different states
    "particles": (
        JAMMED.format("polydisperse(32, lambda rng, n: rng.uniform(0.4, 0.6, n), seed=1)")
        + TIGHT
        + CONTACTS,
        1e-6,
        0,
    ),
    # pressures are right to the forces that remain, times the number of particles
    "walls": (WALLS + ROUGH + "seen += state.wall_forces.ravel().tolist()", 1e-4, 1e-7),
    "walls in space": (WALLS_IN_SPACE, 1e-4, 1e-6),
    # roundings, grown in 100 steps
    "beads": (POLYGONS.format(beads=20, stretch=0.97, relax=PART), 1e-9, 1e-12),
    "smooth polygons": (
        POLYGONS.format(beads=SMOOTH, stretch=0.98, relax="rings.relax()"),
        1e-9,
        1e-11,
    ),
    "motion": (MOTION, 1e-8, 0),  # as balanced forces
    "a rank without particles": (CORNER, 1e-6, 1e-8),
}


def here(script: str) -> dict[str, Any]:
    """What a script has found in this process, which is one rank."""
    found: dict[str, Any] = {}
    exec(script, found)
    return found


@pytest.mark.parametrize("name", SCENES)
def test_two_ranks_give_the_serial_answer(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script, rel, rounding = SCENES[name]
    for folder in ("1", "2"):
        (tmp_path / folder).mkdir()
    monkeypatch.chdir(tmp_path / "1")
    serial = here(SEEN.format(script))["seen"]
    shared = json.loads(python(SEEN.format(script), tmp_path / "2", ranks=2))
    if "record" in script:
        for folder in ("1", "2"):
            text = (tmp_path / folder / "run" / "trajectory.lammpstrj").read_text()
            assert text.count("ITEM: TIMESTEP") == 3
    assert shared == pytest.approx(serial, rel=rel, abs=rounding)


FARM = """
from mpi4py import MPI
import lammps_deformable as ld

rank = MPI.COMM_WORLD.rank
jammed = ld.jam(ld.bidisperse(16, seed=rank + 1)).packing
sim = ld.Simulation(jammed, ld.Ring(), comm=MPI.COMM_SELF)
run = sim.compress(strain=0.01, steps=rank + 1, record=f"run{rank}")
assert len(run) == rank + 2
"""


PROTOCOL = """
import lammps_deformable as ld

start = ld.jam(ld.bidisperse(32, seed=6)).packing.at(0.87)
sim = ld.Simulation(start, ld.Ring(contact="radical"))
sim.compress(strain=0.002, steps=2, tolerance=1e-9, record="run")
"""


def test_every_rank_may_run_its_own(tmp_path: Path) -> None:
    python(FARM, cwd=tmp_path, ranks=2)
    rows = [len((tmp_path / f"run{n}" / "series.csv").read_text().splitlines()) for n in (0, 1)]
    assert rows == [3, 4]


JAM = """
import lammps_deformable as ld, numpy as np
from mpi4py import MPI

comm = MPI.COMM_WORLD
loose = ld.bidisperse(16, seed=2)
for law, pressure in ((None, 1e-6), (ld.Ring(contact="radical"), 1e-8)):
    given = {"pressure": pressure, "tolerance": 1e-3, "comm": comm}
    jammed, *again = (ld.jam(loose, law, **given).packing for _ in range(2 if law else 1))
    everywhere = [*comm.allgather(jammed.positions), *(packing.positions for packing in again)]
    assert all(np.array_equal(jammed.positions, other) for other in everywhere)
    with ld.Simulation(jammed, law or ld.SoftContact(), comm=MPI.COMM_SELF) as sim:
        state = sim.state()
    if comm.rank == 0:
        print(state.phi, state.pressure / pressure)
"""


def test_ranks_jam_a_packing_together(tmp_path: Path) -> None:
    """And rings again to the last digit, at the onset and at its pressure."""
    told = list(map(float, python(JAM, tmp_path, ranks=2).split()))
    assert len(told) == 4
    for phi, pressure in (told[:2], told[2:]):
        assert 0.81 < phi < 0.87
        assert 1.0 < pressure <= 2.0


def frames(folder: Path) -> np.ndarray:
    """Values of the particles in a trajectory, shape (frames, N, columns)."""
    text = (folder / "run" / "trajectory.lammpstrj").read_text()
    atoms = [frame.partition("ITEM: ATOMS")[2] for frame in text.split("ITEM: TIMESTEP")[1:]]
    return np.array([np.loadtxt(lines.splitlines()[1:]) for lines in atoms])


def test_a_whole_protocol_does_not_depend_on_the_ranks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Well above jamming, where nothing rearranges: rounding errors do not grow there.

    Both runs stop at the same iteration unless the residual comes within 1e-14 of the tolerance.
    """
    folders = [tmp_path / "1", tmp_path / "2"]
    for folder in folders:
        folder.mkdir()
    monkeypatch.chdir(folders[0])
    here(PROTOCOL)
    python(PROTOCOL, cwd=folders[1], ranks=2)
    serial, shared = (
        np.genfromtxt(folder / "run" / "series.csv", delimiter=",", names=True, dtype=None)
        for folder in folders
    )
    assert len(serial) == 3
    for name in ("lx", "phi", "pressure", "shear_stress", "energy", "coordination", "rattlers"):
        assert shared[name] == pytest.approx(serial[name], rel=1e-9)
    places, shared_places = map(frames, folders)
    assert shared_places == pytest.approx(places, rel=1e-9, abs=1e-9)
    lx, ly = serial["lx"][1:, None], serial["ly"][1:, None]  # relaxed, after the start
    x, y = places[1:, :, 2] / lx, places[1:, :, 3] / ly
    apart = np.hypot(*(np.diff(u, axis=0) - np.rint(np.diff(u, axis=0)) for u in (x, y)))
    assert (apart * lx[1:]).max() < 0.02 * 0.5  # of the small radius, in a step
