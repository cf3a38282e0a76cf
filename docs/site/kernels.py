"""The compiled kernels on the site: docstrings from the module, signatures from core.pyi."""

import re
from typing import Any

import griffe


class Kernels(griffe.Extension):
    """What griffe reads from `deformable.core`, with the arguments of its functions."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        if pkg.name != "deformable":
            return
        core = pkg["core"]
        stub = core.filepath.parent / "core.pyi"
        typed = griffe.visit("core", filepath=stub, code=stub.read_text())
        for name, function in core.functions.items():
            declared = [typed[name]] if name in typed.functions else typed.overloads.get(name, [])
            if declared:
                function.overloads = None
                function.parameters = declared[-1].parameters
                function.returns = declared[-1].returns
            if function.docstring:  # nanobind's begins with the signatures
                text = re.sub(rf"^{name}\(.*\n+", "", function.docstring.value, flags=re.M)
                function.docstring.value = text
                function.docstring.parser = griffe.Parser.numpy
