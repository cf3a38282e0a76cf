"""The table of the page of this study, of the committed measurements."""

import json
from pathlib import Path

from validation.surface_evolver import __main__ as judged

FOLDER = Path(__file__).parents[2] / "validation" / "surface_evolver"
PAGE = FOLDER / "README.md"
ROWS = json.loads((FOLDER / "surface_evolver.json").read_text())["rows"]
PAGES = {PAGE: ((judged.markdown(ROWS).splitlines,), ())}
