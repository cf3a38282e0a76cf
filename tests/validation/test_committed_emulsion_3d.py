"""What validation/emulsion_3d/README.md says follows from the committed measurements.

Run as a script, this writes tables and sentences into the page, and both logs.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from committed_page import check, write

from validation.emulsion_3d import __main__ as emulsion
from validation.emulsion_3d import own_weight as weight
from validation.emulsion_3d import yielding

pytest.importorskip("matplotlib")

FOLDER = Path(__file__).parents[2] / "validation" / "emulsion_3d"
PAGE = FOLDER / "README.md"
NUMBER = 512
PACKINGS, COLUMNS = (
    json.loads((FOLDER / f"{name}_{NUMBER}.json").read_text())
    for name in ("emulsion_3d", "own_weight")
)
NEARLY, POLYDISPERSE = emulsion.KINDS
PHI = np.array(emulsion.PHI)
LOOSE = 1e-6  # pressure of a packing that has come loose


def at_phi(kind: str, name: str) -> np.ndarray:
    """Means at the given phi, without those at given phi - phi_J."""
    return emulsion.means(PACKINGS, kind)[0][name][-len(PHI) :]


def of_both(name: str) -> list[np.ndarray]:
    return [at_phi(kind, name) for kind in emulsion.KINDS]


def rows() -> list[dict]:
    return [row for packing in PACKINGS for row in packing["rows"]]


def percent(values: np.ndarray) -> str:
    low, high = 100.0 * np.min(values), 100.0 * np.max(values)
    return f"{low:.0f} to {high:.0f} %"


def onsets() -> str:
    first = (emulsion.summary(PACKINGS, kind, NUMBER) for kind in emulsion.KINDS)
    return ". ".join(line[0].upper() + line[1:] for line in first) + "."


def pressures() -> str:
    below = [1.0 - p / emulsion.master_curve(PHI) for p in of_both("pressure")]
    crossing = [np.interp(0.0, each, PHI) for each in below]
    return (
        "Nearly equal droplets have a higher pressure than emulsions up to phi = "
        f"{crossing[0]:.2f}, polydisperse ones up to {crossing[1]:.2f}, and a lower one "
        f"beyond: at 0.85 by {100.0 * below[0][-1]:.0f} % and {100.0 * below[1][-1]:.0f} %."
    )


def shears() -> str:
    dense = PHI >= 0.73
    softer = [(1.0 - g / emulsion.mason(PHI))[dense] for g in of_both("shear")]
    over = [
        (p / g)[PHI >= 0.79] for p, g in zip(of_both("pressure"), of_both("shear"), strict=True)
    ]
    return (
        f"From 0.73 on nearly equal droplets are softer by {percent(softer[0])}, polydisperse ones "
        f"by {percent(softer[1])}. {give_way()} of {len(rows())} states give way: their mean over "
        "all directions is negative, as the shape of the box is fixed. From 0.79 on the osmotic "
        f"pressure is {np.min(over):.1f} to {np.max(over):.1f} times the shear modulus; "
        "in measured emulsions both are nearly the same."
    )


def give_way() -> int:
    return sum(row["shear"] < 0.0 and row["pressure"] > LOOSE for row in rows())


def strained() -> list[tuple[float, float]]:
    return [(row["sheared"], row["simple"]) for row in rows() if "sheared" in row]


def sheared() -> str:
    difference = max(abs(strain - simple) for strain, simple in strained())
    return (
        f"{len(strained())} states that were sheared by 1e-4 or less and relaxed again have moduli "
        f"within {difference:.0e} γ/R32 of those by linear response."
    )


def bulks() -> str:
    over = [k / g for k, g in zip(of_both("bulk"), of_both("shear"), strict=True)]
    low, high = sorted(f"{each[-1]:.0f}" for each in over)
    told = low if low == high else f"{low} to {high}"
    return f"At 0.85 it is {told} times the shear modulus, of both kinds."


def loose() -> str:
    first = [p["rows"][n]["pressure"] for p in PACKINGS for n in range(len(emulsion.ABOVE))]
    return (
        f"{sum(p < LOOSE for p in first)} of {len(first)} states so close to jamming lose all "
        "pressure."
    )


def near_jamming() -> str:
    told = []
    for kind in emulsion.KINDS:
        shear, excess = (
            emulsion.with_error(*emulsion.exponent(PACKINGS, kind, name, emulsion.NEAR))
            for name in ("shear", "excess")
        )
        told.append(f"{excess} and {shear} of {kind} droplets")
    return f"They are {told[0]}, and {told[1]}: as expected, to three standard errors."


def loads() -> str:
    largest = [max(row["largest"] for row in p["rows"]) for p in PACKINGS]
    return (
        f"The largest load of all droplets is {max(largest):.2f}: none is beyond the model, which "
        "ends at 0.4."
    )


def orders() -> str:
    last = [at_phi(kind, "order")[-1] for kind in emulsion.KINDS]
    most = max(row["order"] for row in rows())
    return (
        f"They do not crystallize: the mean of Steinhardt's q6 at 0.85 is {last[0]:.3f} and "
        f"{last[1]:.3f}, and {most:.3f} at most; in fcc it is 0.575."
    )


def yields() -> str:
    largest, flow = yield_strains(2), yield_strains(1)
    return (
        f"The largest stress over the modulus at rest rises from {largest[0]:.3f} at phi = 0.66 to "
        f"{largest[-1]:.2f} at 0.85, and the stress of the flow from {flow[0]:.3f} to "
        f"{flow[-1]:.3f}."
    )


def weights() -> str:
    value, error = weight.profile(COLUMNS)
    off = value[2] - weight.expected(value[1], PACKINGS)
    borne = np.abs(value[3] / value[1] - 1.0)
    count = len(COLUMNS)
    return (
        f"Means of {count} columns of {NUMBER} droplets. phi is that of the pressures in "
        f"periodic boxes to {np.abs(off).max():.3f}, where errors are up to {error[2].max():.3f}. "
        f"The stress along the height is the weight below to {100.0 * borne.max():.0f} %, as "
        "droplets of a slab are those with their center in it. One diameter is left out at each "
        "end, where droplets lie in layers. The largest load is "
        f"{max(one['load'] for one in COLUMNS):.2f}."
    )


SENTENCES = (
    *(onsets, pressures, shears, sheared, bulks),
    *(near_jamming, loose, loads, orders, yields, weights),
)


YIELDS = json.loads((FOLDER / "yielding_256.json").read_text())


def yield_strains(n: int) -> list[float]:
    """Of the largest stress, n = 2, or of the flow, n = 1, at each phi."""
    found = []
    for phi in yielding.PHI:
        some = [yielding.quantities(each) for each in YIELDS if each["phi"] == phi]
        modulus, *stress = np.mean(some, axis=0)
        found.append(float(stress[n - 1] / modulus))
    return found


def test_yield_strains() -> None:
    """They rise from the onset, as those of foams; the largest stress is twice that of flow."""
    flow, largest = yield_strains(1), yield_strains(2)
    assert (np.diff(largest) > 0.0).all()
    over = np.array(largest) / [yielding.measured(phi) for phi in yielding.PHI]
    assert 0.58 < over.min() < over.max() < 0.88
    assert np.array(largest) / flow == pytest.approx(1.9, abs=0.15)


def logs() -> dict[str, list[str]]:
    """All rows, beside the measurements that they are of."""
    return {
        f"emulsion_3d_{NUMBER}": list(emulsion.lines(PACKINGS, NUMBER)),
        f"own_weight_{NUMBER}": list(weight.table(COLUMNS, PACKINGS)),
        "yielding_256": list(yielding.table(YIELDS)),
    }


def tables() -> list[list[str]]:
    return [list(emulsion.short_table(PACKINGS))]


def test_the_page_follows_from_the_measurements() -> None:
    check(PAGE, tables(), SENTENCES)
    for name, lines in logs().items():
        assert (FOLDER / f"{name}.log").read_text().splitlines() == lines


def test_what_the_page_says_of_the_numbers() -> None:
    for kind in emulsion.KINDS:
        for name in ("pressure", "bulk", "excess", "load"):
            assert (np.diff(at_phi(kind, name)) > 0.0).all()
        near, error = emulsion.exponent(PACKINGS, kind, "bulk", emulsion.NEAR)
        assert 0.0 < near - 2.0 * error < near + 2.0 * error < 0.5
        # of contacts whose stiffness is F^(1/L): 1/2 over 1 + 1/L, and for the modulus 1/L more
        for name, least, most in (("shear", 0.56, 0.59), ("excess", 0.43, 0.45)):
            near, error = emulsion.exponent(PACKINGS, kind, name, emulsion.NEAR)
            assert least - 3.0 * error < near < most + 3.0 * error
    # strains are halved until two values agree to 1 %, so that each is known to about that
    assert all(strain == pytest.approx(linear, rel=0.012) for strain, linear in strained())
    assert max(row["largest"] for row in rows()) < 0.4
    assert max(row["order"] for row in rows()) < 0.46


def test_the_height_balances_the_weight() -> None:
    """dp = -phi dz between all points."""
    pressure = at_phi(NEARLY, "pressure")
    height, phi = emulsion.height(PHI, pressure, 0.63)
    lifted = 0.5 * (phi[1:] + phi[:-1]) * -np.diff(height)
    assert lifted == pytest.approx(np.diff(np.append(0.0, pressure)))
    assert height[-1] == 0.0


def test_a_small_packing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 16 droplets, at few phi: pressures as those of 512, to the scatter of so few."""
    monkeypatch.setattr(emulsion, "ABOVE", (0.01,))
    monkeypatch.setattr(emulsion, "PHI", (0.76, 0.82))
    found = emulsion.measure(POLYDISPERSE, 16, 1)
    near, first, last = found["rows"]
    assert near["phi"] == pytest.approx(found["phi_J"] + 0.01)
    assert [first["pressure"], last["pressure"]] == pytest.approx([0.079, 0.186], rel=0.4)
    assert first["sheared"] == pytest.approx(first["simple"], rel=0.02, abs=1e-3)


def test_a_short_column(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ceiling bears all weight, and phi and stress rise to it."""
    monkeypatch.setattr(weight, "SLABS", 2)
    low, high = weight.column(40, 1)["rows"]
    assert 0.0 < low[1] < high[1] < weight.HIGHEST
    assert low[2] < high[2]
    assert [low[3], high[3]] == pytest.approx([low[1], high[1]], rel=0.5)


def test_volume_below_a_height() -> None:
    whole = 4.0 / 3.0 * np.pi * 8.0
    for edge, part in ((0.0, 0.0), (3.0, 0.5), (6.0, 1.0)):
        found = weight.volume_below(edge, np.array([3.0]), np.array([2.0]))
        assert found == pytest.approx(part * whole)


if __name__ == "__main__":
    write(PAGE, tables(), SENTENCES)
    for name, lines in logs().items():
        (FOLDER / f"{name}.log").write_text("\n".join(lines) + "\n")
