"""The settings of `deformable compress` and `deformable shear`: packing, law, protocol of a run."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import typer

from .._checks import positive
from ..errors import ParameterError
from ..laws import ALL_LAWS, AnyLaw, Droplet, Ring
from ..packing import Packing
from ..random import bidisperse, polydisperse
from ..run import Run
from .options import is_given

TARGETS = ("strain", "phi", "pressure")
PROTOCOL = (*TARGETS, "steps", "tolerance")

# Settings of a packing from a random start, and of one in a file.
_RANDOM = ("number", "radii", "fraction", "polydispersity", "aspect", "tilt", "seed")
FILE = ("from_file", "from_radii", "from_frame")

# Laws that are taken without a name, and their dimensions.
_USUAL = {"balanced": 2, "droplet": 3}

# Options that laws lack.
_NOT_OF = {
    "sector": ("reach", "tension", "adhesion"),
    "droplet": ("kA", "kP", "reach", "adhesion"),
}

M = TypeVar("M", bound="Material")

# Strain of a compression that has no target.
_STRAIN = 0.01


@dataclass(frozen=True)
class InFile:
    """A packing in a file, if any, by the names of the options."""

    from_file: str | None
    from_radii: str | None
    from_frame: int

    def packing_in_file(self, dimension: int) -> Packing:
        """The packing in a file, which is not jammed."""
        word = self.from_radii or ""
        radii: Any = None
        if "=" in word:
            pairs = (pair.partition("=") for pair in word.split(","))
            radii = {kind: _number(radius) for kind, _, radius in pairs}
        elif word:
            radii = _number(word)
        path = str(self.from_file)
        return Packing.from_file(path, radii=radii, frame=self.from_frame, dimension=dimension)


@dataclass(frozen=True)
class Material(InFile):
    """A packing in a file, if any, and a contact law."""

    law: str
    dimension: int
    kA: float
    kP: float
    tension: float
    adhesion: float
    reach: float | None

    def contact_law(self) -> AnyLaw:
        """The law of this name with these stiffnesses."""
        law = ALL_LAWS[self.law]
        if isinstance(law, Droplet):
            return Droplet(self.tension)
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
                sizes=self.radii,
                fraction_large=self.fraction,
                aspect=self.aspect,
                tilt=self.tilt,
                seed=self.seed,
                dimension=self.dimension,
            )
        else:
            start = _log_normal(self, self.polydispersity)
        _check_aspect(start, self.aspect)
        return start


def given_settings(context: typer.Context, kind: type[M]) -> tuple[M, dict[str, Any]]:
    """Settings of a command, and those of them that are given on the command line."""
    values = {field.name: context.params[field.name] for field in fields(kind)}
    law, dimension = law_and_dimension(values["law"], values["dimension"], _USUAL)
    values |= {"law": law, "dimension": dimension}
    if dimension == 3 and not is_given(context, "tension"):
        values["tension"] = 1.0
    return kind(**values), {name: values[name] for name in values if is_given(context, name)}


def law_and_dimension(
    law: str | None, dimension: int | None, usual: Mapping[str, int]
) -> tuple[str, int]:
    """A law and its dimension, of which one is left out or both.

    Args:
        law: name of the law, if given.
        dimension: if given.
        usual: names that are taken if none is given, and their dimensions.

    Raises:
        ParameterError: they do not fit each other.
    """
    of = {name: each.dimension for name, each in ALL_LAWS.items()} | dict(usual)
    if dimension not in (None, *usual.values()):
        raise ParameterError(f"--dimension must be 2 or 3, not {dimension}")
    if law is None:
        law = next(name for name, each in usual.items() if each == (dimension or 2))
    if dimension not in (None, of[law]):
        raise ParameterError(
            f"--law {law} is for {of[law]} dimensions, not {dimension}: leave one of them out"
        )
    return law, of[law]


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
    for name in _NOT_OF.get(settings.law, ()):
        if name in given:
            others = "--law curved" if name == "adhesion" else "ring laws"
            raise ParameterError(
                f"{option(name)} is an option of {others}: leave it out with --law {settings.law}"
            )


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
    """A setting as it is typed, from the command line or from a summary."""
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value).lower()


def _log_normal(settings: Settings, polydispersity: float) -> Packing:
    """Radii of mean 0.5 and this standard deviation over the mean."""
    width = positive("polydispersity", polydispersity)
    variance = math.log1p(width * width)
    return polydisperse(
        settings.number,
        lambda rng, n: 0.5 * rng.lognormal(-0.5 * variance, math.sqrt(variance), n),
        aspect=settings.aspect,
        tilt=settings.tilt,
        seed=settings.seed,
        dimension=settings.dimension,
    )


def _check_aspect(start: Packing, aspect: float) -> None:
    """Refuse a box that the largest particles span before they jam."""
    thinnest = (4.0 * start.radii.max()) ** start.dimension
    most = max(float(np.prod(start.box.diagonal())) / thinnest, 1.0)
    least = most ** (-1.0 / (start.dimension - 1))
    if not least <= aspect <= most:
        raise ParameterError(
            f"aspect must lie between {least:.3g} and {most:.3g} for {len(start)} particles,"
            f" not {aspect:g}: the box would be thinner than two of the largest"
        )
