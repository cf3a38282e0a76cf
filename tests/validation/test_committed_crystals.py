"""What docs/disordered_crystals.md says follows from the committed measurements.

Run as a script, this writes tables and sentences into the page.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from committed_page import check, write

from validation.disordered_crystals import __main__ as crystals

pytest.importorskip("matplotlib")

ROOT = Path(__file__).parents[2]
FOLDER, PAGE = ROOT / "validation" / "disordered_crystals", ROOT / "docs" / "disordered_crystals.md"
RESULT = json.loads((FOLDER / "full.json").read_text())
GROUPS = crystals.groups(RESULT["ramps"])
LAWS = list(crystals.LAWS)


def of(law: str, phi: float = 0.94, number: int = 1024) -> list[dict]:
    return GROUPS[law, phi, number]


def apart(one: str, other: str, phi: float, number: int) -> tuple[float, float]:
    """By how much a law keeps its order longer than another one with the same sizes, and error."""
    lost = [crystals.line(of(law, phi, number), "psi6", crystals.HALF) for law in (one, other)]
    return crystals.mean([a - b for a, b in zip(*lost, strict=True)])


def forces() -> str:
    """How much larger the spread of the forces is in disks, in the limit of small eta."""
    first = {law: crystals.column(of(law), "force_spread")[:, 1].mean() for law in LAWS}
    return (
        f"It is {first['disks'] / first['droplets']:.1f} times larger for disks than for droplets"
    )


def shift(number: int) -> str:
    told = [
        f"{crystals.shown(*apart(law, 'disks', 0.94, number))} ({law})"
        for law in ("rings", "soft rings", "droplets")
    ]
    return f"N = {number}, by {', '.join(told)}"


def small_shift() -> str:
    return shift(256)


def large_shift() -> str:
    return shift(1024)


def largest_shift() -> str:
    return shift(4096)


def opened() -> str:
    """Spread of the forces of linear response where contacts are lost."""
    found = []
    for ramps in GROUPS.values():
        per_spread = crystals.column(ramps, "force_spread")[:, 1].mean() / 0.01
        lost = crystals.line(ramps, "z", crystals.LOST)
        found += [per_spread * np.mean(lost)] if np.isfinite(lost).all() else []
    return f"is {min(found):.2f} to {max(found):.2f} of their mean"


def energies() -> str:
    """Energies of packings on the way down over those of crystals, means of each law, phi and N."""
    at = {
        eta: [np.mean(crystals.cost(ramps, eta)) for ramps in GROUPS.values()] for eta in (0.3, 0.4)
    }
    near, far = (f"{min(values):.2f} to {max(values):.2f} times" for values in at.values())
    return f"have {near} the energy of the crystal, and {far} at 0.4"


def returned() -> str:
    """Order at the end."""
    ends = {law: crystals.column(of(law, 0.94, 256), "psi6", "down")[:, -1] for law in LAWS}
    told = [f"{crystals.shown(*crystals.mean(end))} ({law})" for law, end in ends.items()]
    return f"at eta = 0, N = 256, phi = 0.94, psi_6 is {', '.join(told)}"


def took() -> str:
    """Processor time of all ramps, and of a ramp of droplets by size."""
    sizes = sorted({number for law, _, number in GROUPS if law == "droplets"})
    each = [np.mean([ramp["seconds"] for ramp in of("droplets", 0.94, n)]) for n in sizes]
    each = [float(f"{seconds:.2g}") for seconds in each]
    told = ", ".join(f"{each:g} s (N = {n})" for n, each in zip(sizes, each, strict=True))
    minutes = crystals.seconds(RESULT) / 60.0
    total = f"{minutes:.0f} minutes of processor time in all"
    return f"{total}. A ramp of droplets up and down takes {told}"


SENTENCES = {
    forces: r"It is [\d.]+ times larger for disks than for droplets",
    small_shift: r"N = 256, by [^;]*? \(droplets\)",
    large_shift: r"N = 1024, by [^;]*? \(droplets\)",
    largest_shift: r"N = 4096, by [^;]*? \(droplets\)",
    opened: r"is [\d.]+ to [\d.]+ of their mean",
    energies: r"have [\d.]+ to [\d.]+ times the energy of the crystal, and [\d. to]+ times at 0\.4",
    returned: r"at eta = 0, N = 256, phi = 0\.94, psi_6 is [^;]*? \(droplets\)",
    took: r"\d+ minutes of processor time in all\. A ramp [^;]*?(?=, of 24)",
}


def test_the_page_follows_from_the_measurements() -> None:
    check(PAGE, (table(RESULT) for table in crystals.TABLES), SENTENCES)


def test_they_are_all_that_the_script_measures() -> None:
    names = {"ramps": ("law", "number", "phi", "seed"), "impurities": ("law", "number", "phi")}
    names["compressions"] = ("law", "number", "eta", "seed")
    for kind, keys in names.items():
        assert [tuple(row[key] for key in keys) for row in RESULT[kind]] == crystals.FULL[kind]
    for ramp in RESULT["ramps"]:
        assert tuple(ramp["up"]["eta"]) == crystals.UP
        assert tuple(ramp["down"]["eta"]) == crystals.DOWN
        for way in ("up", "down"):
            assert max(ramp[way]["residual"]) <= crystals.TOLERANCE
            assert not any(ramp[way]["beyond"])


def test_droplets_with_six_contacts_have_the_pressure_of_the_crystal() -> None:
    """To the tolerance of the relaxation; where psi_6 falls, neighbors have changed at z = 6."""
    compared = 0
    for (law, *_), ramps in GROUPS.items():
        for ramp in ramps if law == "droplets" else ():
            up = ramp["up"]
            left = (np.array(up["z"]) < 6.0) | (np.array(up["psi6"]) < 0.98)
            intact = int(np.argmax(left))
            assert up["pressure"][:intact] == pytest.approx(up["pressure"][:1] * intact, rel=2e-4)
            compared += intact
    assert compared > 100


def test_small_spreads_are_those_of_linear_response() -> None:
    for (_, phi, number), ramps in GROUPS.items():
        linear = [ramp["linear_u2"] for ramp in ramps]
        ratio = crystals.column(ramps, "u2")[:, 1] / 0.01**2 / linear
        assert ratio == pytest.approx(1.0, rel=0.02 if phi > 0.93 else 0.2), (phi, number)
    exact = {(row["law"], row["number"]): row["u2"] for row in RESULT["impurities"]}
    for law in LAWS:
        found, error = crystals.mean([ramp["linear_u2"] for ramp in of(law, 0.94, 256)])
        assert abs(found - exact[law, 256]) < 4.0 * error


def test_contacts_are_lost_long_before_order() -> None:
    compared = dict.fromkeys(LAWS, 0)
    for (law, *_), ramps in GROUPS.items():
        contacts = np.array(crystals.line(ramps, "z", crystals.LOST))
        order = np.array(crystals.line(ramps, "psi6", crystals.HALF))
        if np.isfinite(contacts).all():  # near confluence some keep six
            assert max(contacts) < np.nanmin(order)
            compared[law] += 1
    assert min(compared.values()) >= 4


def test_deformable_particles_keep_their_order_longer() -> None:
    for number in (256, 1024, 4096):
        difference, error = apart("droplets", "disks", 0.94, number)
        assert difference > 3.0 * error, number


def test_the_log_is_that_of_the_small_run(capsys: pytest.CaptureFixture[str]) -> None:
    crystals.show(json.loads((FOLDER / "quick.json").read_text()))
    assert capsys.readouterr().out == (FOLDER / "quick.log").read_text()


if __name__ == "__main__":
    write(PAGE, (table(RESULT) for table in crystals.TABLES), SENTENCES)
