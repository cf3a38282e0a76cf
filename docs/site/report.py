"""The report of the site: the committed page of `deformable report`, with the site around it."""

import re

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from pages import ROOT, repository_file

FOLDER = "docs/report"
HEADING = re.compile(r'<h2 id="([^"]*)">(.*?)</h2>')
FILES = re.compile(r'(?:src|href)="([^"#:]+)"')


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the report as a page: its headings become those of the site, for contents and search."""
    html = (ROOT / FOLDER / "index.html").read_text()
    title, lead = re.findall(r"<h1>(.*?)</h1>\s*(.*?)\s*<nav", html, re.DOTALL)[0]
    body = html[html.index("<main>") + len("<main>") : html.index("</main>")]
    text = f"# {title}\n\n{lead}\n\n" + HEADING.sub(r"\n\n## \2 {#\1}\n\n", body)
    page = File.generated(config, f"{FOLDER}/index.md", content=text)
    page.dest_uri = page.dest_uri.removeprefix("docs/")
    files.append(page)
    for name in sorted({"report.json", *FILES.findall(html)}):
        if f"{FOLDER}/{name}" not in files.src_uris:
            files.append(repository_file(config, f"{FOLDER}/{name}"))
    return files
