"""The settings of `deformable compress` and `deformable shear`: packing, law, protocol of a run."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import typer

from ..common.errors import ParameterError
from ..common.validate import positive
from ..model.laws import LAWS, Law, Ring
from ..model.packing import Packing
from ..model.random_packing import bidisperse, polydisperse
from ..runs.run import Run
from .options import is_given

TARGETS = ("strain", "phi", "pressure")
PROTOCOL = (*TARGETS, "steps", "tolerance")

# Settings of a packing from a random start, and of one in a file.
_RANDOM = ("number", "radii", "fraction", "polydispersity", "aspect", "tilt", "seed")
FILE = ("from_file", "from_radii", "from_frame")

M = TypeVar("M", bound="Material")

# Strain of a compression that has no target.
_STRAIN = 0.01


@dataclass(frozen=True)
class InFile:
    """A packing in a file, if any, by the names of the options."""

    from_file: str | None
    from_radii: str | None
    from_frame: int

    def packing_in_file(self) -> Packing:
        """The packing in a file, which is not jammed."""
        word = self.from_radii or ""
        radii: Any = None
        if "=" in word:
            pairs = (pair.partition("=") for pair in word.split(","))
            radii = {kind: _number(radius) for kind, _, radius in pairs}
        elif word:
            radii = _number(word)
        return Packing.from_file(str(self.from_file), radii, self.from_frame)


@dataclass(frozen=True)
class Material(InFile):
    """A packing in a file, if any, and a contact law."""

    law: str
    kA: float
    kP: float
    tension: float
    adhesion: float
    reach: float | None

    def contact_law(self) -> Law:
        """The law of this name with these stiffnesses."""
        law = LAWS[self.law]
        if isinstance(law, Ring):
            reach = law.reach if self.reach is None else self.reach
            return replace(
                law,
                kA=self.kA,
                kP=self.kP,
                tension=self.tension,
                adhesion=self.adhesion,
                reach=reach,
            )
        return replace(law, kA=self.kA, kP=self.kP)


@dataclass(frozen=True)
class Settings(Material):
    """The settings of a run, by the names of the options; summary.json has them as `parameters`."""

    number: int
    radii: tuple[float, float]
    fraction: float
    polydispersity: float | None
    aspect: float
    tilt: float
    seed: int

    strain: float | None
    phi: float | None
    pressure: float | None
    steps: int
    tolerance: float

    @property
    def target(self) -> dict[str, Any]:
        """What `compress` is asked for."""
        given = {name: getattr(self, name) for name in TARGETS}
        return {"strain": _STRAIN} if set(given.values()) == {None} else given

    @property
    def parameters(self) -> dict[str, Any]:
        """Those that the run depends on."""
        unused = FILE if self.from_file is None else _RANDOM
        return {name: value for name, value in asdict(self).items() if name not in unused}

    def random_start(self) -> Packing:
        """The packing before it is jammed."""
        if self.polydispersity is None:
            start = bidisperse(
                self.number,
                self.radii,
                self.fraction,
                aspect=self.aspect,
                tilt=self.tilt,
                seed=self.seed,
            )
        else:
            start = _log_normal(self, self.polydispersity)
        _check_aspect(start, self.aspect)
        return start


def given_settings(context: typer.Context, kind: type[M]) -> tuple[M, dict[str, Any]]:
    """Settings of a command, and those of them that are given on the command line."""
    values = {field.name: context.params[field.name] for field in fields(kind)}
    return kind(**values), {name: values[name] for name in values if is_given(context, name)}


def check_in_file(settings: InFile, given: Container[str]) -> None:
    """Refuse options of a packing in a file without a file.

    Args:
        settings: of the run.
        given: those that are given on the command line.
    """
    alone = [option(name) for name in FILE[1:] if name in given]
    if settings.from_file is None and alone:
        raise ParameterError(f"{alone[0]} is about the file of a packing: give --from too")


def check_material(settings: Material, given: Mapping[str, Any]) -> None:
    """Refuse options of a packing in a file and of a law that contradict each other."""
    check_in_file(settings, given)
    if settings.law == "sector" and "reach" in given:
        raise ParameterError("--reach is an option of ring laws: leave it out with --law sector")
    if settings.law == "sector" and "tension" in given:
        raise ParameterError("--tension is an option of ring laws: leave it out with --law sector")
    if settings.law == "sector" and "adhesion" in given:
        raise ParameterError("--adhesion is an option of --law curved: leave it out")


def check_together(settings: Settings, given: Mapping[str, Any]) -> None:
    """Refuse options that contradict each other, as `check_material` does."""
    beside = [option(name) for name in _RANDOM if name in given]
    if settings.from_file is not None and beside:
        raise ParameterError(
            f"the packing is that in '{settings.from_file}', and {beside[0]} is about a random "
            "one: leave it out"
        )
    check_material(settings, given)
    if settings.polydispersity is not None and given.keys() & {"radii", "fraction"}:
        raise ParameterError("give --polydispersity, or --radii and --fraction of two sizes")


def check_same(folder: Path, given: Mapping[str, Any]) -> None:
    """Refuse settings that differ from those that the run in a folder was begun with."""
    saved = _saved(Run(folder).parameters)
    for name, value in given.items():
        if name not in saved:
            raise ParameterError(f"the summary of '{folder}' lacks {option(name)}: leave it out")
        if _typed(value) != _typed(saved[name]):
            raise ParameterError(
                f"the run in '{folder}' was begun with {option(name)} {_typed(saved[name])}, not "
                f"{_typed(value)}: leave it out, or name another folder"
            )


def option(name: str) -> str:
    """The option of a setting."""
    return "--" + name.removesuffix("_file").replace("_", "-")


def _number(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word


def _saved(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Settings in a summary: those of the last compression, completed by those of earlier ones."""
    settings = dict(parameters)
    before = settings.pop("before", None)
    return (_saved(before) if before else {}) | settings


def _typed(value: object) -> str:
    """A setting as it is typed, from the command line or from JSON, where inf is a string."""
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value).lower()


def _log_normal(settings: Settings, polydispersity: float) -> Packing:
    """Radii of mean 0.5 and this standard deviation over the mean."""
    width = positive("polydispersity", polydispersity)
    variance = math.log1p(width * width)
    return polydisperse(
        settings.number,
        lambda rng: 0.5 * rng.lognormal(-0.5 * variance, math.sqrt(variance), settings.number),
        aspect=settings.aspect,
        tilt=settings.tilt,
        seed=settings.seed,
    )


def _check_aspect(start: Packing, aspect: float) -> None:
    """Refuse a box that the largest particles span before they jam."""
    largest = 2.0 * start.radius.max()
    limit = max(float(np.prod(start.box.diagonal())) / (2.0 * largest) ** 2, 1.0)
    if not 1.0 / limit <= aspect <= limit:
        raise ParameterError(
            f"aspect must lie between {1.0 / limit:.3g} and {limit:.3g} for {len(start)} particles,"
            f" not {aspect:g}: the box would be thinner than two of the largest"
        )
