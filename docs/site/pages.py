"""Pages of the site: the files of the repository, with the links that they have on a code host.

Links are relative to the file that they stand in. MkDocs knows each file by its path in the
repository, so that they hold on the site too; only the address of a page is shorter. What MkDocs
does not know is translated: folders stand for their README.md, and some files for a page.
"""

import posixpath
import re
import sys
from collections.abc import Iterator
from importlib.metadata import files as distribution_files
from pathlib import Path
from urllib.parse import urlsplit

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
PAGES = (
    *(
        "*.md",
        "docs/*.md",
        "docs/guide/*.md",
        "docs/theory/*.md",
        "docs/api/*.md",
        "examples/*/README.md",
        "benchmarks/README.md",
    ),
    *("validation/README.md", "validation/*/README.md"),
)
ADDRESSES = {
    "README.md": "index.html",
    "docs/README.md": "contents/index.html",
    "CONTRIBUTING.md": "contributing/index.html",
    "ARCHITECTURE.md": "architecture/index.html",
    "CHANGELOG.md": "changes/index.html",
}
STANDS_FOR = {
    "validation/report": "validation/report/index.md",
    "docs/tutorial.ipynb": "docs/tutorial.md",
    "examples": "docs/cookbook.md",
}
ASSETS = {"docs/site/mathematics.js": "mathematics.js", "docs/site/style.css": "style.css"}
MATHJAX = "mathjax/static/mathjax/es5/"

# what an example consists of, in the order in which its page shows it
RECIPE = ("*.py", "in.*", "*.deformable")
LANGUAGES = {".py": "python", ".deformable": "text"}

# what a search shows first, and last
WEIGHTS = {
    "docs/faq.md": 1.5,
    "docs/howto_deformable.md": 2.0,
    "docs/units.md": 2.0,
    "docs/limits.md": 2.0,
    "docs/works_with.md": 2.0,
    "docs/api/kernels.md": 0.2,
    "docs/messages.md": 0.3,
    "validation/report/index.md": 0.3,
}
OF_COMMANDS = 2.0

LINK = re.compile(r"(\]\()([^)#\s]*)((?:#[^)]*)?\))")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def pages() -> list[str]:
    """Paths of all pages in the repository."""
    return sorted(
        path.relative_to(ROOT).as_posix() for pattern in PAGES for path in ROOT.glob(pattern)
    )


def target(page: str, link: str) -> str:
    """Path in the repository that a link of a page stands for."""
    path = posixpath.normpath(posixpath.join(posixpath.dirname(page), link))
    path = STANDS_FOR.get(path, path)
    return f"{path}/README.md" if (ROOT / path / "README.md").is_file() else path


def local_links(text: str) -> Iterator[str]:
    for _, link, _ in LINK.findall(FENCE.sub("", text)):
        if link and "://" not in link and not link.startswith("mailto:"):
            yield link


def linked_files(page: str, text: str) -> set[str]:
    """Files that a page links to or shows, other than pages."""
    found = {target(page, link) for link in local_links(text)}
    return {path for path in found if not path.endswith(".md") and (ROOT / path).is_file()}


def addresses() -> dict[str, str]:
    """Of repository and site, as far as the owner has filled them in."""
    urls = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["urls"]
    known = {name for name, url in urls.items() if not urlsplit(url).netloc.endswith(".invalid")}
    return {name: urls[name] for name in known}


def on_config(config: MkDocsConfig) -> None:
    """A link to the repository in the footer; `repo_url` would ask its host for numbers."""
    known = addresses()
    if "Documentation" in known:
        config.site_url = known["Documentation"].rstrip("/") + "/"
    if "Repository" in known:
        link = {"icon": "material/source-repository", "link": known["Repository"]}
        config.extra["social"] = [{**link, "name": "Repository"}]


def repository_file(config: MkDocsConfig, path: str, address: str | None = None) -> File:
    file = File(path, str(ROOT), config.site_dir, config.use_directory_urls)
    file.dest_uri = address or ADDRESSES.get(path) or file.dest_uri.removeprefix("docs/")
    return file


def mathjax(config: MkDocsConfig) -> Iterator[File]:
    """The script and the fonts of MathJax, from the package that ships them."""
    for source in distribution_files("django-static-mathjax") or []:
        name = source.as_posix().removeprefix(MATHJAX)
        if name == "tex-chtml.js" or name.endswith(".woff"):
            file = File.generated(
                config, f"assets/mathjax/{name}", abs_src_path=str(source.locate())
            )
            yield file


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Pages, what they link to, and assets, in the place of the files of the folder docs."""
    theme = [file for file in files if file.src_dir != config.docs_dir]
    texts = {page: (ROOT / page).read_text() for page in pages()}
    linked = set().union(*(linked_files(page, text) for page, text in texts.items()))
    return Files(
        [
            *theme,
            *(repository_file(config, path) for path in [*texts, *sorted(linked)]),
            *(repository_file(config, path, f"assets/{name}") for path, name in ASSETS.items()),
            *mathjax(config),
        ]
    )


def recipe(page: str) -> str:
    """The scripts of an example, for its page."""
    folder = (ROOT / page).parent
    text = ""
    for path in [path for pattern in RECIPE for path in sorted(folder.glob(pattern))]:
        language = LANGUAGES.get(path.suffix, "lammps")
        text += f"\n## {path.name}\n\n```{language}\n{path.read_text().rstrip()}\n```\n"
    return text


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    source = page.file.src_uri
    command = OF_COMMANDS if "_deformable_" in source else 1.0
    page.meta.setdefault("search", {"boost": WEIGHTS.get(source, command)})

    def translated(match: re.Match[str]) -> str:
        before, link, after = match.groups()
        if not link or "://" in link or link.startswith("mailto:"):
            return match[0]
        path = target(source, link)
        return before + posixpath.relpath(path, posixpath.dirname(source) or ".") + after

    text = LINK.sub(translated, markdown)
    return text + recipe(source) if source.startswith("examples/") else text
