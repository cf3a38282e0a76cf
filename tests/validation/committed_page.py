"""Pages of docs whose tables and sentences follow from committed measurements."""

import re
from collections.abc import Callable, Iterable
from pathlib import Path

NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


def check(
    page: Path, tables: Iterable[Iterable[str]], sentences: Iterable[Callable[[], str]]
) -> None:
    """Assert that the page has these tables, and these sentences on any lines."""
    text = page.read_text()
    words = " ".join(text.split())
    for table in tables:
        assert "\n".join(table) in text
    for sentence in sentences:
        assert sentence() in words


def write(
    page: Path, tables: Iterable[Iterable[str]], sentences: Iterable[Callable[[], str]]
) -> None:
    """Replace tables, found by their first line, and sentences, found by all but their numbers."""
    text = page.read_text()
    for table in tables:
        rows = list(table)
        old = re.compile(re.escape(rows[0]) + r"\n(\|.*\n)*")
        assert old.search(text), rows[0]
        text = old.sub(lambda _, rows=rows: "\n".join(rows) + "\n", text)
    for sentence in sentences:
        words = map(re.escape, re.split(NUMBER, sentence()))
        found = re.search(NUMBER.join(words).replace(r"\ ", r"\s+"), text)
        assert found, sentence()
        if found[0].split() != sentence().split():
            text = text.replace(found[0], sentence())
    page.write_text(text)
