"""Tables of the page of this study, of the committed measurements."""

import json
from pathlib import Path

from validation.droplet_shapes import __main__ as crystals
from validation.droplet_shapes import packings

FOLDER = Path(__file__).parents[2] / "validation" / "droplet_shapes"
PAGE = FOLDER / "README.md"
FOUND, PACKED = (
    json.loads((FOLDER / f"{name}.json").read_text()) for name in ("crystals", "packings")
)
CRYSTALS, PACKINGS = FOUND["rows"], PACKED["rows"]
STRAINED = crystals.strained_markdown(FOUND["unstrained"], FOUND["strained"])


TABLES = (
    crystals.markdown(CRYSTALS).splitlines,
    STRAINED.splitlines,
    packings.markdown(PACKINGS).splitlines,
)
PAGES = {PAGE: (TABLES, ())}
