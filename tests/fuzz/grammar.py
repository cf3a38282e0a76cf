"""Words, numbers, files and commands similar to those that LAMMPS and the styles accept."""

from hypothesis import strategies as st

# Valid numbers, invalid ones, and texts that only some readers accept as numbers.
NUMBERS = [
    *("0.5", "1", "1.0", "2.5e-1", "5e-1", "+0.7", ".5", "1.", "1E0", "1e-9", "1e9"),
    *("0", "-0", "0.0", "-1", "-0.5", "-1e-300", "1e-300", "1e300", "1e308", "2147483648"),
    *("inf", "INF", "+inf", "-inf", "infinity", "nan", "-nan", "nan(7)", "1e400", "-1e400"),
    *("1e-400", "0x10", "0x1p3", "1_0", "1,5", "1.5x", "++1", "--1", "1e", "e5", "1e+", "1.2.3"),
    *("half", "v_x", "c_x", "*", "NULL"),
]
numbers = st.one_of(
    st.sampled_from(NUMBERS),
    st.floats().map(repr),
    st.floats(0.1, 2.0).map(repr),
    st.integers(-3, 1000).map(str),
)
positive = st.floats(0.1, 2.0).map(repr)


def words_of(*words):
    """Up to seven of these words and of numbers."""
    return st.lists(st.one_of(st.sampled_from(words), numbers), max_size=7)


# ---- species files, a character a byte ----

_names = st.sampled_from(["a", "b", "a", "b", "c", "NULL", "\xc3\xa4", "\xb9", "1\xa0", "*"])
_good = st.tuples(
    _names, positive, positive, st.sampled_from(["inf", "1.0", "0.3"]), st.sampled_from(["", "0"])
).map(" ".join)
_near = st.lists(st.one_of(_names, numbers), min_size=1, max_size=7).map(" ".join)
_comment = st.sampled_from(
    [
        "",
        "   ",
        "\t",
        "# DATE: 2026-11-20 UNITS: lj",
        "#",
        "# UNITS:",
        "# DATE:",
        "# \xff\xfe",
        "#\t#",
    ]
)
_odd = st.one_of(
    st.text(st.characters(max_codepoint=255), max_size=30).filter(lambda text: "\n" not in text),
    st.sampled_from(["a 0.5 1 inf" + " " * 5000, "a " * 3000, "x" * 20000, "a 0.5 1 in\0f"]),
)
_lines = st.lists(st.one_of(_good, _good, _near, _comment, _odd), max_size=6)


@st.composite
def species_files(draw):
    """Lines that are species, nearly, comments or anything, with any ends and beginnings."""
    end = draw(st.sampled_from(["\n", "\n", "\r\n", "\r", " # \n"]))
    text = end.join(draw(_lines)) + draw(st.sampled_from([end, ""]))
    text = draw(st.sampled_from(["", "", "", "\xef\xbb\xbf", "\n\n"])) + text
    return text.encode("utf-16").decode("latin-1") if draw(st.integers(0, 40)) == 0 else text
