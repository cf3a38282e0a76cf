"""Pages say what they have to say in so many words, and without history."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = (
    "",
    "docs",
    "docs/api",
    "docs/guide",
    "docs/theory",
    "benchmarks",
    "validation/*",
    "examples/*",
)
PAGES = sorted(path for folder in FOLDERS for path in ROOT.glob(f"{folder}/*.md".lstrip("/")))

# Words of a page at most; of those without a number, of the guide, and of all together.
BUDGETS = {
    "README.md": 800,
    "ARCHITECTURE.md": 1610,
    "benchmarks/README.md": 1780,
    "docs/theory/contacts.md": 1250,
    "docs/theory/droplets.md": 1475,
    "docs/theory/laws.md": 1140,
    "docs/theory/lines.md": 1055,
    "docs/pair_deformable_ring.md": 2025,
    "docs/pair_deformable_droplet.md": 1305,
    "docs/lammps_recipes.md": 1270,
    "docs/fix_deformable_wall.md": 1810,
    "docs/fix_deformable_friction.md": 1405,
    "docs/works_with.md": 1165,
}
USUAL, GUIDE, ALL = 990, 820, 60_000

# How the code came to be is in the git log. What nobody has read is no source.
BANNED = (
    *("busy machine", "busy day", "quiet day", "quiet hour", "of then", "older code"),
    *("older version", "cited from memory", "could read the abstract", "what it took"),
    *("as right as", "is worth some", "the code of the day", "would take two months"),
    *("and so on the processor", "all forces are computed in lammps", "neither of both"),
    *("no other degree of freedom", "have no such reference", "bend between particles of unequal"),
    *("both pair styles, the four fixes", "takes six minutes", "four seconds on one core"),
)


def name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_a_page_keeps_its_budget(page: Path) -> None:
    text = page.read_text()
    usual = GUIDE if name(page).startswith("docs/guide/") else USUAL
    assert len(text.split()) <= BUDGETS.get(name(page), usual)
    plain = " ".join(re.sub(r"```.*?```", "", text, flags=re.DOTALL).lower().split())
    assert [words for words in BANNED if words in plain] == []


def test_all_pages_together() -> None:
    assert sum(len(page.read_text().split()) for page in PAGES) <= ALL
    assert set(BUDGETS) <= set(map(name, PAGES))
