"""Name, version and addresses are said once, and what is published takes them from there."""

import importlib
import json
import re
import sys
from pathlib import Path

import jinja2
import pytest
import yaml

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
RECIPE = ROOT / "packaging" / "conda" / "meta.yaml"
TEXTS = "*.md", "*.yml", "*.yaml", "*.toml", "*.cff", "*.ipynb", "Dockerfile"


def test_addresses_have_one_home() -> None:
    assert set(PROJECT["urls"]) == {"Repository", "Documentation"}
    folders = "", "docs/**", "examples/**", "packaging/**", "validation/**", ".github/**"
    files = {
        path
        for folder in folders
        for end in TEXTS
        for path in ROOT.glob(f"{folder}/{end}".lstrip("/"))
    }
    found = {
        path.relative_to(ROOT).as_posix()
        for path in files
        if any(url in path.read_text() for url in PROJECT["urls"].values())
    }
    assert found == {"pyproject.toml"}


def test_the_site_takes_them(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No page shows an address that is not filled in; one that is becomes a link."""
    config_of = pytest.importorskip("mkdocs.config.defaults").MkDocsConfig
    monkeypatch.syspath_prepend(ROOT / "docs" / "site")
    pages = importlib.import_module("pages")
    monkeypatch.setattr(pages, "ROOT", tmp_path)
    for host, filled_in in (("a.invalid", False), ("example.org", True)):
        urls = f'Repository = "https://{host}/r"\nDocumentation = "https://{host}/d"\n'
        (tmp_path / "pyproject.toml").write_text(f"[project.urls]\n{urls}")
        config = config_of()
        config.extra = {}
        pages.on_config(config)
        assert config.site_url == ("https://example.org/d/" if filled_in else None)
        assert [link["link"] for link in config.extra.get("social", [])] == (
            ["https://example.org/r"] if filled_in else []
        )


def test_pictures_of_the_readme_have_addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    """PyPI shows README without the files beside it."""
    monkeypatch.syspath_prepend(ROOT / "cmake")
    readme = importlib.import_module("readme")
    text = (ROOT / "README.md").read_text()
    relative = re.findall(r"(!?)\[[^\]]*\]\((?!https?:)([^)]+)\)", text)
    assert len(relative) > 20
    assert readme.with_addresses(text, "https://repository.invalid/r") == text
    found = readme.with_addresses(text, "https://example.org/r")
    for mark, path in relative:
        assert (ROOT / path.partition("#")[0]).exists()
        assert f"](https://example.org/r/{'raw' if mark else 'blob'}/HEAD/{path})" in found
    assert re.findall(r"\]\((?!https?:)[^)]+\)", found) == []
    assert "(https://www.lammps.org)" in found
    at = "https://example.org/r"
    badge = readme.with_addresses("[![tests](a.svg)](docs/b.md)", at)
    assert badge == f"[![tests]({at}/raw/HEAD/a.svg)]({at}/blob/HEAD/docs/b.md)"


def recipe() -> dict:
    """The recipe as conda's tools read it, for Linux."""

    def load_file_data(name: str, from_recipe_dir: bool, recipe_dir: str) -> dict:
        assert from_recipe_dir
        return tomllib.loads((Path(recipe_dir) / name).read_text())

    text = jinja2.Environment(undefined=jinja2.StrictUndefined).from_string(RECIPE.read_text())
    return yaml.safe_load(
        text.render(
            load_file_data=load_file_data,
            RECIPE_DIR=str(RECIPE.parent),
            compiler=lambda language: f"compiler of {language}",
            stdlib=lambda language: f"library of {language}",
            pin_compatible=lambda name, exact: f"{name} of the host",
        )
    )


def test_the_recipe_of_conda() -> None:
    """It builds what install.md describes, and its test is an example with its files."""
    found = recipe()
    assert found["package"] == {"name": PROJECT["name"], "version": PROJECT["version"]}
    about = found["about"]
    assert about["license"] == PROJECT["license"]
    assert [about["home"], about["doc_url"]] == [*PROJECT["urls"].values()]
    assert (ROOT / about["license_file"]).is_file()
    assert (RECIPE.parent / found["source"]["path"]).resolve() == ROOT
    assert "lammps of the host" in found["requirements"]["run"]
    script, page = "\n".join(found["build"]["script"]), (ROOT / "docs" / "install.md").read_text()
    for option in re.findall(r"-D (\w+)=", script):
        assert option in page or option.startswith("CMAKE_INSTALL"), option
    assert found["test"]["commands"][0].endswith("lib/lammps/plugins/deformableplugin.so")
    (folder,) = found["test"]["source_files"]
    assert f"cd {folder} && " in found["test"]["commands"][1]
    assert (ROOT / folder / "in.hexagon").is_file()


def test_versions_agree() -> None:
    version = PROJECT["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"version = {{{version}}}" in (ROOT / "docs" / "citing.md").read_text()
    assert f"\n| {version} | " in (ROOT / "docs" / "install.md").read_text()
    assert f"\n## {version} - " in (ROOT / "CHANGELOG.md").read_text()


def test_the_notebook_installs_this_package() -> None:
    """With parts that exist, before its first import."""
    cells = json.loads((ROOT / "docs" / "tutorial.ipynb").read_text())["cells"]
    first = "".join(next(cell for cell in cells if cell["cell_type"] == "code")["source"])
    ((name, extras),) = re.findall(r'%pip install --quiet "([\w-]+)\[(.*)\]"', first)
    assert name == PROJECT["name"]
    assert set(extras.split(",")) <= set(PROJECT["optional-dependencies"])
