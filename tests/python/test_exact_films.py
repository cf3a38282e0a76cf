"""Exact shapes of droplets that stick, on coarse meshes, against closed forms."""

import math
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.reference import exact_films
from lammps_deformable.reference.exact_droplets import exact_packing
from lammps_deformable.reference.exact_films import Cluster, Film, cluster_of, extrapolated, solve

NODES, NONE = 150, np.zeros(3)


def along(
    distance: float,
    radius: float,
    adhesion: float,
    *,
    radii: tuple[float, ...] = (1.0, 1.0),
    height: float | None = None,
    pull: float = 0.0,
    **more: Any,
) -> Cluster:
    """Two droplets on the axis z, with a film of this radius."""
    at, out = (np.array([(0.0, 0.0, 0.0), (0.0, 0.0, z)]) for z in (distance, 1.0))
    out[0, 2] = -1.0
    middle = np.array([0.0, 0.0, distance / 2.0 if height is None else height])
    film = Film(0, 1, NONE, middle, radius, adhesion)
    return Cluster(at, np.array(radii), np.ones(2), [film], pull * out, **more)


def limits(cluster: Cluster, *names: str, nodes: int = NODES) -> list[np.ndarray]:
    levels = solve(cluster, nodes)
    return [extrapolated(*(getattr(level, name) for level in levels))[0] for name in names]


def test_a_doublet() -> None:
    """Two spheres without a cap, although the mesh begins elsewhere. The first moment of the cap
    shifts the centroid."""
    cosine, sine = 0.88, math.sqrt(1.0 - 0.88**2)
    ball = (1.0 - (1.0 - cosine) ** 2 * (2.0 + cosine) / 4.0) ** (-1.0 / 3.0)
    energies, pressures, areas, forces, centers = limits(
        along(2.0 * ball * cosine, 0.9 * ball * sine, 0.24),
        *("energies", "pressures", "areas", "forces", "centroids"),
    )
    area = math.pi * (ball * sine) ** 2
    assert energies == pytest.approx(4.0 * math.pi * (1.0 / ball - 1.0), rel=0.02)
    assert pressures == pytest.approx(2.0 / ball, rel=1e-4)
    assert areas == pytest.approx(area, rel=2e-3)
    assert np.abs(forces).max() < 2e-3
    apart = 2.0 * (ball * cosine + area**2 / (4.0 * math.pi) / exact_films.VOLUME)
    assert centers[1, 2] - centers[0, 2] == pytest.approx(apart, abs=1e-3)


def test_an_unlike_doublet() -> None:
    """Radii 1 : 2: the film is a cap. Its rim begins elsewhere, too."""
    cluster = along(2.69, 0.5, 0.24, radii=(1.0, 2.0), height=0.9)
    (energies,) = limits(cluster, "energies")
    assert energies.sum() == pytest.approx(-0.153016491631, rel=0.02)


def test_a_droplet_between_plates() -> None:
    """A chain of one droplet and its images is one between plates, of which the nodoid is known."""
    apart = np.array([0.0, 0.0, 2.0 * (1.0 - 0.165395446208)])
    film = Film(0, 0, apart, apart / 2.0, 0.5, 2.0 * (1.0 - math.cos(0.5)))
    chain = Cluster(np.zeros((1, 3)), np.ones(1), np.ones(1), [film], np.zeros((1, 3)))
    energies, pressures, forces, areas = limits(
        chain, "energies", "pressures", "forces", "areas", nodes=300
    )
    assert energies[0] == pytest.approx(-0.081499534906, rel=3e-3)
    assert pressures[0] == pytest.approx(2.0135952342, rel=1e-5)
    assert forces[0] == pytest.approx([0.0, 0.0, 0.2], abs=5e-4)
    assert areas[0] == pytest.approx(math.pi * 0.5352558141**2, rel=2e-4)


def test_outer_forces() -> None:
    """Forces of films balance them, and energies follow from the work: on the volume at its
    centroid, or at the center of the sphere that goes on behind the film."""

    def held(pull: float, spheres: bool) -> tuple[float, float, float]:
        cluster = along(1.77, 0.46, 0.24, pull=pull, spheres=spheres)
        energies, forces, centers, areas = limits(
            cluster, "energies", "forces", "centroids", "areas"
        )
        distance = float(centers[1, 2] - centers[0, 2])
        if spheres:
            distance -= 2.0 * float(areas[0]) ** 2 / (4.0 * math.pi) / exact_films.VOLUME
        return float(energies.sum()), distance, float(forces[0, 2])

    for spheres in (False, True):
        (less, near, one), (more, far, other) = (held(pull, spheres) for pull in (0.08, 0.12))
        assert (one, other) == pytest.approx((-0.08, -0.12), abs=1e-3)
        assert more - less == pytest.approx(0.1 * (far - near), rel=0.05)


def test_a_packing() -> None:
    """A loose droplet is a ball, a pair has the law's energy; a film is not made up."""
    packing = ld.Packing(
        [[3.0, 6.0, 6.0], [4.9, 6.0, 6.0], [9.0, 6.0, 6.0]], 1.0, (12.0,) * 3, species=[0, 0, 1]
    )
    with ld.Simulation(packing, ld.Droplet(adhesion=((0.24, 0.0), (0.0, 0.0)))) as sim:
        state = sim.relax(1e-4)
    exact = exact_packing(state)
    assert [exact.i.tolist(), exact.j.tolist()] == [[0], [1]]
    assert exact.found.energies.sum() == pytest.approx(state.energy, rel=0.01)
    assert exact.found.energies[2] == pytest.approx(0.0, abs=1e-4)
    assert exact.found.pressures == pytest.approx(state.pressures, rel=1e-4)
    assert abs(exact.found.forces[0]) < 1e-3
    apart = packing.replace(positions=[[3.0, 6.0, 6.0], [6.0, 6.0, 6.0], [9.0, 6.0, 6.0]])
    with ld.Simulation(apart, state.law) as sim:
        (loose,) = limits(cluster_of(sim.state()), "pressures")
    assert loose == pytest.approx(2.0, rel=1e-4)
    pressed = packing.replace(positions=[[3.0, 6.0, 6.0], [4.9, 6.0, 6.0], [6.8, 6.0, 6.0]])
    with (
        ld.Simulation(pressed, state.law) as sim,
        pytest.raises(ValueError, match="without a film"),
    ):
        cluster_of(sim.state())


def test_errors_of_droplets_that_stick() -> None:
    """A droplet of a simple cubic crystal, which is one between six plates."""
    start = ld.crystal("sc", 1, phi=0.53)
    compared = ld.compare(start, law=ld.Droplet(adhesion=0.1), strain=0.01, steps=1, workers=1)
    methods = [row["method"] for row in compared.rows]
    assert methods == ["droplet", "elements", "elements", "elements", "reference"]
    assert compared.rows[0]["energy_error"] < 2e-3
    assert compared.rows[0]["pressure_error"] < 2e-3
    assert compared.rows[-1]["limit_error"] < 2e-3


def test_no_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_films, "_ITERATIONS", 1)
    with pytest.raises(ArithmeticError, match="no shape was found in 1 iterations"):
        solve(along(1.77, 0.46, 0.24), NODES)
