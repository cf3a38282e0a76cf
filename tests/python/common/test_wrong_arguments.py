"""Each argument of each public call, wrong in turn: it is refused by name, or means something."""

import inspect
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
import pytest
from lammps_deformable.protocols.compression import Compress

WRONG: dict[str, Any] = {
    "None": None,
    "a word": "wrong",
    "nan": math.nan,
    "a list": [[1.0, 2.0, 3.0, 4.0, 5.0]],
    "a negative number": -1.0,
}

# What means something: a text, a folder, any objects, a strain the other way round, a coordinate.
MEANT = {
    "a word": {
        "folder",
        "items",
        "keep",
        "label",
        "record",
        "title",
        "values",
    },
    "a list": {"frequencies", "items", "source"},
    "a negative number": {
        *("Alignment.free", "Alignment.neighbors", "Alignment.velocity"),
        "Modes.plot.index",
        "frame",
        "inset",
        "shear_stress",
        "strain",
        "tilt",
        "vmin",
    },
}

# Results, which a user does not make, and methods that are those of a list.
LEFT_OUT = {
    *("Run.count", "Run.index", "Simulation.close", "State"),
    *(f"Protocol.{of_users}" for of_users in ("begin", "check", "go", "step")),
    *(
        f"Hessian.{of_solvers}"
        for of_solvers in ("factored", "line_response", "project", "response")
    ),
}
RESULTS = {"Derivatives", "Hessian", "Modes", "Table"}
RESULTS_WITHOUT_ARGUMENTS = {
    *("Cells", "Comparison", "DynamicModulus", "ElasticModuli", "Evolved"),
    *("Iteration", "LocalStrain", "SecondaryOutlines"),
}

# Calls that take seconds, or load a library that does.
SLOW = {"compare", "Run.movie", "State.graph", "State.to_pandas"}

PACKING = ld.crystal("hex", (2, 2), phi=0.93)
LOOSE = ld.bidisperse(4, seed=1)


def public() -> Iterator[str]:
    """Names of functions, classes and methods, such as `Run.msd`."""
    for name in vars(ld)["__all__"]:
        found = getattr(ld, name)
        if name in RESULTS_WITHOUT_ARGUMENTS:
            continue
        if isinstance(found, type) and not issubclass(found, Exception):
            if name not in RESULTS:
                yield name
            for method in dir(found):
                static = inspect.getattr_static(found, method)
                plain = inspect.isfunction(static) or isinstance(static, classmethod | staticmethod)
                if plain and not method.startswith("_"):
                    yield f"{name}.{method}"
        elif inspect.isfunction(found):
            yield name


class Calls:
    """One object of each class that has methods, and what its calls need."""

    def __init__(self, folder: Path) -> None:
        sim = ld.Simulation(PACKING, ld.Ring())
        sim.relax().save(folder / "state")
        run = sim.compress(strain=1e-3, steps=2, record=folder / "run")
        PACKING.export(folder / "packing.xyz")
        self.folder, self.written = folder, 0
        self.objects = {
            "DeformablePolygon": ld.DeformablePolygon(),
            "Droplet": ld.Droplet(),
            "Derivatives": run[0].derivatives("radii"),
            "Hessian": run[0].hessian(),
            "Modes": run[0].modes(),
            "Packing": PACKING,
            "Ring": ld.Ring(contact="curved"),
            "Run": run,
            "Run.complex_modulus": sim.oscillate(1e-3, period=0.1, steps=8, cycles=3, drag=1.0),
            "Sector": ld.Sector(),
            "Simulation": sim,
            "State": run[0],
            "Table": run.table(),
        }
        self.valid: dict[str, Any] = {
            "a": [0, 0], "amplitude": 1e-3, "angle": 0.5, "axis": [0, 0, 1], "b": [1, 0],
            "before": run[0], "bins": 2, "by": "radii", "box": PACKING.box, "cells": 2,
            "corners": [[0, 0], [1, 0], [0, 1]], "division": 2.0, "f": len, "folder": "run",
            "frequencies": [1.0], "indentation": [0.01, 0.01], "items": ["a"],
            "k": [[2.0 * math.pi / PACKING.box[0, 0], 0.0]],
            "k_max": 5.0, "kt": 1.0, "lattice": "hex", "law": ld.Ring(), "lengths": [3, 3],
            "mu": 0.1, "normal": [1, 0], "number": 4, "nx": 1, "ny": 1, "origin": [0, 0],
            "packing": PACKING, "period": 0.1, "permeability": 1e-6, "phi": 0.95,
            "protocol": Compress(strain=1e-3),
            "positions": [[1, 1]], "r_max": 0.9, "radii": [0.5], "radius": 0.5, "rate": 1e-3,
            "shear_stress": 1e-4, "source": folder / "run", "start": PACKING, "steps": 1,
            "strain": 1e-3, "time": 0.01, "tip": [0, 0, 0], "values": [1.0, 2.0],
            "walls": ld.Segment((-9, -9), (-9, -8)),
        }  # fmt: skip
        # Of single calls: what has another meaning, or is not needed by the signature but is.
        outline = {"angle": [0.5, 2.0], "species": 1}
        curved = {name: [0.1, 0.1] for name in ("force", "half_angle")}
        self.special: dict[str, dict[str, Any]] = {
            "Alignment": {"neighbors": 1.0},
            "DeformablePolygon.polygons": {"radii": PACKING.radii},
            "Ring.outline": outline | curved,
            "Run.export": {"path": ".pvd"},
            "Run.movie": {"path": ".gif"},
            "Sector.outline": outline,
            "Simulation.compress": {"strain": 1e-3},
            "Simulation.creep": {"drag": 1.0},
            "Simulation.grow": {"phi": 0.935},
            "Simulation.oscillate": {"drag": 1.0, "steps": 8},
            "Simulation.run": {"temperature": 1e-9},
            "State.export": {"path": ".vtp"},
            "State.from_file": {
                "path": "run/trajectory.lammpstrj",
                "species": "run/species.deformable",
            },
            "Derivatives.jacobian": {"quantity": "pressure"},
            "Derivatives.jvp": {"radii": np.zeros(len(PACKING))},
            "Derivatives.vjp": {"pressure": 1.0},
            "Hessian.solve": {"forces": np.zeros(PACKING.positions.size)},
            "Packing.from_file": {"path": "packing.xyz"},
            "Packing.export": {"path": ".xyz"},
            "compare": {"vertices": [20], "workers": 1},
            "jackknife": {"f": len},
            "jam": {"packing": LOOSE},
            "parallel_map": {"workers": 1},
            "polydisperse": {"radii": [0.5] * 4},
        }

    def find(self, name: str) -> Any:
        """What this name calls."""
        owner, _, method = name.partition(".")
        found = getattr(ld, owner)
        if not method:
            return found
        return getattr(self.objects.get(name, self.objects.get(owner, found)), method)

    def arguments(self, name: str) -> dict[str, Any]:
        """What is right for this call, with a path where nothing is yet."""
        needed = [
            each.name
            for each in inspect.signature(self.find(name)).parameters.values()
            if each.default is each.empty and each.kind is not each.VAR_KEYWORD
        ]
        special = dict(self.special.get(name, {}))
        if special.get("path", "").startswith("."):
            self.written += 1
            special["path"] = f"{self.written}{special['path']}"
        if "folder" in needed and name != "Run.exists":
            self.written += 1
            special["folder"] = f"saved{self.written}"
        return {each: self.valid[each] for each in needed if each not in special} | special

    def __call__(self, name: str, given: dict[str, Any]) -> None:
        """Make the call, beginning with the same packing."""
        if name.startswith("Simulation."):
            self.objects["Simulation"].reset(PACKING)
        made = self.find(name)(**given)
        if isinstance(made, ld.Simulation):
            made.close()
        plt.close("all")


@pytest.fixture(scope="module")
def calls(tmp_path_factory: pytest.TempPathFactory) -> Calls:
    return Calls(tmp_path_factory.mktemp("calls"))


def told(error: ld.DeformableError, parameter: str, value: Any) -> bool:
    """Whether an error names the parameter, or one of several such as a wall, or a file."""
    line = str(error)
    named = parameter in line or parameter.removesuffix("s") in line.split()
    named |= parameter in ("path", "source", "types") and repr(value) in line
    return named and "\n" not in line


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else [])
        for name in sorted(set(public()) - LEFT_OUT)
    ],
)
def test_wrong_arguments(name: str, calls: Calls, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(calls.folder)
    calls(name, calls.arguments(name))
    failures = []
    for parameter in inspect.signature(calls.find(name)).parameters.values():
        if parameter.kind is parameter.VAR_KEYWORD:
            continue
        for kind, value in WRONG.items():
            if repr(value) == repr(parameter.default):
                continue
            given = calls.arguments(name) | {parameter.name: value}
            try:
                calls(name, given)
                if MEANT.get(kind, set()) & {parameter.name, f"{name}.{parameter.name}"}:
                    continue
                found = "is accepted"
            except ld.DeformableError as error:
                if told(error, parameter.name, value):
                    continue
                found = f"is not named: {error}"
            except Exception as error:
                found = repr(error)
            failures.append(f"{parameter.name} = {value!r} {found}")
    assert not failures, "\n".join(failures)
