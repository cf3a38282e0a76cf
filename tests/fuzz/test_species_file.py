"""The species file: read as a second reader reads it, or refused in one line."""

import math
import re

import pytest
from grammar import species_files
from hypothesis import given, settings

# Two particles that touch, before the pair style.
SCENE = """
units lj
dimension 2
atom_modify map yes
region box block -4 4 -4 4 -0.5 0.5
create_box 2 box
mass * 1.0
create_atoms 1 single 0 0 0
create_atoms 2 single 0.9 0 0
""".strip().splitlines()

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def number(word):
    """As docs/pair_deformable_ring.md has it: a decimal number that a double can hold, or inf."""
    if word in ("inf", "+inf"):
        return math.inf
    value = float(word) if NUMBER.fullmatch(word) else math.nan
    return value if math.isfinite(value) else math.nan


def understood(text):
    """Species by name, or none where the file is no species file."""
    if "\0" in text:
        return None
    species = {}
    for line in text.removeprefix("\xef\xbb\xbf").split("\n"):
        words = re.findall(r"[^ \t\r\n\f\v]+", line.partition("#")[0])
        if not words:
            continue
        if len(words) not in (4, 5) or words[0] in species:
            return None
        radius, kA, kP, skin = (*map(number, words[1:]), 0.0)[:4]
        right = 0.0 < radius < math.inf and kA > 0.0 and kP > 0.0 and 0.0 <= skin < radius
        if not right or kA == kP == math.inf:
            return None
        species[words[0]] = (radius, kA, kP, skin)
    return species or None


def written(species):
    return "".join(f"{name} {' '.join(map(repr, v))}\n" for name, v in species.items())


@pytest.mark.parametrize("examples", [80, pytest.param(4000, marks=pytest.mark.slow)])
def test_any_file(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(species_files().filter(lambda text: not set("\"'\\") & set(text)))
    def reads(text):
        commands = [*SCENE, "pair_style deformable/ring", "pair_coeff * * species a b", "run 0"]
        answer = host.answer(commands, {"species": text})
        units = r"ERROR: Species file 'species' is for units .*, but units lj are in use"
        if re.match(units, answer.get("error", "")):
            assert "UNITS:" in text  # LAMMPS looks at the first line
            return
        known = understood(text)
        if known is None:
            assert re.match(r"ERROR: Species file 'species'[^\n]{,300}\n", answer["error"])
        elif not {"a", "b"} <= set(known):
            assert "is not in the file 'species', which has:" in answer["error"]
        else:
            assert answer == host.answer(commands, {"species": written(known)}) | {
                key: answer[key] for key in ("kB", "open")
            }
            assert "error" in answer or answer["finite"]

    reads()


NO_FILES = ["folder", "nowhere", "", "/dev/null", ".", "species/x", "a" * 300]


def test_no_file(host):
    for file in NO_FILES:
        commands = [*SCENE, "pair_style deformable/ring", f'pair_coeff * * "{file}" a b']
        answer = host.answer(commands, {"species": "a 0.5 1 inf\nb 0.5 1 inf\n"})
        assert re.match(rf"ERROR: [^\n]*species file '{re.escape(file)}'", answer["error"], re.I)
