"""Pages whose tables and sentences follow from committed measurements, and logs.

    python -m validation.documented            # write them all
    python -m validation.documented melting    # those of a study, or of benchmarks

Each study has a module `documented` with `PAGES`: functions of tables, and of sentences.
"""

import importlib
import re
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

STUDIES = (
    *("benchmarks", "coarsening", "discharge", "disordered_crystals", "droplet_shapes"),
    *("emulsion_3d", "foam_or_particles", "jamming", "melting", "report", "surface_evolver"),
)
Lines = Callable[[], Iterable[str]]
Sentence = Callable[[], str]

NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


def _module(study: str) -> Any:
    return importlib.import_module(
        "benchmarks.documented" if study == "benchmarks" else f"validation.{study}.documented"
    )


def pages(study: str) -> dict[Path, tuple[tuple[Lines, ...], tuple[Sentence, ...]]]:
    """Tables and sentences of each page that the study writes into."""
    return dict(_module(study).PAGES)


def logs(study: str) -> dict[Path, Lines]:
    """Files that have nothing but lines of the study."""
    return dict(getattr(_module(study), "LOGS", {}))


def table_of(heads: list[str], rows: Iterable[list[str]]) -> list[str]:
    """Lines of a table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return ["|" + "|".join(f" {cell} " if cell else " " for cell in line) + "|" for line in lines]


def check(page: Path, tables: Iterable[Iterable[str]], sentences: Iterable[Sentence]) -> None:
    """Assert that the page has these tables, and these sentences on any lines."""
    text = page.read_text()
    words = " ".join(text.split())
    for table in tables:
        assert "\n".join(table) in text
    for sentence in sentences:
        assert sentence() in words


def write(page: Path, tables: Iterable[Iterable[str]], sentences: Iterable[Sentence]) -> None:
    """Replace tables, found by their first line, and sentences, found by all but their numbers."""
    text = page.read_text()
    for table in tables:
        rows = list(table)
        found = re.search(re.escape(rows[0]) + r"\n(\|.*\n)*", text)
        assert found, rows[0]
        text = text.replace(found[0], "\n".join(rows) + "\n")
    for sentence in sentences:
        words = map(re.escape, re.split(NUMBER, sentence()))
        found = re.search(NUMBER.join(words).replace(r"\ ", r"\s+"), text)
        assert found, sentence()
        if found[0].split() != sentence().split():
            text = text.replace(found[0], sentence())
    page.write_text(text)


if __name__ == "__main__":
    for study in sys.argv[1:] or STUDIES:
        for page, (tables, sentences) in pages(study).items():
            write(page, (table() for table in tables), sentences)
        for log, lines in logs(study).items():
            log.write_text("\n".join(lines()) + "\n")
