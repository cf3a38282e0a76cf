"""The compiled kernels on the site: docstrings from the module, arguments from core.pyi."""

import re
from typing import Any

import griffe


def parse(function: griffe.Function) -> list[griffe.DocstringSection]:
    """Sections of a docstring of nanobind, which begins with the signatures."""
    assert function.docstring is not None
    text = re.sub(rf"^{function.name}\(.*\n+", "", function.docstring.value, flags=re.MULTILINE)
    text, *source = re.split(r"^(?=Source: )", text, flags=re.MULTILINE)  # not of the last section
    sections = griffe.parse_numpy(griffe.Docstring(text, parent=function))
    for section in sections:
        if section.kind is griffe.DocstringSectionKind.parameters:
            for parameter in section.value:
                parameter.annotation = function.parameters[parameter.name].annotation
    return [*sections, *map(griffe.DocstringSectionText, source)]


class Kernels(griffe.Extension):
    """What griffe reads from `lammps_deformable.core`, with the arguments of its functions."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        if pkg.name != "lammps_deformable":
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
            if function.docstring:
                function.docstring.parsed = parse(function)
