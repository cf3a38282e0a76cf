"""Tables of the page of this study, of the committed foams, and its log."""

import json
from pathlib import Path

from validation.coarsening import __main__ as coarsening
from validation.coarsening import angles

FOLDER = Path(__file__).parent
FOAMS = json.loads((FOLDER / "coarsening_256.json").read_text())
STICKING = json.loads((FOLDER / "angles.json").read_text())


def table() -> list[str]:
    return list(coarsening.lines(FOAMS))


PAGES = {FOLDER / "README.md": ((table, lambda: angles.lines(STICKING)), ())}
LOGS = {FOLDER / "coarsening_256.log": table}
