"""README for PyPI, which knows no files of the repository: its links have whole addresses."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

# what has a relative address: pictures, and then links, of words or of a picture
RELATIVE = r"\((?!\w+:|#)([^)]+)\)"
PICTURE, LINK = re.compile(rf"(!\[[^\]]*\]){RELATIVE}"), re.compile(rf"(\]){RELATIVE}")


def with_addresses(text: str, repository: str) -> str:
    """Markdown with all relative links below the address of a repository."""
    if urlsplit(repository).netloc.endswith(".invalid"):  # not filled in yet
        return text
    text = PICTURE.sub(rf"\1({repository}/raw/HEAD/\2)", text)
    return LINK.sub(rf"\1({repository}/blob/HEAD/\2)", text)


def dynamic_metadata(settings: Mapping[str, Any], project: Mapping[str, Any]) -> dict[str, Any]:
    """README.md with the address of `[project.urls]`."""
    text = Path("README.md").read_text(encoding="utf-8")
    text = with_addresses(text, project["urls"]["Repository"])
    return {"readme": {"text": text, "content-type": "text/markdown"}}
