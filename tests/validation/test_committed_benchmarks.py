"""Tables and sentences of benchmarks/README.md follow from the committed measurements."""

import lammps_deformable as ld
import numpy as np

from benchmarks.documented import FOLDER, PAGE, of


def test_energies_of_droplets_do_not_drift() -> None:
    """With a balance of 1e-8 it was forty times the error."""
    for row in of("droplet_energy")["drift"]:
        assert abs(row["drift"]) < 3.0 * row["drift_uncertainty"]


def test_what_the_ring_page_says_of_the_reach() -> None:
    """At most 5 % up to 1, but with radical a quarter at 0.6."""
    data = of("reach")
    for row in data["rows"]:
        slower = np.array([row["slow"], row["fast"]])
        if row["law"] == "radical":
            at = slower[:, data["reaches"].index(0.6)]
            np.testing.assert_allclose(at, 1.25, atol=0.05)
        else:
            assert slower.max() < 1.05
    page = " ".join((FOLDER.parent / "docs" / "pair_deformable_ring.md").read_text().split())
    assert "Up to 1 it costs at most 5 % (*radical*: [a quarter at 0.6]" in page


def test_what_the_law_says_of_relaxations() -> None:
    ratio = of("relaxation")["time_over_radical"]["balanced"]["median"]
    said = " ".join(ld.Ring.__doc__.split())
    assert f"takes about {ratio:.1f} times as long with `balanced` as with `radical`" in said


def test_the_page_names_each_script_and_no_other() -> None:
    scripts = {path.name for path in FOLDER.glob("*.py")}
    shared = {"documented.py", "motion.py", "sections.py"}
    text = PAGE.read_text()
    rows = {
        line.split("`")[1]
        for line in text.splitlines()
        if line.startswith("| `") and ".py`" in line
    }
    assert rows == scripts - shared
