"""README for PyPI, which knows no files of the repository: its links have whole addresses."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

# a picture's mark, the words, and a link that is relative
LINK = re.compile(r"(!?)(\[[^\]]*\])\((?!\w+:|#)([^)]+)\)")


def with_addresses(text: str, repository: str) -> str:
    """Markdown with all relative links below the address of a repository."""
    if urlsplit(repository).netloc.endswith(".invalid"):  # not filled in yet
        return text

    def whole(found: re.Match[str]) -> str:
        mark, words, path = found.groups()
        kind = "raw" if mark else "blob"
        return f"{mark}{words}({repository}/{kind}/HEAD/{path})"

    return LINK.sub(whole, text)


def dynamic_metadata(settings: Mapping[str, Any], project: Mapping[str, Any]) -> dict[str, Any]:
    """README.md with the address of `[project.urls]`."""
    text = Path("README.md").read_text(encoding="utf-8")
    text = with_addresses(text, project["urls"]["Repository"])
    return {"readme": {"text": text, "content-type": "text/markdown"}}
