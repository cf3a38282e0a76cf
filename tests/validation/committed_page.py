"""Pages of docs whose tables and sentences follow from committed measurements."""

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path


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
    page: Path, tables: Iterable[Iterable[str]], sentences: Mapping[Callable[[], str], str]
) -> None:
    """Replace tables, found by their first line, and sentences, found by their patterns."""
    text = page.read_text()
    for table in tables:
        rows = list(table)
        old = re.compile(re.escape(rows[0]) + r"\n(\|.*\n)*")
        assert old.search(text), rows[0]
        text = old.sub(lambda _, rows=rows: "\n".join(rows) + "\n", text)
    for sentence, pattern in sentences.items():
        found = re.search(pattern.replace(" ", r"\s+"), text, re.DOTALL)
        assert found, pattern
        text = text.replace(found[0], sentence())
    page.write_text(text)
