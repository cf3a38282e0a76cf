"""What validation/droplet_shapes/README.md says follows from the committed measurements."""

from validation.droplet_shapes import clusters, packings
from validation.droplet_shapes.documented import CLUSTERS, PACKINGS

# Largest errors of energy, pressure and a force over the mean one: below a load of 0.1, beyond, and
# of two that the page names.
SMALL, LARGE = (0.001, 0.002, 0.011), (0.011, 0.02, 0.06)
OTHERS = {
    "1 : 1 at 0.74": (0.0036, 0.006, 0.018),
    "1 : 1 at 0.74, with a soft mode": (0.0014, 0.002, None),
}


def test_errors_of_packings_are_those_of_the_page() -> None:
    """As far as the exact ones are known: to twice what their extrapolation is uncertain by."""
    for row in PACKINGS:
        assert row["case"] in map(str, packings.CASES)
        bounds = OTHERS.get(row["case"], SMALL if row["load"] < 0.1 else LARGE)
        for name, most in zip(("energy", "pressure"), bounds[:2], strict=True):
            exact, error = row[f"exact {name}"], row[f"error of the exact {name}"]
            assert abs(row[name] / exact - 1.0) - 2.0 * error / exact < most, row["case"]
        if bounds[2]:
            assert row["softest mode"] > packings.SOFTEST
            largest = row["largest error of a force over the mean"]
            off = largest - 2.0 * row["error of the exact forces over the mean"]
            assert off < bounds[2], row["case"]
        else:
            assert row["softest mode"] < 1e-6


# Of energies, and of positions over R. A pulled octahedron has the largest.
MOST = {
    clusters.REST: (0.001, 0.01),
    clusters.CENTERS: (0.01, 0.01),
    clusters.VOLUMES: (0.037, 0.02),
}


def test_errors_of_clusters_are_those_of_the_pages() -> None:
    """At rest, where forces act on the centers of spheres, and where they act on volumes."""
    names = [row["case"] for row in CLUSTERS]
    assert names == [name for name in map(str, clusters.CASES) if name in names]
    for row in CLUSTERS:
        assert row["cover"] < 0.5
        most = MOST[row["case"].split(", ")[-1]]
        for key, bound in zip(("energy", "position"), most, strict=True):
            assert clusters.error(row, key) < bound, row["case"]
        assert clusters.error(row, "force") < 0.01
        assert row["error of the exact energy"] < 0.005 * abs(row["exact energy"])
        pulled = not row["case"].endswith(clusters.REST)
        assert row["pull over the largest"] > (0.45 if pulled else -0.1)
