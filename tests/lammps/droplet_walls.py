"""Droplets between walls in three dimensions."""

import numpy as np
from droplets import EXACT, Droplets
from polyhedra import FACES

SIDE = 8.0  # of the box, around the origin
ORIGIN = np.zeros((1, 3))
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def walled(x, walls, folder, boundary="f f f", radius=1.0, style=EXACT, more=""):
    """Droplets at x, with the fix `walls`: its arguments, or commands that define it."""
    if "\n" not in walls:
        walls = f"fix walls all deformable/wall {walls}\n"
    count = len(x)
    case = {"x": x, "box": [SIDE] * 3, "low": -0.5 * SIDE}
    case |= {"radius": [radius] * count, "tension": [1.0] * count}
    return Droplets(case, folder, style=style, commands=walls + more, boundary=boundary)


def region(*lines):
    """Commands for one wall of these regions, which intersect; each is a name and its words."""
    names = [line.split()[0] for line in lines]
    commands = "".join(f"region {line}\n" for line in lines)
    if len(lines) == 1:
        return f"{commands}fix walls all deformable/wall {names[0]}\n"
    return (
        f"{commands}region scene intersect {len(names)} {' '.join(names)}\n"
        "fix walls all deformable/wall scene\n"
    )


def _words(vector):
    return " ".join(f"{value:.17g}" for value in vector)


def faces(normals, heights):
    """Commands for a container of planes around the origin, as one region."""
    words = [
        f"face{k} plane {_words(h * n)} {_words(-n)}"
        for k, (n, h) in enumerate(
            zip(normals, np.broadcast_to(heights, len(normals)), strict=True)
        )
    ]
    return region(*words)


def force_on_walls(scene, fix="walls"):
    return np.array([scene.lmp.extract_fix(fix, 0, 1, k) for k in range(3)])


def at_walls(scene):
    """The rows of contacts with walls."""
    rows = scene.contacts()
    return rows[rows[:, 1] < 0]


# Eight droplets around the origin touch all of their walls.
ROOM = "room block -1.97 1.98 -1.96 1.98 -1.97 1.96"
SCENES = {
    "block": region(ROOM),
    "prism": region("room prism -1.97 1.98 -1.96 1.98 -1.97 1.96 0.1 -0.05 0.08"),
    "cylinder": region("room cylinder y 0.02 0.01 2.39 -1.97 1.96"),
    "sphere": region("room sphere 0.02 0.01 -0.01 2.7"),
    "cone": region("room cone x 0.01 0.02 2.5 2.33 -1.97 1.97"),
    "ball": region(ROOM, "post sphere 0.01 0.02 0.0 0.75 side out"),
    "brick with corners": region(ROOM, "brick block -0.43 0.44 -0.43 0.45 -0.44 0.44 side out"),
    "brick with edges": region(ROOM, "brick block -0.31 0.32 -0.31 0.33 -1.5 1.5 side out"),
    "rims": region(ROOM, "post cylinder x 0.01 0.02 0.6 -0.45 0.46 side out"),
    "pillar": region(ROOM, "post cylinder z 0.01 0.02 0.44 INF INF side out"),
    "horn": region(ROOM, "horn cone y 0.01 0.0 0.6 0.34 -1.5 1.5 side out"),
    "rims of a cone": region(ROOM, "horn cone x 0.01 0.0 0.6 0.68 -0.45 0.42 side out"),
    "slanted prism": region(ROOM, "bar prism -0.4 0.4 -0.3 0.4 -0.5 0.5 0.1 0.2 -0.1 side out"),
}
TETRAHEDRON = FACES["tetrahedron"]
SCENES["tetrahedron"] = SCENES["block"] + (
    "".join(
        f"region t{k} plane {_words(0.26 * n)} {_words(n)}\n" for k, n in enumerate(TETRAHEDRON)
    )
    + "region post union 4 t0 t1 t2 t3\nfix second all deformable/wall post\n"
)
