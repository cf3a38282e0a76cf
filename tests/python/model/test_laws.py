"""Contact laws as settings."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused


def rows(law: ld.Ring | ld.Sector, radii: list[float]) -> list[list[float]]:
    """kA, kP and skin of each species."""
    return np.column_stack(law.species_parameters(radii)[:3]).tolist()


def test_species_with_stiffnesses_of_their_own() -> None:
    ring = ld.Ring(kA=[1.0, math.inf], kP=np.array([math.inf, 2.0]), skin=0.1)
    assert ring == ld.Ring(kA=(1, math.inf), kP=(math.inf, 2), skin=0.1)
    assert rows(ring, [0.5, 0.7]) == [[1.0, math.inf, 0.1], [math.inf, 2.0, 0.1]]
    with pytest.raises(ld.ParameterError, match="there are 3 species"):
        ring.species_parameters([0.5, 0.6, 0.7])
    with pytest.raises(ld.ParameterError, match="not 2, 3, 1 and 1 numbers"):
        ld.Ring(kA=[1.0, 2.0], kP=[1.0, 2.0, 3.0])


def test_outline_of_a_ring_that_expands() -> None:
    """In a hexagon: area and perimeter of the outline are those of the kernel, skin and all."""
    angle, a, skin = np.arange(6) * np.pi / 3, np.full(6, 0.03), 0.05
    ring = ld.Ring(kA=1.0, kP=0.5, skin=skin)
    shape = ld.core.soft_ring(1.0, angle, a, 1.0, 0.5, skin)
    x, y = ring.outline(0, 1.0, angle, a, inset=skin, points=4000).T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    # the polygon lacks R^2 (2 pi/4000)^2/6 of each unit of angle
    assert area == pytest.approx(shape.area, rel=2e-6)
    foot = ring.outline(0, 1.0, angle, a) @ np.array([1.0, 0.0])
    assert foot.max() == pytest.approx(0.97, abs=1e-12)


def test_sector_conserves_perimeter_or_area() -> None:
    assert ld.Sector() == ld.Sector(kA=1.0)
    assert ld.Sector()._kernel == "sector"
    assert ld.Sector(kP=3.0)._kernel == "area_sector"
    assert rows(ld.Sector(kP=3.0), [1.0]) == [[math.inf, 3.0, 0.0]]


def test_wrong_parameters_are_named() -> None:
    for law, wrong, shown in (
        (ld.Ring, {"kA": 0.0}, "not 0"),
        (ld.Ring, {"kA": [1.0, float("inf")]}, "kP .*both be inf"),
        (ld.Ring, {"skin": -0.5}, "not -0.5"),
        (ld.Ring, {"skin": float("inf")}, "not inf"),
        (ld.Ring, {"kA": "a"}, "'a'"),
        (ld.Ring, {"kP": [[1, 2], [3, 4]]}, r"\[\[1, 2\], \[3, 4\]\]"),
        (ld.Ring, {"reach": 3.001}, "3.001"),
        (ld.Ring, {"contact": "ring"}, "'ring'"),
        (ld.Ring, {"tension": -1.0, "kP": 1.0}, "not -1.*floppy"),
        (ld.Ring, {"kP": math.inf, "tension": 1.0}, "must be finite"),
        (ld.Sector, {"kA": float("inf")}, "kP .*both be inf"),
        (ld.Sector, {"kP": [1.0, 2.0]}, r"\[1.0, 2.0\]"),
    ):
        with refused(f"{next(iter(wrong))}.* {shown}"):
            law(**wrong)


def test_a_skin_is_thinner_than_its_particle() -> None:
    skins = ld.Ring(skin=[0.1, 0.7])
    assert rows(skins, [0.5, 0.71])[1] == [1.0, math.inf, 0.7]
    with pytest.raises(ld.ParameterError, match=r"skin .* radius 0\.7, not 0\.7"):
        skins.species_parameters([0.5, 0.7])


def test_droplets_and_bubbles() -> None:
    droplets = ld.Ring(kA=[math.inf, 1.0], kP=0.0, tension=[1.0, 0.1])
    assert droplets.species_parameters([0.5, 0.7]).tension.tolist() == [1.0, 0.1]
    with pytest.raises(ld.ParameterError, match=r"radius 0\.2 collapse"):
        droplets.species_parameters([0.5, 0.2])
    assert ld.Ring(tension=0.0) == ld.Ring()


MATRIX = [[0.1, 0.2, 0.1], [0.2, 0.1, 0.1], [0.1, 0.1, 0.2]]
DROP = {"kA": math.inf, "kP": 0.0, "contact": "curved", "adhesion": MATRIX}
THREE = {
    "ring": lambda n: ld.Ring(kA=[1.0, 5.0, 9.0][:n], kP=[0.1, 0.2, 0.3][:n]),
    "adhesion": lambda n: ld.Ring(
        **DROP | {"tension": (1.0, 2.0, 3.0)[:n], "adhesion": np.array(MATRIX)[:n, :n]}
    ),
    "droplet": lambda n: ld.Droplet([1.0, 2.0, 3.0][:n]),
    "smooth polygons": lambda n: ld.DeformablePolygon([20, 24, 30][:n], kL=[1.0, 2.0, 3.0][:n]),
}


@pytest.mark.parametrize("name", THREE)
@pytest.mark.parametrize("kinds", [[0], [1], [0, 1]])
def test_species_without_particles(name: str, kinds: list[int]) -> None:
    """The last ones too: energies are those of a law without them."""
    dimension = 3 if name == "droplet" else 2
    packing = ld.crystal("hex", (4, 4)) if dimension == 2 else ld.crystal("fcc", 2)
    packing = packing.replace(species=np.resize(kinds, len(packing)))
    energies = []
    for count in (3, max(kinds) + 1):
        with ld.Simulation(packing.at(1.05 * packing.phi), THREE[name](count)) as sim:
            energies.append(sim.state().energy)
    assert energies[0] == energies[1] != 0.0


def test_numbers_of_particles_are_not_those_of_species() -> None:
    packing = ld.bidisperse(20, seed=1)
    for law in (ld.Ring(np.ones(20)), ld.DeformablePolygon(kL=np.ones(20))):
        with pytest.raises(ld.ParameterError, match=r"has 20 numbers, as there are particles"):
            ld.Simulation(packing, law)
