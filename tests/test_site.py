"""The site builds without a warning, its links have targets, and it names all that is public."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import threading
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote, urlsplit

import lammps_deformable as ld
import pytest
from lammps_deformable import core
from programs import output

ROOT = Path(__file__).parents[1]
API = sorted((ROOT / "docs" / "api").glob("*.md"))

needs_mkdocs = pytest.mark.skipif(
    importlib.util.find_spec("mkdocs") is None, reason="mkdocs is not installed (make docs)"
)


class Links(HTMLParser):
    """What a page refers to: what it shows and runs, and where its links go."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.leads: list[str] = []
        self.anchors: set[str] = set()
        self.feed(page.read_text())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value for name, value in attrs if value}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a":
            self.leads += [values[name] for name in ("href",) if name in values]
        else:
            self.loads += [values[name] for name in ("href", "src") if name in values]


def build(folder: Path, execute: bool) -> Path:
    site = folder / "site"
    result = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", site],
        cwd=ROOT,
        env=os.environ
        | {"NO_MKDOCS_2_WARNING": "1", "DEFORMABLE_DOCS_EXECUTE": str(execute).lower()},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert result.returncode == 0, result.stderr
    assert "WARNING" not in result.stderr
    return site


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return build(tmp_path_factory.mktemp("site"), execute=False)


def broken(site: Path) -> set[tuple[str, str]]:
    """Links of the site to files or places that do not exist, and what comes from elsewhere."""
    pages = {page: Links(page) for page in site.rglob("*.html") if page.name != "404.html"}
    found = set()
    for page, links in pages.items():
        for link in [*links.loads, *links.leads]:
            url = urlsplit(link)
            if url.scheme == "data" or (url.netloc and link in links.leads):
                continue
            target = (page.parent / unquote(url.path)).resolve() if url.path else page
            target = target / "index.html" if target.is_dir() else target
            missing = url.netloc or not target.is_file()
            if not missing and url.fragment and target in pages:
                missing = unquote(url.fragment) not in pages[target].anchors
            if missing:
                found.add((str(page.relative_to(site)), link))
    return found


@needs_mkdocs
def test_no_link_is_broken(site):
    """Of links, pictures, scripts and styles; no page loads anything from the net."""
    assert broken(site) == set()
    assert len(list(site.rglob("*.html"))) > 40
    assert (site / "assets" / "mathjax" / "tex-chtml.js").stat().st_size > 1_000_000
    assert len(list(site.glob("assets/mathjax/output/chtml/fonts/woff-v2/*.woff"))) > 20


@needs_mkdocs
def test_a_broken_link_is_seen(tmp_path):
    lines = (
        '<a href="../nowhere/">',
        '<a href="../theory/#nothing">',
        '<img src="no.png">',
        '<script src="https://example.org/a.js">',
    )
    for page in ("theory", "jamming"):
        (tmp_path / page).mkdir()
    (tmp_path / "theory" / "index.html").write_text('<h2 id="ring">Ring</h2>')
    for line in lines:
        (tmp_path / "jamming" / "index.html").write_text(f'<a href="../theory/#ring">{line}')
        assert [page for page, _ in broken(tmp_path)] == ["jamming/index.html"]


@needs_mkdocs
def test_pages_show_what_they_should(site):
    theory = (site / "theory" / "laws" / "index.html").read_text()
    blocks = (ROOT / "docs" / "theory" / "laws.md").read_text().count("```math")
    assert theory.count('<div class="arithmatex">') == blocks > 10
    assert (
        'id="error-against-run-time"' in (site / "validation" / "report" / "index.html").read_text()
    )
    assert "in.hopper" in (site / "examples" / "hopper" / "index.html").read_text()
    assert "--polydispersity" in (site / "shell" / "index.html").read_text()
    assert "bidisperse" in (site / "tutorial" / "index.html").read_text()


def test_the_api_has_every_public_name_once():
    kernels = {f"core.{name}" for name in dir(core) if not name.startswith("_")}
    constants = {
        "core.version",
        "core.lammps_version",
        "core.lammps_wheel",
        "core.largest_bulge",
        "core.droplet_decay",
        "core.green_at_zero",
        "core.largest_tilt",
        "core.largest_half_angle",
    }
    results = {
        "Simulation.coarsen",
        "Simulation.compress",
        "Simulation.creep",
        "Simulation.grow",
        "Simulation.oscillate",
        "Simulation.play",
        "Simulation.proliferate",
        "Simulation.run",
        "Simulation.shear",
        "pictures.drawing.Scale",
        "pictures.drawing.scale",
    }
    text = "\n".join(page.read_text() for page in API)
    names = re.findall(r"^::: lammps_deformable\.(\S+)$", text, re.MULTILINE)
    assert len(names) == len(set(names))
    assert set(names) == set(ld.__all__) | (kernels - constants) | results
    contents = (ROOT / "docs" / "api" / "README.md").read_text()
    assert [name for name in ld.__all__ if f"`{name}`" not in contents] == []


def test_examples_of_the_api_run(tmp_path):
    """Each page and `start.md` by itself; in one process, which imports only once."""
    pages = [*API, ROOT / "docs" / "start.md"]
    codes = {
        page.stem: re.findall(r"```python\n(.*?)```", page.read_text(), re.S) for page in pages
    }
    assert codes.pop("README") == []
    assert [name for name, code in codes.items() if not code] == []
    for name, code in codes.items():
        (tmp_path / f"{name}.py").write_text("\n".join(code))
    one_by_one = f"[run_path(f'{{name}}.py', run_name='__main__') for name in {[*codes]}]"
    run = f"from runpy import run_path; {one_by_one}"
    said = output("python", "-c", run, cwd=tmp_path, MPLBACKEND="agg")
    assert "fraction_large must lie between 0 and 1, not 1.5" in said
    written = {path.name for path in tmp_path.iterdir()}
    assert {"packing.png", "state.png", "state.vtp", "run.gif", "run.pvd", "run"} <= written


@pytest.fixture
def page():
    playwright = pytest.importorskip("playwright.sync_api")
    path = shutil.which("chromium")
    if path is None:
        pytest.skip("Chromium is not installed: apt install chromium")
    with playwright.sync_playwright() as engine:
        opened = engine.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = opened.new_page()
        page.set_default_timeout(120_000)  # of a busy machine
        yield page
        opened.close()


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """The whole site, with the outputs of the tutorial, as a server shows it."""
    site = build(tmp_path_factory.mktemp("whole"), execute=True)

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=site)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def paths(address: str, page) -> list[str]:
    """All pages that the navigation of the first one leads to."""
    page.goto(address)
    links = page.eval_on_selector_all(".md-nav--primary a", "all => all.map(a => a.href)")
    return sorted({link.split("#")[0] for link in links})


@needs_mkdocs
@pytest.mark.slow
def test_in_a_browser(page, address):
    """On all pages mathematics is drawn and fits, pictures are there, and nothing comes from
    elsewhere."""
    page.set_viewport_size({"width": 1300, "height": 900})
    wrong: list[str] = []
    page.on("console", lambda told: wrong.append(told.text) if told.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on(
        "request",
        lambda request: (
            None if request.url.startswith((address, "data:")) else wrong.append(request.url)
        ),
    )
    formulas = pictures = 0
    found = paths(address, page)
    assert len(found) > 40
    for path in found:
        page.goto(path, wait_until="networkidle")
        page.wait_for_function("!window.MathJax?.startup?.promise || MathJax.startup.promise")
        drawn = page.evaluate(
            """() => ({
                blank: [...document.querySelectorAll(".arithmatex")]
                    .filter(block => !block.querySelector("mjx-container")).length,
                wide: [...document.querySelectorAll(".arithmatex")]
                    .filter(block => block.scrollWidth > block.clientWidth + 1).length,
                errors: document.querySelectorAll("mjx-merror").length,
                formulas: document.querySelectorAll("mjx-container").length,
                missing: [...document.images].filter(image => !image.naturalWidth).length,
                pictures: document.images.length,
            })"""
        )
        assert [drawn[name] for name in ("blank", "wide", "errors", "missing")] == [0] * 4, path
        formulas += drawn["formulas"]
        pictures += drawn["pictures"]
    assert wrong == []
    sources = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("validation/*/README.md")]
    assert formulas == sum(source.read_text().count("```math") for source in sources) > 40
    assert pictures > 30


@needs_mkdocs
@pytest.mark.slow
def test_search_in_a_browser(page, address):
    """Words and questions of LAMMPS and Python users lead to their pages, among the first five."""
    page.goto(address)
    for word, place in (
        ("Steiner point", "/theory/laws/"),
        ("maxeval", "/pair_deformable_ring/"),
        ("push_off", "/api/packings/"),
        ("hopper", "/examples/hopper/"),
        ("which units", "/units/"),
        ("time step", "/units/"),
        ("restart friction springs", "/fix_deformable_friction/"),
        ("shear or compress", "/faq/"),
        ("dump contact forces", "/faq/"),
        ("radius of each particle", "/faq/"),
        ("osmotic pressure emulsion", "/validation/emulsion_3d/"),
        ("silo discharge", "/validation/discharge/"),
        ("install without compiler", "/install/"),
        ("GPU", "/comparison/"),
        ("yield stress flow curve", "/examples/flow_curve/"),
        ("error bulges by reach", "/pair_deformable_ring/"),
        ("OVITO ParaView", "/faq/"),
    ):
        page.fill(".md-search__input", "")
        page.click(".md-search__input")
        page.type(".md-search__input", word)
        first = ".md-search-result__item:nth-child(-n+5)"
        page.wait_for_selector(f'{first} > .md-search-result__link[href*="{place}"]')
