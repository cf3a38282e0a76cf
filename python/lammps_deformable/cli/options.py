"""Options of the command `deformable`, as fields of dataclasses, and what a command does with them.

`command` makes a command of a function: a parameter whose type is a dataclass stands for an option
for each of its fields. Any option may also stand in a TOML file, `--config`.
"""

from __future__ import annotations

import inspect
import math
import sys
from collections.abc import Callable, Container, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, is_dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_type_hints

import numpy as np
import typer
from mpi4py import MPI
from typer import Option

from ..common.checks import positive
from ..common.errors import FileError, ParameterError
from ..engine.relax import TOLERANCE
from ..particles.generators import bidisperse, polydisperse
from ..particles.laws import ALL_LAWS, AnyLaw, Droplet, Ring
from ..particles.packing import Packing
from ..protocols.compression import Compress
from ..protocols.protocol import LARGEST_TOLERANCE
from ..runs.run import Run

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

# Strain of a compression that has no target.
_STRAIN = 0.01

# Options that laws lack.
_NOT_OF = {
    "sector": ("reach", "tension", "adhesion"),
    "droplet": ("kA", "kP", "reach", "adhesion"),
}

Out = Annotated[str, Option(metavar="PATH", help="Output folder.")]
Resume = Annotated[
    bool,
    Option(help="Finish the interrupted run in the output folder. Its options can be left out."),
]
Overwrite = Annotated[bool, Option(help="Replace what is in the output folder.")]
Number = Annotated[int, Option(help="Number of particles.")]
Seed = Annotated[int, Option(help="Seed of the random start.")]


def unset(help: str, *names: str, **more: Any) -> Any:
    """An option whose default is None, which its help does not show."""
    return Option(*names, help=help, show_default=False, **more)


@contextmanager
def words_of(function: str) -> Iterator[None]:
    """Let errors that ask for walls, which the shell has no option for, name who takes them."""
    try:
        yield
    except FileError as error:
        if "walls=" not in str(error):
            raise
        raise FileError(f"{error}, to {function} in Python") from None


@dataclass(frozen=True, kw_only=True)
class InFile:
    """A packing in a file, if any."""

    from_file: Annotated[
        str | None,
        unset(
            "Begin with the packing in this file, as it is: LAMMPS data file or dump, extended "
            "XYZ, GSD, or what MDAnalysis reads.",
            "--from",
            metavar="FILE",
        ),
    ] = None
    from_radii: Annotated[
        str | None,
        unset(
            "Radii of --from: the name of a column, a number, or numbers by type as in "
            "1=0.5,2=0.7. By default those of the file.",
            metavar="RADII",
        ),
    ] = None
    from_frame: Annotated[
        int, Option(help="Frame of --from, from 0, or from the end if negative.")
    ] = -1

    def packing_in_file(self, dimension: int) -> Packing:
        """The packing in the file, which is not jammed."""
        word = self.from_radii or ""
        radii: Any = None
        if "=" in word:
            pairs = (pair.partition("=") for pair in word.split(","))
            radii = {kind: _number(radius) for kind, _, radius in pairs}
        elif word:
            radii = _number(word)
        path = str(self.from_file)
        with words_of("Packing.from_file"):
            return Packing.from_file(path, radii=radii, frame=self.from_frame, dimension=dimension)

    def check(self, given: Container[str], *random: str) -> None:
        """Refuse options of a file without one, and options of a random start beside one."""
        if self.from_file is None:
            for name in ("from_radii", "from_frame"):
                if name in given:
                    raise ParameterError(
                        f"{option(name)} is about the file of a packing: give --from too"
                    )
        else:
            for name in random:
                if name in given:
                    raise ParameterError(
                        f"the packing is that in '{self.from_file}', and {option(name)} is about a "
                        "random one: leave it out"
                    )


@dataclass(frozen=True, kw_only=True)
class Material(InFile):
    """A packing in a file, if any, and a contact law."""

    law: Annotated[
        str | None,
        unset(
            "Contact law. Contacts slip with contact lines where the forces of both sides are "
            "equal (balanced, the default), on arcs that balance torques and pressures too "
            "(curved), or on radical axes (radical), or they stick (sector). Droplets in three "
            "dimensions (droplet) are the default there.",
            metavar="|".join(ALL_LAWS),
        ),
    ] = None
    dimension: Annotated[
        int | None, unset("2, or 3: droplets in space. By default that of the law.")
    ] = None
    kA: Annotated[
        float, Option("--kA", help="Area stiffness [energy/length^4]; inf conserves the area.")
    ] = 1.0
    kP: Annotated[
        float,
        Option("--kP", help="Perimeter stiffness [energy/length^2]; inf conserves the perimeter."),
    ] = math.inf
    tension: Annotated[
        float,
        Option(
            help="Ring laws: line tension of the perimeter at rest [energy/length], beside a "
            "finite kP; droplets have --kA inf --kP 0 --tension 1. In three dimensions surface "
            "tension [energy/length^2], 1 if not given."
        ),
    ] = 0.0
    adhesion: Annotated[
        float,
        Option(
            help="With --law curved: energy gained for each unit of length of a film between two "
            "particles [energy/length], below twice the tension."
        ),
    ] = 0.0
    reach: Annotated[
        float | None,
        Option(
            help="Ring laws: how far beyond touching neighbors count, over the sum of their radii; "
            "0.6 if not given, with radical 0.3."
        ),
    ] = None

    def usual(self: M, given: Container[str]) -> M:
        """With the law and the dimension, of which one may not be given or both."""
        law, dimension = law_and_dimension(self.law, self.dimension)
        tension = 1.0 if dimension == 3 and "tension" not in given else self.tension
        return replace(self, law=law, dimension=dimension, tension=tension)

    def check(self, given: Container[str], *random: str) -> None:
        """Refuse options of the law that it lacks, and those of `InFile`."""
        super().check(given, *random)
        for name in _NOT_OF.get(str(self.law), ()):
            if name in given:
                others = "--law curved" if name == "adhesion" else "ring laws"
                raise ParameterError(
                    f"{option(name)} is an option of {others}: leave it out with --law {self.law}"
                )

    def contact_law(self) -> AnyLaw:
        """The law of this name with these stiffnesses."""
        law = ALL_LAWS[str(self.law)]
        if isinstance(law, Droplet):
            return Droplet(self.tension)
        elastic: dict[str, Any] = {"kA": self.kA, "kP": self.kP}
        if isinstance(law, Ring):
            elastic |= {"tension": self.tension, "adhesion": self.adhesion}
            elastic |= {} if self.reach is None else {"reach": self.reach}
        return replace(law, **elastic)


M = TypeVar("M", bound=Material)


@dataclass(frozen=True, kw_only=True)
class RandomStart:
    """A random packing."""

    number: Number = 128
    radii: Annotated[
        tuple[float, float],
        Option(metavar="SMALL LARGE", help="Radii of small and large particles [length]."),
    ] = (0.5, 0.7)
    fraction: Annotated[float, Option(help="Number fraction of large particles.")] = 0.5
    polydispersity: Annotated[
        float | None,
        unset(
            "Standard deviation over mean of log-normal radii of mean 0.5, in place of two sizes."
        ),
    ] = None
    aspect: Annotated[float, Option(help="Height over width of the box, ly / lx or lz / lx.")] = 1.0
    tilt: Annotated[float, Option(help="Shear of the box, xy / ly.")] = 0.0
    seed: Seed = 1


@dataclass(frozen=True, kw_only=True)
class Settings(RandomStart, Material):
    """The settings of a compression; summary.json has them as `parameters`."""

    strain: Annotated[
        float | None,
        unset(
            "Linear strain of all steps together; negative expands. 0.01 if neither this nor --phi "
            "nor --pressure is given."
        ),
    ] = None
    phi: Annotated[float | None, unset("Compress or expand to this packing fraction.")] = None
    pressure: Annotated[
        float | None,
        unset("Compress or expand to this pressure [energy/length^2, energy/length^3]."),
    ] = None
    steps: Annotated[int, Option(help="Number of steps.")] = 10
    tolerance: Annotated[
        float,
        Option(
            help="A step is relaxed when the largest force on a particle is this times the mean "
            f"contact force; at most {LARGEST_TOLERANCE:g}."
        ),
    ] = TOLERANCE

    @property
    def protocol(self) -> Compress:
        """What is done."""
        given: dict[str, Any] = {
            field.name: getattr(self, field.name) for field in fields(Compress)
        }
        if self.strain is None and self.phi is None and self.pressure is None:
            given["strain"] = _STRAIN
        return Compress(**given)

    @property
    def parameters(self) -> dict[str, Any]:
        """Those that the run depends on."""
        unused = InFile if self.from_file is None else RandomStart
        without = {field.name for field in fields(unused)}
        return {name: value for name, value in asdict(self).items() if name not in without}

    def start(self) -> Packing:
        """The packing in the file, or the random one before it is jammed."""
        if self.from_file is not None:
            return self.packing_in_file(int(self.dimension or 2))
        box: dict[str, Any] = {"aspect": self.aspect, "tilt": self.tilt, "seed": self.seed}
        box["dimension"] = self.dimension
        if self.polydispersity is None:
            start = bidisperse(self.number, sizes=self.radii, fraction_large=self.fraction, **box)
        else:  # log-normal radii of mean 0.5
            width = positive("polydispersity", self.polydispersity)
            s2 = math.log1p(width * width)
            start = polydisperse(
                self.number, lambda rng, n: 0.5 * rng.lognormal(-0.5 * s2, math.sqrt(s2), n), **box
            )
        thinnest = (4.0 * start.radii.max()) ** start.dimension
        most = max(float(np.prod(start.box.diagonal())) / thinnest, 1.0)
        least = most ** (-1.0 / (start.dimension - 1))
        if not least <= self.aspect <= most:
            raise ParameterError(
                f"aspect must lie between {least:.3g} and {most:.3g} for {len(start)} particles,"
                f" not {self.aspect:g}: the box would be thinner than two of the largest"
            )
        return start


def law_and_dimension(law: str | None, dimension: int | None) -> tuple[str, int]:
    """A law and its dimension, of which one is left out or both.

    Raises:
        ParameterError: there is no such law or dimension, or they do not fit each other.
    """
    usual = {2: "balanced", 3: "droplet"}
    if dimension not in (None, *usual):
        raise ParameterError(f"--dimension must be 2 or 3, not {dimension}")
    law = usual[dimension or 2] if law is None else law
    if law not in ALL_LAWS:
        raise ParameterError(f"--law must be one of {', '.join(ALL_LAWS)}, not {law}")
    own = ALL_LAWS[law].dimension
    if dimension not in (None, own):
        raise ParameterError(
            f"--law {law} is for {own} dimensions, not {dimension}: leave one of them out"
        )
    return law, own


def check_same(folder: Path, given: Mapping[str, Any]) -> None:
    """Refuse settings that differ from those that the run in a folder was begun with."""
    saved: dict[str, Any] = {}
    parameters = dict(Run(folder).parameters)
    while parameters:  # those of the last compression, completed by those of earlier ones
        before = parameters.pop("before", None)
        saved = parameters | saved
        parameters = dict(before or {})
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


def refuse_ranks(reason: str) -> None:
    """Refuse mpiexec for a command that does not share its work over ranks."""
    if MPI.COMM_WORLD.size > 1:
        raise CommandLineError(f"{reason}: start it without mpiexec")


class CommandLineError(ParameterError):
    """A command that cannot begin. All ranks read the same command line, so that rank 0 tells."""


def _number(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word


def _typed(value: object) -> str:
    """A setting as it is typed, from the command line or from a summary."""
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value).lower()


# How a command runs, in contrast to its settings.
_HOW = ("out", "resume", "append", "overwrite", "config", "run", "workers")


def command(app: typer.Typer) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add a function to the commands: an option for each parameter, and each field of dataclasses.

    A parameter `given` gets the settings that are given on the command line or in `--config`.
    """

    def add(function: Callable[..., None]) -> Callable[..., None]:
        hints = get_type_hints(function, include_extras=True)
        listed = [inspect.Parameter("context", _KEYWORD, annotation=typer.Context)]
        groups = {}
        for name, each in inspect.signature(function).parameters.items():
            if is_dataclass(hints[name]):
                kind = groups[name] = hints[name]
                types = get_type_hints(kind, include_extras=True)
                listed += [
                    inspect.Parameter(
                        field.name, _KEYWORD, default=field.default, annotation=types[field.name]
                    )
                    for field in fields(kind)
                ]
            elif name != "given":
                listed.append(each.replace(kind=_KEYWORD, annotation=hints[name]))
        listed.append(inspect.Parameter("config", _KEYWORD, default=None, annotation=_Config))

        @wraps(function)
        def run(context: typer.Context, config: Path | None = None, **values: Any) -> None:
            sources = {name: context.get_parameter_source(name) for name in values}
            given = {
                name: values[name]
                for name, source in sources.items()
                if source and source.name in ("COMMANDLINE", "DEFAULT_MAP") and name not in _HOW
            }
            for name, kind in groups.items():
                own = {field.name: values.pop(field.name) for field in fields(kind)}
                values[name] = kind(**own)
            if "given" in hints:
                values["given"] = given
            function(**values)

        run.__signature__ = inspect.Signature(listed)  # type: ignore[attr-defined]
        run.__annotations__ = {each.name: each.annotation for each in listed}
        del run.__wrapped__
        return app.command(function.__name__.removesuffix("_command"))(run)

    return add


_KEYWORD = inspect.Parameter.KEYWORD_ONLY


def _read_config(context: typer.Context, path: Path | None) -> Path | None:
    """Take options from a TOML file, which those of the command line replace."""
    if path is None:
        return None
    try:
        with path.open("rb") as file:
            values = tomllib.load(file)
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise FileError(f"'{path}' cannot be read: {error}") from None
    names = {word.lstrip("-"): p.name for p in context.command.params for word in p.opts}
    for key in values:
        if key not in names:
            raise ParameterError(
                f"'{path}' has {key}, and `deformable {context.info_name}` has no option --{key}"
            )
    context.default_map = {str(names[key]): value for key, value in values.items()}
    return path


_Config = Annotated[
    Path | None,
    Option(
        metavar="FILE",
        help="Options in a TOML file, such as steps = 20; those of the command line come first.",
        show_default=False,
        is_eager=True,
        callback=_read_config,
    ),
]
