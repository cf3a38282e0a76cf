"""Tables and sentences about exact shapes of droplets, of the committed measurements."""

import json
import statistics
from pathlib import Path

from validation.droplet_shapes import __main__ as crystals
from validation.droplet_shapes import clusters, packings

FOLDER = Path(__file__).parents[2] / "validation" / "droplet_shapes"
PAGE, THEORY = FOLDER / "README.md", FOLDER.parents[1] / "docs" / "theory" / "droplets.md"
FOUND, PACKED, STUCK = (
    json.loads((FOLDER / f"{name}.json").read_text())
    for name in ("crystals", "packings", "clusters")
)
CRYSTALS, PACKINGS, CLUSTERS = FOUND["rows"], PACKED["rows"], STUCK["rows"]
STRAINED = crystals.strained_markdown(FOUND["unstrained"], FOUND["strained"])


def worst(key: str, weight: bool = False) -> float:
    """Of clusters, per cent."""
    rows = [row for row in CLUSTERS if row["case"].endswith(clusters.VOLUMES) == weight]
    return 100.0 * max(clusters.error(row, key) for row in rows)


def of_clusters() -> str:
    return (
        f"energies are off by {worst('energy'):.2f} % at most, positions by "
        f"{worst('position'):.2f} % of R."
    )


def of_weights() -> str:
    return f"changes energies of such clusters by up to {worst('energy', True):.1f} % at θ = 0.5."


def of_packings() -> str:
    errors = [100.0 * abs(row["energy"] / row["exact energy"] - 1.0) for row in PACKINGS]
    return (
        f"In 3D, energies of {len(errors)} packings of `Droplet`, to phi = 0.85, are "
        f"off by {statistics.median(errors):.2f} % in the median and {max(errors):.1f} % at most"
    )


TABLES = (
    crystals.markdown(CRYSTALS[1::2]).splitlines,
    STRAINED.splitlines,
    packings.markdown(PACKINGS).splitlines,
    clusters.markdown(CLUSTERS).splitlines,
)
PAGES = {
    PAGE: (TABLES, ()),
    THEORY: ((), (of_clusters, of_weights)),
    FOLDER.parents[1] / "README.md": ((), (of_packings,)),
}
