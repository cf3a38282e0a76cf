"""Droplets and soft spheres between walls in space: known forces, balances, protocols, files."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from exact_balance import exactly_balanced
from lammps_deformable import (
    BoxWall,
    Cone,
    Cylinder,
    Droplet,
    LammpsError,
    ParameterError,
    Plane,
    Sphere,
)
from lammps_deformable.state.contacts import forces_of
from lammps_deformable.state.recorded import particle_values
from polyhedra import FACES, FORCES, INDENTATIONS
from programs import output

LAW = Droplet([1.0, 1.5])
LIDS = (Plane((0, 0, 0), (0, 0, 1)), Plane((0, 0, 8), (0, 0, -1)))
SCENES = {
    "cuboid": BoxWall((8, 7, 6), (1, -2, 3)).parts,
    "plates": LIDS,
    "drum": (Cylinder(4, "z", (4, 3, 2)), *LIDS),
    "hopper": (
        Cone((4, 3, -2.142857142857143), "z", np.arctan(0.7)),
        Cylinder(4, "z", (4, 3, 2)),
        *LIDS,
    ),
    "posts": (
        BoxWall((8, 7, 6), (1, -2, 3)),
        Cylinder(1.0, "z", (3, 1, 5), inside=False),
        Cylinder(0.8, "x", (3, 4, 7), inside=False),
    ),
    "sphere and balls": (
        Sphere(6, (1, 2, 3)),
        Sphere(1.5, (1, 2, 3), inside=False),
        Sphere(1, (-2, 2, 1), inside=False),
    ),
}


def packed(name: str, phi: float = 0.64, number: int = 40) -> ld.Packing:
    start = ld.bidisperse(number, sizes=(0.5, 0.6), dimension=3, seed=3).between(SCENES[name])
    return start.at(phi).push_off()


@pytest.fixture(scope="module")
def drum() -> ld.Packing:
    return packed("drum")


def test_one_droplet_in_its_faces() -> None:
    """The table of equal contacts."""
    for name in FORCES:
        *forces, energy = FORCES[name]
        alone = ld.Packing([[0, 0, 0]], 1.0, [9, 9, 9])
        for indentation, force in zip(INDENTATIONS, forces, strict=True):
            if force is None:
                continue
            walls = [Plane(tuple(-(1 - indentation) * n), tuple(n)) for n in FACES[name]]
            with exactly_balanced(), ld.Simulation(alone.replace(walls=walls), Droplet(2.0)) as sim:
                state = sim.state()
            table = state.contacts
            assert table["j"].tolist() == [-1 - k for k in range(len(walls))][::-1]
            assert table["force"] == pytest.approx(2 * np.full(len(walls), force), rel=1e-8), name
            assert table["indentation"] == pytest.approx(indentation)
            assert table["distance"] == pytest.approx(1 - indentation)
            assert table["position"] == pytest.approx(
                (1 - indentation) * table["normal"], abs=1e-12
            )
            assert np.abs(state.wall_forces + 2 * force * FACES[name]).max() < 1e-8
            trace = len(walls) * 2 * force * (1 - indentation)
            assert state.pressure == pytest.approx(trace / 3 / state.packing.volume, rel=1e-8)
            if indentation == 0.03:
                assert state.energy == pytest.approx(2 * energy, rel=1e-8)


@pytest.mark.parametrize("name", ["cuboid", "hopper", "posts", "sphere and balls"])
def test_walls_bear_what_droplets_carry(name: str) -> None:
    """Forces on walls are those of their contacts; the pressure is the slope of the energy.

    Droplets keep their radii, so that the walls are scaled with the centers.
    """
    packing = packed(name, number=24)
    with exactly_balanced(), ld.Simulation(packing, LAW) as sim:
        state = sim.state()
        forces = np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)
    table = state.contacts
    at_walls = table["j"] < 0
    assert at_walls.sum() > 4
    assert state.wall_forces.shape == (len(packing.walls), 3)
    on_droplets = table["force_vector"][at_walls].sum(axis=0)
    scale = table["force"].max()
    assert state.wall_forces.sum(axis=0) == pytest.approx(-on_droplets, abs=1e-10 * scale)
    assert forces.sum(axis=0) == pytest.approx(on_droplets, abs=1e-10 * scale)
    moment = np.einsum("ma,ma->", forces_of(state).vector, forces_of(state).force)
    assert state.pressure == pytest.approx(-moment / 3 / packing.volume, rel=1e-8)
    energies, volumes = [], []
    for factor in (1 - 1e-5, 1 + 1e-5):
        with exactly_balanced(), ld.Simulation(packing, LAW) as sim:
            sim.deform(packing.box * factor)
            energies.append(sim.state().energy)
            volumes.append(sim.state().packing.volume)
    slope = -np.diff(energies) / np.diff(volumes)
    assert slope == pytest.approx(state.pressure, rel=1e-6)


def test_forces_are_differences_of_the_energy(drum) -> None:
    with exactly_balanced(), ld.Simulation(drum, LAW) as sim:
        state = sim.state()
        forces = np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)
    along = np.random.default_rng(1).normal(size=forces.shape)
    energies = []
    for step in (-1e-5, 1e-5):
        moved = drum.replace(positions=drum.positions + step * along)
        with exactly_balanced(), ld.Simulation(moved, LAW) as sim:
            energies.append(sim.state().energy)
    assert state.n_contacts.sum() > 100
    assert np.diff(energies) / 2e-5 == pytest.approx(-np.sum(forces * along), rel=1e-6, abs=1e-6)


def test_soft_spheres_jam_between_walls() -> None:
    """Their pressure is the slope of the energy, and contacts are as many as hold them."""
    start = ld.bidisperse(24, sizes=(0.5, 0.6), dimension=3, seed=3).between(SCENES["drum"])
    jammed = ld.jam(start).packing
    assert 0.4 < jammed.phi < 0.6  # walls take room from small packings
    with ld.Simulation(jammed, ld.SoftContact()) as soft:
        state = soft.relax(1e-6)
    touching = state.contacts[state.contacts["j"] < 0]
    assert set((-1 - touching["j"]).tolist()) >= {0}
    assert 1e-6 < state.pressure < 2.1e-6
    assert abs(state.network_contacts - state.isostatic_contacts) <= 3
    assert state.pressure_tensor.trace() / 3 == pytest.approx(state.pressure)
    contacts = np.bincount(touching["i"], minlength=24)
    assert (particle_values(state)["contacts"] >= contacts).all()
    energies, volumes = [], []
    for factor in (1 - 1e-8, 1 + 1e-8):
        with ld.Simulation(jammed.at(jammed.phi / factor**3), ld.SoftContact()) as soft:
            energies.append(soft.state().energy)
            volumes.append(soft.state().packing.volume)
    slope = -np.diff(energies) / np.diff(volumes)
    assert slope == pytest.approx(state.pressure, rel=1e-2)


def test_two_walls_in_one_place() -> None:
    """Their contacts with a droplet have one direction: the force is the slope of the energy."""
    energies = []
    for step in (-1e-5, 1e-5, 0.0):
        one = ld.Packing([[1.1 + step, 0.9, 0.7]], 0.5, [9, 9, 9])
        twice = [Sphere(2.0, (0, 0, 0))] * 2
        with ld.Simulation(one.replace(walls=twice), Droplet()) as sim:
            energies.append(sim.state().energy)
            force = np.array(sim.lmp.gather("f", 1, 3))
    assert (energies[0] - energies[1]) / 2e-5 == pytest.approx(force[0], rel=1e-5)
    assert force / force[0] == pytest.approx(np.array([1.1, 0.9, 0.7]) / 1.1, rel=1e-6)


def test_compression_scales_walls_with_droplets(drum, tmp_path: Path) -> None:
    """They are kept in files, by which runs and LAMMPS go on."""
    with exactly_balanced():
        with ld.Simulation(drum, LAW) as sim:
            states = sim.compress(strain=0.02, steps=2, tolerance=1e-4)[1:]
        states[-1].save(tmp_path)
        with ld.Run(tmp_path).simulation() as sim:
            again = sim.state()
    last = states[-1]
    assert [s.packing.walls[0].radius for s in states] == pytest.approx(
        drum.walls[0].radius * np.array([0.99, 0.98])
    )
    assert last.packing.volume / drum.volume == pytest.approx(0.98**3)
    assert last.pressure > states[0].pressure
    assert again.packing.walls == last.packing.walls
    assert again.energy == pytest.approx(last.energy, rel=1e-11)
    assert again.wall_forces == pytest.approx(last.wall_forces, abs=1e-10)
    assert again.phi == last.phi
    lines = output("lmp", "-in", "in.lammps", "-log", "none", cwd=tmp_path).splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:2] == ["Step", "PotEng"])
    _, energy, _, pressure = map(float, lines[head + 1].split())
    assert energy == pytest.approx(last.energy, rel=1e-10)
    box = np.prod(last.packing.box.diagonal())  # by whose volume LAMMPS divides
    assert pressure * box == pytest.approx(last.pressure * last.packing.volume, rel=1e-9)


def test_a_piston_in_a_tube(drum) -> None:
    """The box may be stretched along the tube alone; across, walls would not be round."""
    with ld.Simulation(drum, LAW) as sim:
        lower = drum.box * [1, 1, 0.995]
        sim.deform(lower)
        assert sim.walls[0].radius == drum.walls[0].radius
        assert sim.box == pytest.approx(lower)
        with pytest.raises(ParameterError, match="cylinder 1 must stay round"):
            sim.deform(drum.box * [1, 0.99, 1])


def test_motion_keeps_the_energy(drum) -> None:
    """Droplets that bounce between walls; the error falls with the square of the step."""
    errors = []
    for timestep, steps in ((0.04, 100), (0.02, 200)):
        with exactly_balanced(), ld.Simulation(drum, LAW) as sim:
            before = sim.state().energy
            for state in sim.run(steps, timestep=timestep, every=steps // 4)[1:]:
                errors.append(abs(state.energy + state.kinetic_energy - before))
        assert state.kinetic_energy > 1e-3 * before
        assert np.abs(state.wall_forces).max() > 0
    coarse, fine = np.max(errors[:4]), np.max(errors[4:])
    assert coarse < 1e-2 * before
    assert fine < coarse / 2


def test_walls_in_pictures_and_files(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for name, outlines, obstacles in (
        ("sphere and balls", 1, 2),
        ("hopper", 6, 0),
        ("posts", 20, 1),
    ):
        with ld.Simulation(packed(name, number=24), LAW) as sim:
            state = sim.state()
        lines = state.plot(forces=True).collections[0].get_paths()  # rims and outlines
        assert len(lines) == outlines
        x = np.concatenate([path.vertices for path in lines])[:, 0]
        widest = max(getattr(wall, "radius", 0.0) for wall in state.packing.walls)
        if name != "posts":
            assert np.ptp(x) == pytest.approx(2 * widest, rel=1e-2)
        low, high = float(state.packing.origin[2]), float(state.packing.box[2, 2])
        cut = state.plot(slice=low + 0.4 * high, contacts=True)
        assert len(cut.collections[1].get_paths()) == obstacles
        with pytest.raises(ParameterError, match=r"slice at .* outside of the walls: take"):
            state.plot(slice=low - 1)
        state.export(tmp_path / "droplets.vtp", mode="w")
        state.export(tmp_path / "forces.vtp", forces=True, mode="w")


def test_cells_end_at_planes() -> None:
    """They fill the room; at round walls they are no polyhedra."""
    with ld.Simulation(packed("cuboid"), LAW) as sim:
        state = sim.state()
    assert (state.volumes / state.local_phi).sum() == pytest.approx(state.packing.volume)
    with ld.Simulation(packed("drum"), LAW) as sim:
        state = sim.state()
        with pytest.raises(ParameterError, match="wall 1 is a cylinder: take a room between"):
            _ = state.local_phi


def test_refusals(drum) -> None:
    two = ld.Packing([[2, 2, 2], [6, 6, 6]], 0.5, [9, 9, 9])
    for walls, told in (
        (
            [Sphere(1, (4, 4, 4), inside=False), Sphere(1, (6, 5.5, 6), inside=False)],
            "particle 1, .* within ball 2",
        ),
        (
            [Sphere(1, (4, 4, 4), inside=False), Sphere(4, (0, 0, 0), inside=False)],
            "ball 2 does not fit into the periodic box",
        ),
        (LIDS[:1], "leave the room open"),
        (ld.BoxWall((9, 9)), "is a wall in 2 dimensions"),
    ):
        with pytest.raises(ParameterError, match=told):
            ld.Simulation(two.replace(walls=walls), Droplet())
    with ld.Simulation(two.replace(walls=LIDS), Droplet()) as sim:
        sim.lmp.command("set atom 2 z 8.1")
        with pytest.raises(LammpsError, match="plane 2"):
            sim.state()
    with ld.Simulation(drum, LAW) as sim:
        state = sim.state()
        with pytest.raises(ParameterError, match="walls are not sheared"):
            next(iter(sim.shear(0.1)[1:]))
        for refused, told in (
            (lambda: sim.relax(pressure=0.1, free="aniso"), "free='aniso' is not for walls"),
            (
                lambda: state.structure_factor(bins=100, k_max=3.0),
                "a container has no wave vectors",
            ),
        ):
            with pytest.raises(ParameterError, match=told):
                refused()


@pytest.mark.parametrize("law", [LAW, ld.SoftContact()], ids=["droplets", "spheres"])
@pytest.mark.parametrize("name", SCENES)
def test_second_derivatives(name: str, law: Droplet | ld.SoftContact) -> None:
    """The energy, its gradient, and differences of forces; motions that no wall resists."""
    packing = packed(name, number=24)
    along = np.random.default_rng(1).normal(size=3 * len(packing))

    def at(step: float) -> tuple[ld.State, np.ndarray]:
        moved = packing.replace(positions=packing.positions + step * along.reshape(-1, 3))
        with ld.Simulation(moved, law) as sim:
            return sim.state(), -np.array(sim.lmp.gather("f", 1, 3))

    with exactly_balanced():
        state, gradient = at(0.0)
        near, far = ((at(h)[1] - at(-h)[1]) / (2 * h) for h in (2e-6, 4e-6))
    hessian, difference = state.hessian(), (4 * near - far) / 3
    assert (state.contacts["j"] < 0).sum() >= 8
    assert hessian.energy == pytest.approx(state.energy, rel=1e-12)
    assert hessian.gradient[: hessian.size] == pytest.approx(gradient, abs=1e-13)
    assert hessian.gradient[hessian.size :] == pytest.approx(0.0, abs=1e-12)
    found = hessian.operator @ along
    assert found == pytest.approx(difference, abs=1e-8 * np.abs(difference).max())
    assert hessian.motions.shape[1] == {"cuboid": 0, "posts": 0, "plates": 2}.get(name, 1)


def test_modes_between_walls(drum: ld.Packing) -> None:
    """At rest no motion is unstable, and all droplets may turn together around the axis."""
    with exactly_balanced(), ld.Simulation(drum.at(0.7), LAW) as sim:
        state = sim.relax(1e-9)
    rattling, modes = int(state.rattlers.sum()), state.modes()
    assert modes.zero_modes == 1 + 3 * rattling
    assert modes.stiffness[0] > 1e-5 * modes.stiffness[-1]
    hessian = state.hessian(rattlers=False)
    assert np.abs(hessian.operator @ hessian.motions).max() < 1e-9 * hessian.scale
    with pytest.raises(ParameterError, match="elastic moduli need a periodic box without walls"):
        state.moduli()


def test_a_cone_follows_a_box_that_is_stretched() -> None:
    """Its tip, and its angle, whose tangent is less where the box is longer."""
    walls = [ld.Cone((0, 0, 1), "z", 0.6), ld.Plane((0, 0, 5), (0, 0, -1))]
    packing = ld.Packing([[0, 0, 4]], 0.5, (9, 9, 9), walls=walls)
    with ld.Simulation(packing, ld.Droplet()) as sim:
        sim.deform(sim.box * [1.0, 1.0, 1.25])
        cone, lid = sim.walls
    assert np.tan(cone.angle) == pytest.approx(np.tan(0.6) / 1.25)
    assert cone.tip == pytest.approx((0.0, 0.0, 1.25))
    assert lid.origin == pytest.approx((0.0, 0.0, 6.25))
