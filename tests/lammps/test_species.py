"""The species file and pair_coeff: an invalid line or word stops with an error that names it."""

import pytest
from scene import SPECIES
from test_refusals import refuses, two_particles


def with_species(tmp_path, text):
    file = tmp_path / "species.txt"
    file.write_text(text)
    lmp = two_particles()
    lmp.command("pair_style deformable/ring contact radical")
    return lmp, f"pair_coeff * * {file} a a"


@pytest.mark.parametrize(
    ("units", "message"),
    [
        ("# DATE: 2026-01-01 UNITS: metal\n", "units metal.*lj"),
        ("# UNITS:\r\x80\r", r"units \?+"),  # plain characters, whatever there is
    ],
)
def test_species_of_other_units(units, message, tmp_path):
    lmp, coeff = with_species(tmp_path, f"{units}a 1 1 inf\n")
    with refuses(message):
        lmp.command(coeff)


WORDS = [
    (f"* * {SPECIES} small huge", "Species 'huge'.*species.txt.*unit small large"),
    (f"* * {SPECIES} small", "1 species.* 2 atom types"),
    (f"* * {SPECIES} small small small", "3 species.* 2 atom types"),
    ("* * nowhere.txt small small", "Cannot open.*nowhere.txt"),
    (f"* * {SPECIES}", "pair_coeff command: missing argument"),
    (f"1 1 {SPECIES} small small", "Pair_coeff must start with .* for pair style {style}"),
]


@pytest.mark.parametrize("style", ["deformable/ring", "deformable/sector"])
def test_words_of_pair_coeff(style):
    lmp = two_particles()
    lmp.command(f"pair_style {style}")
    for words, message in WORDS:
        with refuses(message.format(style=style)):
            lmp.command(f"pair_coeff {words}")


MALFORMED = {
    "too few words": ("a 0.5 1.0", "line 2: .*got 3 words"),
    "radius no number": ("a half 1.0 inf", "line 2: radius.* a .*'half'"),
    "radius zero": ("a 0 1.0 inf", "line 2: species a: radius .*not 0"),
    "radius hexadecimal": ("a 0x1 1.0 inf", "radius.* a .*'0x1'"),
    "kA too large": ("a 0.5 1e400 inf", "kA.* a .*'1e400'"),
    "kA zero": ("a 0.5 0.0 inf", "species a: kA .*not 0"),
    "kP as in regions": ("a 1 1 -INF", "kP of species a is '-INF', which is not a number"),
    "skin too thick": ("a 0.5 1.0 inf 0.5", "species a: skin .*radius 0.5"),
    "skin empty": ("a 0.5 1.0 inf ''", "skin.* a .*''"),
    "tension without value": ("a 0.5 inf 0 tension", "species a: tension has no value"),
    "skin twice": ("a 0.5 1 inf 0.1 skin 0.2", "species a: skin .*twice"),
    "unknown keyword": ("a 0.5 inf 0 surface 1.0", "line 2: .*'surface' is no keyword"),
    "tension and perimeter": ("a 0.5 1 inf tension 1", "species a: kP must be finite"),
    "collapse": ("a 0.5 1 0 tension 1", "species a: tension 1 .*collapse"),
    "floppy": ("a 0.5 inf 0", "species a: kP .*tension, not 0"),
    "tension without its word": ("a 0.5 inf 0 0.2", "not 0: a fifth .* skin.* 'tension 0.2'"),
    "both inf": ("a 0.5 inf inf", "species a: kA and kP"),
    "twice": ("a 0.5 1.0 inf\nb 0.5 1 inf\na 0.6 1.0 inf", "line 4: species a .*twice"),
    "not printable": ("a \x01 \xe4", "got 3 words: 'a [?] [?][?]'"),
    "long": ("a " * 3000, "got 3000 words: '(a ){40}[.]{3}'"),
    "zero byte": ("a 0.5 1.0 inf\0", "zero bytes"),
    "nothing": ("", "no species"),
}


def test_malformed_files(tmp_path):
    lmp, pair_coeff = with_species(tmp_path, "")
    for text, message in MALFORMED.values():
        (tmp_path / "species.txt").write_text("# DATE: 2026-11-20 UNITS: lj\n" + text)
        with refuses(rf"Species file '.*species.txt'.*{message}"):
            lmp.command(pair_coeff)


READ = [
    *(f"a 0.5 inf 0 {line}" for line in ("0.1 tension 2", "tension 2 skin 0.1")),
    "a 0.5 inf 0 skin 0.1 tension 2",
    *(f"a 1 1 {infinite}" for infinite in ("inf", "INF", "+Inf")),  # as in LAMMPS' regions
    "# DATE: 2026-01-01 UNITS: lj\na 1 1 inf\n",
    "# a\n\n  # b\n a 0.5 1.0 inf # the only one\n\n",
    "\ufeffa 0.5 1.0 inf",
]


def test_files_that_are_read(tmp_path):
    for text in READ:
        lmp, pair_coeff = with_species(tmp_path, text)
        lmp.command(pair_coeff)


def test_folder(tmp_path):
    lmp, pair_coeff = with_species(tmp_path, "")
    with refuses("Cannot open.*Is a directory"):
        lmp.command(pair_coeff.replace("species.txt", "."))


@pytest.mark.parametrize(("name", "text"), [("a", "a 0.5 0 inf\n"), ("b", "a 0.5 1 inf\n")])
def test_a_run_after_an_error(name, text, tmp_path):
    """The caller has caught it: nothing is set yet, or all is as it was."""
    lmp, pair_coeff = with_species(tmp_path, text)
    wrong = pair_coeff.replace(" a a", f" a {name}")
    with refuses("Species"):
        lmp.command(wrong)
    with refuses("All pair coeffs are not set"):
        lmp.command("run 0")
    (tmp_path / "species.txt").write_text("a 0.5 1 inf\n")
    lmp.command(pair_coeff)
    lmp.command("run 0")
    energy = lmp.get_thermo("pe")
    (tmp_path / "species.txt").write_text(text)
    with refuses("Species"):
        lmp.command(wrong)
    lmp.command("run 0")
    assert lmp.get_thermo("pe") == energy
