"""Packings for Surface Evolver, an outside judge: it finds the exact shapes of droplets and foam.

A file has the outlines of all particles with the films between them, and two commands: `relax`
finds the shapes of least energy, `results` writes what `Evolved` reads. Films that the state does
not have never form, so that Surface Evolver is right as long as contacts stay the same.

Source: K. A. Brakke, Experimental Mathematics 1, 141 (1992).
"""

from __future__ import annotations

import math
import re
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.checks import expect, shown
from ..common.errors import FileError, ParameterError
from ..common.files import at_home
from ..particles.laws import Droplet, Ring, pair_matrix, per_species, volumes
from ..particles.walls import Plane

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..state.state import State

Floats = NDArray[np.float64]

# Points of a free droplet, and of the largest films; of an outline each so many radians have one.
_POINTS, _RING, _ARC = 120, 13, 0.3

# A film begins smaller than it is, in radii of it: its rim has to stand out from the surface.
_SMALLER = 0.95

# Free points keep this distance from films, in radii of the droplet, and in those of the film. They
# lie on a sphere larger by this factor than the rims.
_APART, _BESIDE, _OUTER = 0.08, 1.15, 1.01

# In space conjugate gradients go on until five steps change the energy by less than this part: with
# nothing left to gain Surface Evolver ends with an error. It knows the energy of a changed mesh
# after a step. Many steps with straight edges let facets at the rims of films collapse.
_RELAX = {
    2: "relax := { g 50; r; g 50; V; conj_grad on; g 200; M 2; g 1000; V 5; g 1000; }",
    3: """settle := { rounds := 0;
  do { before := total_energy; g 5; rounds := rounds + 1 }
  while (abs(before - total_energy) > 1e-10 * total_energy and rounds < 120) }
relax := { g 30; u; V; g 30; u; V; r; u; V; conj_grad on; g 40; u; V;
  M 2; settle; u; V; settle; }""",
}
_FINER = {
    2: "finer := { r; V 5; g 2000; }",
    3: "finer := { M 1; u; V; r; M 2; settle; }",
}

_RESULTS = """results := {{
  define films real[{films}];
  number := 1;
  while number <= {films} do {{ films[number] := 0; number := number + 1 }};
  foreach {element} ee where film > 0 do films[ee.film] += ee.{size};
  printf "energy %.15g\\n", total_energy;
  foreach body bb do printf "body %d %.15g %.15g\\n", bb.id, bb.volume, bb.pressure;
  number := 1;
  while number <= {films} do {{
    printf "film %d %.15g\\n", number, films[number];
    number := number + 1
  }}
}}
"""


class Evolved(NamedTuple):
    """What Surface Evolver has found, by `results >> "file"`.

    Attributes:
        energy: of all outlines, tension times perimeter, in space times surface [energy].
        sizes: area of each particle, in space volume, shape (N,) [length^d].
        pressures: in each particle, above that around them, shape (N,) [energy/length^d].
        films: length of each contact, in space area, in the order of the rows of `state.contacts`
            with i < j or with a wall, shape (M,) [length^(d-1)].
    """

    energy: float
    sizes: Floats
    pressures: Floats
    films: Floats

    def pressure(self, box: Floats) -> float:
        """That of the packing, from the balance of a change of scale.

            P V = sum_i p_i V_i - (d - 1)/d E

        Args:
            box: lattice vectors, shape (d, d).
        """
        d = len(box)
        work = float(np.sum(self.pressures * self.sizes)) - (d - 1) / d * self.energy
        return work / float(np.prod(np.diagonal(box)))

    @classmethod
    def from_file(cls, path: str | Path) -> Evolved:
        """Read results; of several in a file the last ones.

        Raises:
            FileError: it cannot be read, or has none.
        """
        expect("path", path, str, Path)
        try:
            text = at_home(path).read_text()
        except OSError as error:
            raise FileError(f"'{path}' cannot be read: {error.strerror}") from None
        last = text[max(text.rfind("energy "), 0) :]
        energy = re.findall(r"^energy (\S+)", last, re.MULTILINE)
        bodies = re.findall(r"^body \d+ (\S+) (\S+)", last, re.MULTILINE)
        if not energy or not bodies:
            raise FileError(f"'{path}' has no results: give Surface Evolver results >> \"{path}\"")
        sizes, pressures = np.array(bodies, dtype=float).T
        films = re.findall(r"^film \d+ (\S+)", last, re.MULTILINE)
        return cls(float(energy[0]), sizes, pressures, np.array(films, dtype=float))


def datafile(state: State) -> str:
    """The text of a file of Surface Evolver.

    Raises:
        ParameterError: particles are no droplets with constant areas or volumes; or a wall is not
            flat, or sticks.
    """
    packing, law = state.packing, state.law
    kinds = len(packing.species_radii)
    planes: list[Plane] = []
    for wall in packing.walls:
        if not isinstance(wall, Plane) or wall.adhesion:
            raise ParameterError(
                f"Surface Evolver gets flat walls without adhesion, not {shown(wall)}"
            )
        planes.append(wall)
    if isinstance(law, Ring):
        rigid = np.isinf(law.kA)
        loose = np.asarray(law.kP) == 0.0
        if not rigid.all() or not loose.all() or np.any(law.skin):
            raise ParameterError(
                "Surface Evolver gets droplets of constant area, Ring(kA=inf, kP=0, tension=T)"
            )
    elif not isinstance(law, Droplet):
        raise ParameterError(f"Surface Evolver gets a Droplet or a Ring, not {law!r}")
    elif law.sticks:
        raise ParameterError(
            f"Surface Evolver gets droplets in space without adhesion, not {law!r}"
        )
    tension = np.array(per_species(law.tension, kinds))
    mesh = Mesh(packing.box, tension[packing.species], planes)
    contacts = np.asarray(state.contacts)
    contacts = contacts[(contacts["i"] <= contacts["j"]) | (contacts["j"] < 0)]
    if packing.dimension == 2:
        adhesion = pair_matrix("adhesion", law.adhesion, kinds)
        _outlines(mesh, packing.positions, packing.radii, contacts, adhesion, packing.species)
    else:
        _surfaces(mesh, packing.positions, packing.radii, contacts)
    return mesh.text(volumes(packing.radii, packing.dimension))


class Mesh:
    """Vertices, edges, faces and bodies of a periodic datafile.

    A vertex is stored once, near the first particle that has it. `image` of a particle tells where
    that particle sees it: at its place plus this many lattice vectors.

    Args:
        box: lattice vectors.
        tension: of each particle.
        walls: of the packing; what is on one has the constraint of its number, from 1.
    """

    def __init__(self, box: Floats, tension: Floats, walls: Sequence[Plane]) -> None:
        self.box, self.tension, self.dimension = box, tension, len(box)
        self.vertices: list[Floats] = []
        self.walls = walls
        self._wall: dict[int, str] = {}  # of vertices
        self.image: list[dict[int, tuple[int, ...]]] = [{} for _ in tension]
        self.edges: list[str] = []
        self.faces: list[str] = []
        self.bodies: list[list[int]] = [[] for _ in tension]
        self.films = 0
        self._numbers: dict[tuple[int, int, tuple[int, ...]], int] = {}

    def vertex(self, x: Floats, images: dict[int, tuple[int, ...]], wall: str = "") -> int:
        """A new vertex near the first of these particles."""
        self.vertices.append(x)
        self._wall[len(self.vertices)] = wall
        for particle, image in images.items():
            self.image[particle][len(self.vertices)] = image
        return len(self.vertices)

    def seen(self, particle: int, vertex: int) -> Floats:
        """Where a particle sees a vertex."""
        return self.vertices[vertex - 1] + np.array(self.image[particle][vertex]) @ self.box

    def edge(self, particle: int, tail: int, head: int, words: str = "") -> int:
        """The number of an edge of this particle, negative if it is there the other way round."""
        image = self.image[particle]
        wrap = tuple(int(b - a) for a, b in zip(image[tail], image[head], strict=True))
        back = tuple(-w for w in wrap)
        if (head, tail, back) in self._numbers:
            return -self._numbers[head, tail, back]
        if (tail, head, wrap) not in self._numbers:
            if self._wall[tail] == self._wall[head]:
                words = f"{words} {self._wall[tail]}"
            signs = " ".join({0: "*", 1: "+", -1: "-"}[w] for w in wrap)
            self.edges.append(f"{tail} {head} {signs} {words}".rstrip())
            self._numbers[tail, head, wrap] = len(self.edges)
        return self._numbers[tail, head, wrap]

    def face(self, particle: int, corners: list[int], words: str = "") -> int:
        """A new face of this particle, counterclockwise seen from outside."""
        closed = pairwise([*corners, corners[0]])
        edges = " ".join(str(self.edge(particle, tail, head)) for tail, head in closed)
        self.faces.append(f"{edges} {words}".rstrip())
        return len(self.faces)

    def text(self, sizes: Floats) -> str:
        """The datafile; sizes are areas or volumes of all particles."""
        plane = self.dimension == 2
        head = ["string", "space_dimension 2"] if plane else []
        head += ["torus", "periods", *(" ".join(map(repr, map(float, row))) for row in self.box)]
        element = "edge" if plane else "facet"
        head.append(f"define {element} attribute film integer")
        for number, wall in enumerate(self.walls, 1):
            terms = " + ".join(f"{n!r}*{x}" for n, x in zip(wall.normal, "xyz", strict=False))
            height = float(np.dot(wall.normal, wall.origin))
            head.append(f"constraint {number}\nformula: {terms} = {height!r}")
        places = [
            " ".join([*(repr(float(x)) for x in vertex), self._wall[number]]).rstrip()
            for number, vertex in enumerate(self.vertices, 1)
        ]
        bodies = [
            f"{' '.join(map(str, faces))} volume {float(size)!r}"
            for faces, size in zip(self.bodies, sizes, strict=True)
        ]
        results = _RESULTS.format(
            films=self.films, element=element, size="length" if plane else "area"
        )
        lists = {
            "vertices": places,
            "edges": self.edges,
            "faces": self.faces,
            "bodies": bodies,
        }
        parts = ["\n".join(head)]
        for name, rows in lists.items():
            parts.append("\n".join([name, *(f"{k} {row}" for k, row in enumerate(rows, 1))]))
        commands = "\n".join([_RELAX[self.dimension], _FINER[self.dimension], results])
        return "\n\n".join([*parts, f"read\n{commands}"])


def _images(contact: np.void) -> dict[int, tuple[int, ...]]:
    """How both particles of a contact see its film, which is stored near the first one."""
    i, j = int(contact["i"]), int(contact["j"])
    if j < 0:
        return {i: (0,) * len(contact["image"])}
    if i == j:
        raise ParameterError(f"particle {i} touches its own image: take a larger box")
    return {i: (0,) * len(contact["image"]), j: tuple(-int(k) for k in contact["image"])}


def _wall_of(contact: np.void) -> str:
    """What vertices, edges and faces on the wall of a contact have; nothing of a pair."""
    return f"constraint {-contact['j']}" if contact["j"] < 0 else ""


def _outlines(
    mesh: Mesh,
    x: Floats,
    radii: Floats,
    contacts: NDArray[np.void],
    adhesion: Floats,
    species: NDArray[np.int64],
) -> None:
    """Lines of contact, and arcs of a circle between them."""
    lines: list[list[tuple[float, int, int]]] = [[] for _ in x]  # angle, first and last vertex
    for number, contact in enumerate(contacts, 1):
        images, wall = _images(contact), _wall_of(contact)
        i, j = int(contact["i"]), int(contact["j"])
        angle = float(contact["angle"] + contact["tilt"])
        along = 0.5 * float(contact["length"]) * np.array([-math.sin(angle), math.cos(angle)])
        first, last = (
            mesh.vertex(contact["position"] + way * along, images, wall) for way in (-1, 1)
        )
        tension = float(mesh.tension[i])
        towards = float(contact["angle"])
        lines[i].append((towards, first, last))
        if not wall:
            tension += float(mesh.tension[j] - adhesion[species[i], species[j]])
            lines[j].append((towards + math.pi, last, first))
        mesh.edge(i, first, last, f"tension {tension!r} film {number}")
    mesh.films = len(contacts)
    for i, own in enumerate(lines):
        words = f"tension {float(mesh.tension[i])!r}"
        loop: list[int] = []
        if own:
            own.sort(key=lambda line: line[0] % (2.0 * math.pi))
            for (_, first, last), (_, then, _) in pairwise([*own, own[0]]):
                chain = [last, *_arc(mesh, i, x[i], last, then), then]
                loop.append(mesh.edge(i, first, last))
                loop += [mesh.edge(i, tail, head, words) for tail, head in pairwise(chain)]
        else:
            count = math.ceil(2.0 * math.pi / _ARC)
            angles = 2.0 * math.pi * np.arange(count) / count
            chain = [_on_circle(mesh, i, x[i], radii[i], angle) for angle in angles]
            loop = [mesh.edge(i, *ends, words) for ends in pairwise([*chain, chain[0]])]
        mesh.faces.append(" ".join(map(str, loop)))
        mesh.bodies[i] = [i + 1]


def _on_circle(mesh: Mesh, i: int, center: Floats, radius: float, angle: float) -> int:
    direction = np.array([math.cos(angle), math.sin(angle)])
    return mesh.vertex(center + radius * direction, {i: (0, 0)})


def _arc(mesh: Mesh, i: int, center: Floats, begin: int, end: int) -> list[int]:
    """Vertices between the ends of two lines of a particle, counterclockwise."""
    (a, b) = (mesh.seen(i, vertex) - center for vertex in (begin, end))
    start = math.atan2(a[1], a[0])
    turn = (math.atan2(b[1], b[0]) - start) % (2.0 * math.pi)
    steps = max(2, math.ceil(turn / _ARC))
    radii = np.linspace(math.hypot(*a), math.hypot(*b), steps + 1)
    return [
        _on_circle(mesh, i, center, float(radii[k]), start + turn * k / steps)
        for k in range(1, steps)
    ]


def _surfaces(mesh: Mesh, x: Floats, radii: Floats, contacts: NDArray[np.void]) -> None:
    """Flat films, and the rest of each surface: the convex hull of their rims and of points of a
    sphere."""
    rims: list[list[list[int]]] = [[] for _ in x]
    for number, contact in enumerate(contacts, 1):
        images, wall = _images(contact), _wall_of(contact)
        sides = list(images)
        i, normal = sides[0], contact["normal"]
        center = contact["position"]
        if not wall:
            j, distance = sides[1], float(contact["distance"])
            height = 0.5 * (distance + (radii[i] ** 2 - radii[j] ** 2) / distance)
            center = x[i] + height * normal
        radius = _SMALLER * float(contact["facet_radius"])
        count = max(6, round(_RING * min(1.0, radius / (0.3 * radii[sides].min()))))
        across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        across /= math.sqrt(float(np.sum(across * across)))
        middle = mesh.vertex(center, images, wall)
        rim = []
        for k in range(count):
            angle = 2.0 * math.pi * k / count
            out = math.cos(angle) * across + math.sin(angle) * np.cross(normal, across)
            rim.append(mesh.vertex(center + radius * out, images, wall))
        words = f"tension {float(mesh.tension[sides].sum())!r} film {number} {wall}".rstrip()
        film = [mesh.face(i, [middle, a, b], words) for a, b in pairwise([*rim, rim[0]])]
        mesh.bodies[i] += film
        if not wall:
            mesh.bodies[j] += [-face for face in film]
        for side in sides:
            rims[side].append(rim)
    mesh.films = len(contacts)
    for i, own in enumerate(rims):
        _free_surface(mesh, i, x[i], radii[i], own)


def _free_surface(mesh: Mesh, i: int, center: Floats, radius: float, rims: list[list[int]]) -> None:
    from scipy.spatial import ConvexHull

    places = [np.array([mesh.seen(i, vertex) - center for vertex in rim]) for rim in rims]
    # beyond all rims, so that no point is inside of them
    radius = _OUTER * max([radius, *(float(np.sqrt(np.sum(at**2, axis=1).max())) for at in places)])
    k = np.arange(_POINTS) + 0.5
    z = 1.0 - 2.0 * k / _POINTS
    angle = math.pi * (1.0 + math.sqrt(5.0)) * k  # a spiral with the golden ratio
    r = np.sqrt(1.0 - z * z)
    points = radius * np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    free = np.ones(_POINTS, dtype=bool)
    for at in places:
        middle = at.mean(axis=0)
        film = math.sqrt(float(np.sum((at[0] - middle) ** 2)))
        height = math.sqrt(float(np.sum(middle**2)))
        along = points @ (middle / height)
        across = np.sqrt(np.maximum(np.sum(points**2, axis=1) - along**2, 0.0))
        near = (along > 0.0) & (across < _BESIDE * film + _APART * radius)
        free &= (along < height) & ~near
    vertices = [mesh.vertex(center + point, {i: (0, 0, 0)}) for point in points[free]]
    vertices += [vertex for rim in rims for vertex in rim]
    corners_at = np.concatenate([points[free], *places])
    hull = ConvexHull(corners_at)
    if len(hull.vertices) < len(vertices):
        raise ParameterError(f"the films of droplet {i} overlap: it is squeezed too much")
    words = f"tension {float(mesh.tension[i])!r}"
    films = [set(rim) for rim in rims]
    for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = corners_at[simplex]
        outwards = float(np.sum(np.cross(b - a, c - a) * equation[:3])) > 0.0
        corners = [vertices[k] for k in (simplex if outwards else simplex[::-1])]
        if not any(film.issuperset(corners) for film in films):
            mesh.bodies[i].append(mesh.face(i, corners, words))
