"""Files for Surface Evolver: meshes that close, and what it finds."""

import math
import re
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

from validation.surface_evolver.__main__ import CASES, FOAM, evolved, free_energy, program

NEEDS_IT = pytest.mark.skipif(program() is None, reason="Surface Evolver is missing")


@pytest.fixture(scope="module")
def foam() -> ld.State:
    return CASES["foam 0.92"]()


@pytest.fixture(scope="module")
def droplets() -> ld.State:
    return CASES["8 droplets, 1 : 1.4 at 0.78"]()


class File:
    """Vertices, edges, faces and bodies of a datafile; numbers begin at 1."""

    def __init__(self, path: Path) -> None:
        lines = path.read_text().splitlines()

        def rows(name: str) -> list[list[str]]:
            found = lines[lines.index(name) + 1 :]
            return [line.split()[1:] for line in found[: found.index("")]]

        at = lines.index("periods")
        dimension = 2 if "string" in lines else 3
        self.box = np.array([line.split() for line in lines[at + 1 : at + 1 + dimension]], float)
        self.vertex_words = rows("vertices")
        self.x = np.array([row[:dimension] for row in self.vertex_words], dtype=float)
        signs = {"*": 0, "+": 1, "-": -1}
        edges = rows("edges")
        self.ends = np.array([row[:2] for row in edges], dtype=int) - 1
        self.wraps = np.array([[signs[w] for w in row[2 : 2 + dimension]] for row in edges])
        self.edge_words = edges
        self.faces = [
            [int(k) for k in " ".join(row).split("tension")[0].split()] for row in rows("faces")
        ]
        self.face_words = rows("faces")
        bodies = rows("bodies")
        self.bodies = [[int(k) for k in row[:-2]] for row in bodies]
        self.sizes = np.array([row[-1] for row in bodies], dtype=float)
        self.films = int(re.search(r"define films real\[(\d+)\]", path.read_text())[1])

    def step(self, edge: int) -> tuple[int, int, np.ndarray]:
        """Tail, head and the vector from one to the other."""
        k = abs(edge) - 1
        tail, head = self.ends[k]
        vector = self.x[head] - self.x[tail] + self.wraps[k] @ self.box
        return (tail, head, vector) if edge > 0 else (head, tail, -vector)

    def loop(self, face: int) -> list[int]:
        edges = self.faces[abs(face) - 1]
        return edges if face > 0 else [-edge for edge in reversed(edges)]

    def places(self, body: int) -> dict[int, np.ndarray]:
        """Of the vertices of a body, from one to the next along edges: all ways agree."""
        steps = [self.step(edge) for face in self.bodies[body] for edge in self.loop(face)]
        found = {steps[0][0]: self.x[steps[0][0]]}
        for _ in steps:
            new = {head: found[tail] + v for tail, head, v in steps if tail in found}
            if new.keys() <= found.keys():
                break
            found = new | found
        for tail, head, vector in steps:
            np.testing.assert_allclose(found[head], found[tail] + vector, atol=1e-9)
        return found


def films_have_two_sides(users: list[list[int]], words: list[list[str]]) -> None:
    """Films belong to two faces, in space to two bodies, all else to one."""
    uses = np.bincount([abs(each) for user in users for each in user])
    assert uses[1:].tolist() == [2 if "film" in row else 1 for row in words]


def test_outlines_close(foam: ld.State, tmp_path: Path) -> None:
    """Each particle has a loop of nearly its area, counterclockwise, and each film two sides."""
    foam.export(tmp_path / "foam.fe")
    file = File(tmp_path / "foam.fe")
    assert file.films == len(foam.contacts) / 2
    for body, size in enumerate(file.sizes):
        at = file.places(body)
        loop = [file.step(edge) for edge in file.loop(file.bodies[body][0])]
        assert all(now[1] == then[0] for now, then in zip(loop, loop[1:] + loop[:1], strict=True))
        points = np.array([at[tail] for tail, _, _ in loop])
        x, y = points.T
        area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        assert 0.9 * size < area < size
        assert size == pytest.approx(math.pi * foam.packing.radii[body] ** 2)
    films_have_two_sides(file.faces, file.edge_words)


def test_surfaces_close(droplets: ld.State, tmp_path: Path) -> None:
    """Each droplet has a surface like a sphere, of nearly its volume, outwards."""
    droplets.export(tmp_path / "droplets.fe")
    file = File(tmp_path / "droplets.fe")
    assert file.films == len(droplets.contacts) / 2
    for body, size in enumerate(file.sizes):
        at = file.places(body)
        loops = [[file.step(edge) for edge in file.loop(face)] for face in file.bodies[body]]
        steps = [step[:2] for loop in loops for step in loop]
        assert {(b, a) for a, b in steps} == set(steps)
        assert len(at) - len(steps) // 2 + len(loops) == 2  # Euler
        triangles = np.array([[at[tail] for tail, _, _ in loop] for loop in loops])
        volume = np.linalg.det(triangles - triangles.mean(axis=(0, 1))).sum() / 6.0
        assert volume == pytest.approx(size, rel=0.2)
    films_have_two_sides(file.bodies, file.face_words)


def test_particles_alone(tmp_path: Path) -> None:
    """A droplet without contacts is a circle, or a sphere."""
    for packing, law in (
        (ld.Packing([(1.0, 1.0)], 0.5, (3.0, 3.0)), FOAM),
        (ld.Packing([(1.0, 1.0, 1.0)], 0.5, (3.0, 3.0, 3.0)), ld.Droplet()),
    ):
        with ld.Simulation(packing, law) as sim:
            sim.state().export(tmp_path / "alone.fe", mode="w")
        file = File(tmp_path / "alone.fe")
        points = np.array(list(file.places(0).values()))
        radii = np.linalg.norm(points - packing.positions[0], axis=1)
        np.testing.assert_allclose(radii, radii[0])
        assert file.films == 0


def test_refusals(foam: ld.State, tmp_path: Path) -> None:
    path = tmp_path / "foam.fe"
    foam.export(path)
    with pytest.raises(ld.FileError, match="is there already"):
        foam.export(path)
    foam.export(path, mode="w")
    packing = foam.packing
    for law in (ld.Ring(), ld.SoftContact(), ld.Ring(kA=2.0, kP=0.0, tension=1.0)):
        with ld.Simulation(packing, law) as sim:
            state = sim.state()
        with pytest.raises(ld.ParameterError, match="Surface Evolver gets"):
            state.export(tmp_path / "other.fe")
    walled = ld.Packing([(0.0, 0.0)], 0.5, (3.0, 3.0)).between(ld.Sphere(0.6, (0.0, 0.0)))
    with ld.Simulation(walled, FOAM) as sim, pytest.raises(ld.ParameterError, match="flat walls"):
        sim.state().export(tmp_path / "other.fe")
    image = ld.Packing([(0.5, 0.5)], 0.5, (0.99, 3.0))
    with ld.Simulation(image, FOAM) as sim, pytest.raises(ld.ParameterError, match="own image"):
        sim.state().export(tmp_path / "other.fe")


def test_results(tmp_path: Path) -> None:
    path = tmp_path / "results"
    rows = "body 1 2 0.5\nbody 2 3 0.25\nfilm 1 0.125\n"
    path.write_text(f"energy 1\n{rows}energy 4\n{rows}")
    found = ld.Evolved.from_file(path)
    assert found.energy == 4.0
    assert [list(found.sizes), list(found.pressures), list(found.films)] == [
        [2.0, 3.0],
        [0.5, 0.25],
        [0.125],
    ]
    assert found.pressure(np.diag([2.0, 4.0])) == (2.0 * 0.5 + 3.0 * 0.25 - 4.0 / 2.0) / 8.0
    path.write_text("nothing")
    with pytest.raises(ld.FileError, match="has no results"):
        ld.Evolved.from_file(path)
    with pytest.raises(ld.FileError, match="missing' cannot be read: No such file"):
        ld.Evolved.from_file(tmp_path / "missing")


@pytest.mark.parametrize("case", ["plates", "plates in the plane"])
def test_films_at_walls(case: str, tmp_path: Path) -> None:
    """Vertices and edges of a film, and its faces in space, are held on its wall, and no others."""
    state = CASES[case]()
    state.export(tmp_path / "plates.fe")
    file, d = File(tmp_path / "plates.fe"), state.packing.dimension
    text = (tmp_path / "plates.fe").read_text()
    found = re.findall(r"^constraint (\d)\nformula: .*1\.0\*\w = (\S+)", text, re.MULTILINE)
    heights = {number: abs(float(height)) for number, height in found}
    assert sorted(heights.values()) == pytest.approx([0.0, 1.8], abs=1e-12)
    elements = [
        (file.vertex_words, [[k] for k in range(len(file.x))]),
        (file.edge_words, file.ends),
    ]
    for words, vertices in elements:
        for row, which in zip(words, vertices, strict=True):
            at = set(np.round(file.x[which, -1], 9))
            assert ("constraint" in row) == (at in ({0.0}, {1.8}))
            if "constraint" in row:
                assert at == {round(heights[row[row.index("constraint") + 1]], 9)}
    films = file.edge_words if d == 2 else file.face_words
    assert all(("film" in row) == ("constraint" in row) for row in films)
    assert file.films == 2


@NEEDS_IT
def test_a_droplet_between_plates(tmp_path: Path) -> None:
    """In the plane the law is exact."""
    state = CASES["plates in the plane"]()
    (found,) = evolved(state, tmp_path, finer=False)
    assert found.energy - free_energy(state) == pytest.approx(state.energy, rel=1e-6)
    np.testing.assert_allclose(found.pressures, state.pressures, rtol=1e-6)


@NEEDS_IT
def test_two_that_stick(tmp_path: Path) -> None:
    """Surface Evolver finds the energy of the law, and the length of the film."""
    state = CASES["two that stick"]()
    (found,) = evolved(state, tmp_path, finer=False)
    assert found.energy - free_energy(state) == pytest.approx(state.energy, rel=1e-4)
    np.testing.assert_allclose(found.pressures, state.pressures, rtol=1e-4)
    np.testing.assert_allclose(found.films, state.contacts["length"][:1], rtol=1e-3)


@pytest.mark.slow
@NEEDS_IT
def test_foam(foam: ld.State, tmp_path: Path) -> None:
    (found,) = evolved(foam, tmp_path, finer=False)
    assert found.energy - free_energy(foam) == pytest.approx(foam.energy, rel=5e-3)
    assert found.pressure(foam.packing.box) == pytest.approx(foam.pressure, rel=2e-3)
    np.testing.assert_allclose(found.pressures, foam.pressures, rtol=2e-3)
