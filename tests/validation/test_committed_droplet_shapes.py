"""What validation/droplet_shapes/README.md says follows from the committed measurements.

Run as a script, this writes the tables into the page.
"""

import json
from pathlib import Path

from committed_page import check, write

from validation.droplet_shapes import __main__ as crystals
from validation.droplet_shapes import packings

FOLDER = Path(__file__).parents[2] / "validation" / "droplet_shapes"
PAGE = FOLDER / "README.md"
FOUND, PACKED = (
    json.loads((FOLDER / f"{name}.json").read_text()) for name in ("crystals", "packings")
)
CRYSTALS, PACKINGS = FOUND["rows"], PACKED["rows"]
STRAINED = crystals.strained_markdown(FOUND["unstrained"], FOUND["strained"])


def tables() -> list[list[str]]:
    return [
        crystals.markdown(CRYSTALS).splitlines(),
        STRAINED.splitlines(),
        packings.markdown(PACKINGS).splitlines(),
    ]


def test_the_page_follows_from_the_measurements() -> None:
    check(PAGE, tables(), ())


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


if __name__ == "__main__":
    write(PAGE, tables(), {})
