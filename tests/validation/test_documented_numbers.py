"""Tables of README.md and of docs have the numbers of validation/report/report.json."""

import re

from validation.report.documented import REPORT, ROOT, of_balanced


def test_errors_fall_with_the_stiffness_and_grow_with_the_indentation():
    rows = [row for row in REPORT["single"] if row["n_v"] == 314]
    for a in {row["a_over_R"] for row in rows if row["a_over_R"] > 0.0095}:
        found = {row["kL"]: row["I_sector"] for row in rows if row["a_over_R"] == a}
        falling = [found[kL] for kL in sorted(found) if kL <= 1e5]
        assert falling == sorted(falling, reverse=True), a
    for kL in {row["kL"] for row in rows if row["kL"] <= 1e4}:
        found = {row["a_over_R"]: row["I_sector"] for row in rows if row["kL"] == kL}
        rising = [found[a] for a in sorted(found) if a < 0.0455]
        assert rising == sorted(rising), kL


def test_the_docstring_says_the_same_of_balanced():
    at_most = re.search(r"is right to ([\d.]+ %) in energy", of_balanced())[1]
    law = " ".join((ROOT / "python/lammps_deformable/particles/laws.py").read_text().split())
    assert f"right to {at_most} from 1 to 3 % strain" in law


def test_readme_is_read_in_a_minute():
    """At most 900 words, code included."""
    assert len((ROOT / "README.md").read_text().split()) <= 900
