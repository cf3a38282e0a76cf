"""The tutorial runs from its first to its last cell, and shows what it speaks of."""

import re
from pathlib import Path

import nbclient
import nbformat
import pytest

NOTEBOOK = Path(__file__).parents[1] / "docs" / "tutorial.ipynb"


@pytest.fixture(scope="module")
def committed():
    return nbformat.read(NOTEBOOK, as_version=4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tutorial")


@pytest.fixture(scope="module")
def executed(committed, folder):
    """The notebook with its outputs; a cell that fails is an error here."""
    notebook = nbformat.from_dict(committed)
    nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": folder}}
    ).execute()
    return notebook


def outputs(notebook, kind):
    return [
        output["data"][kind]
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if kind in output.get("data", {})
    ]


def printed(notebook):
    return "".join(
        output["text"]
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if output.get("name") == "stdout"
    )


def test_it_is_committed_without_outputs(committed):
    """Outputs would be those of another version."""
    for cell in committed.cells:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


def test_no_cell_warns(executed):
    streams = [out for cell in executed.cells for out in cell.get("outputs", [])]
    assert [out["text"] for out in streams if out.get("name") == "stderr"] == []


def test_pictures_and_tables(executed):
    assert len(outputs(executed, "image/png")) == 4
    html = outputs(executed, "text/html")
    assert sum("<img src=" in text and "State: 64 particles" in text for text in html) == 3
    assert sum("<table" in text for text in html) == 1
    assert "<State: 64 particles" in "".join(outputs(executed, "text/plain"))


def test_what_it_says_is_so(executed, folder):
    text = printed(executed)
    rows = re.findall(r"^phi = (\S+)  pressure = (\S+)  z = (\S+)$", text, re.M)
    phi, pressure, z = ([float(row[n]) for row in rows] for n in range(3))
    assert len(rows) == 5
    assert phi == sorted(phi)
    assert pressure == sorted(pressure)
    assert 3.9 < z[0] < z[-1] < 6.0
    (ratio,) = re.findall(r"radical axes over balanced: (\S+)", text)
    assert float(ratio) > 1.1
    (modulus, last) = re.findall(r"shear modulus (\S+), pressure (\S+)$", text, re.M)[0]
    assert float(modulus) > float(last) > 0.0
    assert {"run.pvd", "run_0005.vtp", "outlines.geojson"} <= {p.name for p in folder.iterdir()}
