"""Scripts of the examples as modules."""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def example(folder: str, name: str) -> ModuleType:
    """The script of a folder of examples; it finds the other scripts there, as when it runs."""
    path = EXAMPLES / folder / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"example_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    for other in path.parent.glob("*.py"):  # another folder may have scripts of the same names
        sys.modules.pop(other.stem, None)
    sys.path.insert(0, str(path.parent))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(path.parent))
    return module


def quick(module: ModuleType, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """What an example measures in its quick size, in this process."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(module.plt.Figure, "savefig", lambda figure, file, **_: None)
    monkeypatch.setattr(
        module.ld, "parallel_map", lambda f, items, **_: [f(item) for item in items]
    )
    module.main(True)
    (file,) = folder.glob("*.json")
    return json.loads(file.read_text())


def committed(name: str, module: ModuleType, capsys: pytest.CaptureFixture[str]) -> Any:
    """The measurements of an example, whose log is what its script shows of them."""
    folder = Path(str(module.__file__)).parent
    data = json.loads((folder / f"{name}.json").read_text())
    module.show(data)
    assert capsys.readouterr().out == (folder / f"{name}.log").read_text()
    return data
