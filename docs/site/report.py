"""The report of the site: a page from the committed measurements, `validation/report`."""

import json
import sys

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from pages import ROOT, repository_file

FOLDER = "validation/report"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the page, its pictures and report.json."""
    sys.path.insert(0, str(ROOT))
    from validation.report.page import page

    report = json.loads((ROOT / FOLDER / "report.json").read_text())
    files.append(File.generated(config, f"{FOLDER}/index.md", content=page(report)))
    for path in ("report.json", *(path.name for path in (ROOT / FOLDER).glob("*.png"))):
        if f"{FOLDER}/{path}" not in files.src_uris:
            files.append(repository_file(config, f"{FOLDER}/{path}"))
    return files
