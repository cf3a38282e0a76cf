"""Inputs of LAMMPS' own examples, with the pair styles of the plugin in place of theirs."""

import re
from pathlib import Path

# Commands of other pair styles, files that are not needed, and pictures.
_LEFT_OUT = (
    *("pair_coeff", "pair_modify", "dump", "dump_modify", "undump", "restart", "thermo_style"),
    *("thermo_modify", "thermo", "log", "info", "shell", "newton", "special_bonds"),
)

# What begins a LAMMPS that reads the particles of another one.
_HEAD = "units", "dimension", "boundary", "atom_style", "atom_modify"

# Radius near the minimum of a Lennard-Jones pair, at which no lattice of the examples just touches,
# and stiffnesses that stop its atoms.
SPECIES = "a {radius} 2000 inf\nb {radius} inf 0 tension 300\n"
RADIUS = 0.57

_RESULTS = "c_deformable_pair c_deformable_virial[1] c_deformable_virial[2] c_deformable_virial[3]"

MEASURE = f"""
compute deformable_pair all pair {{style}}
compute deformable_virial all pressure NULL pair
thermo_style custom step {_RESULTS}
thermo_modify norm no lost ignore
run 0 post no
"""


def written(name: str) -> str:
    """Command that writes energy, pressures of the pairs, and volume."""
    values = " ".join(f"$({word}:%.17g)" for word in (*_RESULTS.split(), "vol"))
    return f'print "{values}" file {name}\n'


def _lines(text: str) -> list[str]:
    """Commands, each in one line, without comments."""
    text = re.sub(r"&[ \t]*\n", " ", text)
    lines = (line.partition("#")[0].strip() for line in text.splitlines())
    return [line for line in lines if line]


def without_coefficients(data: str) -> str:
    """A data file without those of other pair styles."""
    return re.sub(r"^Pair(IJ)? Coeffs.*?(?=^[A-Z])", "", data, flags=re.MULTILINE | re.DOTALL)


def _types(lines: list[str], folder: Path) -> int:
    for line in lines:
        command, *words = line.split()
        if command == "create_box":
            return int(words[0])
        if command == "read_data":
            return int(
                re.search(r"(\d+)\s+atom types", (folder / words[0].strip('"')).read_text())[1]
            )
    raise ValueError("no atom types")


class Example:
    """An input of so many steps at most."""

    def __init__(self, file: Path, steps: int) -> None:
        self.folder, self.lines = file.parent, _lines(file.read_text())
        self.plane = any(line.split() == ["dimension", "2"] for line in self.lines)
        self.style = "deformable/ring" if self.plane else "deformable/droplet"
        self.tilted = any(re.search(r"\bprism\b|\btriclinic\b|\btilt", line) for line in self.lines)
        self.ends = "p p p"
        for line in self.lines:
            if line.startswith("boundary"):  # a box that fits its atoms cannot be strained
                self.ends = re.sub(r"\b[sm]+\b", "f", " ".join(line.split()[1:]))
        kinds = " ".join(["a" if self.plane else "b"] * _types(self.lines, self.folder))
        self.pair = f"pair_style {self.style} balance 1e-12 1000\npair_coeff * * species {kinds}\n"
        self.pair += "special_bonds lj/coul 1 1 1\n"  # the laws scale no contacts
        self._left = steps

    def script(self) -> str:
        """The input, and what it writes at its end."""
        commands, words = [], [line.split()[0] for line in self.lines]
        begins = words.index("pair_coeff" if "pair_coeff" in words else "pair_style")
        box = next(n for n, word in enumerate(words) if word in ("create_box", "read_data"))
        for n, (word, line) in enumerate(zip(words, self.lines, strict=True)):
            if n == max(begins, box + 1):
                commands.append(self.pair)
            if word == "run" and self._left > 0:
                commands.append(f"run {self._part(line.split()[1])}")
            elif word == "minimize":
                commands.append("minimize 0 1e-6 50 100")
            elif word not in (*_LEFT_OUT, "pair_style", "run") and "exclude" not in line:
                commands.append(line)
        save = "write_data moved nofix nocoeff\nwrite_restart moved.restart\n"
        return "\n".join(commands) + self._measured("results") + save

    def fresh(self) -> str:
        """A new LAMMPS that reads the particles, and strains them by a little."""
        head = [line for line in self.lines if line.split()[0] in _HEAD and " first " not in line]
        axes = ["x", "y", "z"][: 2 if self.plane else 3]
        tilts = ["xy", "xz", "yz"][: 1 if self.plane else 3] if self.tilted else []
        strained = "change_box all triclinic\n" * self.tilted
        strained += f"change_box all boundary {self.ends}\n" * ("f" in self.ends)
        for name, scale in (("larger", 1 + 1e-6), ("smaller", (1 - 1e-6) / (1 + 1e-6))):
            sides = " ".join(f"{axis} scale {scale!r}" for axis in axes)
            sides += "".join(f" {tilt} final $({tilt}*{scale!r}:%.17g)" for tilt in tilts)
            strained += f"change_box all {sides} remap\nrun 0 post no\n{written(name)}"
        return "\n".join([*head, "read_data moved", self.pair]) + self._measured("fresh") + strained

    def restarted(self) -> str:
        """A new LAMMPS that goes on from the restart file."""
        return f"read_restart moved.restart\n{self.pair}" + self._measured("restarted")

    def _part(self, steps: str) -> int:
        number = min(int(steps), self._left) if steps.isdigit() else self._left
        self._left -= number
        return number

    def _measured(self, name: str) -> str:
        return MEASURE.format(style=self.style) + written(name)
