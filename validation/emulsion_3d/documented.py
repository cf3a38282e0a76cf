"""What the page of this study says of the committed measurements, and its logs."""

import json
from pathlib import Path

import numpy as np

from validation.emulsion_3d import __main__ as emulsion
from validation.emulsion_3d import own_weight as weight
from validation.emulsion_3d import yielding

FOLDER = Path(__file__).parents[2] / "validation" / "emulsion_3d"
PAGE = FOLDER / "README.md"
NUMBER = 512
PACKINGS, COLUMNS = (
    json.loads((FOLDER / f"{name}_{NUMBER}.json").read_text())
    for name in ("emulsion_3d", "own_weight")
)
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
    return (
        f"They do not crystallize: the mean of Steinhardt's q6 at 0.85 is {last[0]:.3f} and "
        f"{last[1]:.3f}; in fcc it is 0.575."
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
        f"The stress along the height is the weight below to {100.0 * borne.max():.0f} %."
    )


SENTENCES = (
    *(onsets, pressures, shears),
    *(near_jamming, loads, orders, yields, weights),
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


def table() -> list[str]:
    return list(emulsion.short_table(PACKINGS))


PAGES = {PAGE: ((table,), SENTENCES)}
# all rows, beside the measurements that they are of
LOGS = {
    FOLDER / f"emulsion_3d_{NUMBER}.log": lambda: emulsion.lines(PACKINGS, NUMBER),
    FOLDER / f"own_weight_{NUMBER}.log": lambda: weight.table(COLUMNS, PACKINGS),
    FOLDER / "yielding_256.log": lambda: yielding.table(YIELDS),
}
