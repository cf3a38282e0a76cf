"""Messages of the LAMMPS styles on the site: errors and warnings of the source, to be searched."""

import re

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from pages import ROOT

HEAD = """# Messages of LAMMPS

All errors and warnings of the styles, in alphabetical order. `{}` stands for an ID, a name or a
value. Each message says what to do; the [questions](faq.md) have more of the frequent ones. Those
of Python are [errors and warnings](api/errors.md) of their own.
"""

CALL = re.compile(r"\b(?:error->(all|one|warning)|refuse)\(")
TEXT = re.compile(r'"((?:[^"\\]|\\.)*)"')


def arguments(text: str, begin: int) -> str:
    """What stands within the parentheses that open before this place."""
    depth, end, quoted = 1, begin, False
    while depth:
        letter = text[end]
        if letter == '"' and text[end - 1] != "\\":
            quoted = not quoted
        elif not quoted:
            depth += (letter == "(") - (letter == ")")
        end += 1
    return text[begin : end - 1]


def messages() -> dict[str, str]:
    """Texts, and whether each is an error or a warning."""
    found = {}
    for path in sorted((ROOT / "src").rglob("*.cpp")):
        source = path.read_text()
        for call in CALL.finditer(source):
            words = arguments(source, call.end())
            pieces = re.search(r'(?:"(?:[^"\\]|\\.)*"\s*)+', words)
            if pieces is None:
                continue
            text = "".join(TEXT.findall(pieces[0])).replace('\\"', '"')
            if len(text.split()) > 3:
                found[text] = "warning" if call[1] == "warning" else "error"
    return found


def on_files(files: Files, config: MkDocsConfig) -> Files:
    rows = [
        f"| `{text.replace('|', '&#124;')}` | {kind} |" for text, kind in sorted(messages().items())
    ]
    content = "\n".join([HEAD, "| message | |", "| --- | --- |", *rows, ""])
    page = File.generated(config, "docs/messages.md", content=content)
    page.dest_uri = page.dest_uri.removeprefix("docs/")
    files.append(page)
    return files
