"""What docs/disordered_crystals.md says of the committed measurements."""

import json
from pathlib import Path

import numpy as np

from validation.disordered_crystals import __main__ as crystals

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


def half(law: str, phi: float, number: int, level: float = crystals.HALF) -> float:
    """Mean spread at which psi_6 falls to a level."""
    return float(np.mean(crystals.line(of(law, phi, number), "psi6", level)))


def table() -> list[str]:
    """1024 particles: where contacts and order are lost, and come back."""
    rows = ["| | phi | contacts lost | psi_6 = 1/2 | Bragg = 1/2 | back |", "|---" * 6 + "|"]
    for (law, phi, number), ramps in GROUPS.items():
        if number == 1024:
            of_levels = (("z", crystals.LOST), ("psi6", crystals.HALF), ("bragg", crystals.HALF))
            values = [*(crystals.line(ramps, *level) for level in of_levels), crystals.back(ramps)]
            rows.append(f"| {law} | {phi:g} | {' | '.join(map(crystals.known, values))} |")
    return rows


def answer() -> str:
    difference, _ = apart("droplets", "disks", 0.94, 1024)
    return (
        f"droplets by {difference:.2f} at phi = 0.94 and up to eta = "
        f"{half('droplets', 0.97, 1024):.2f} at phi = 0.97."
    )


def linear() -> str:
    """Largest deviation of displacements, and of their power; spread of the forces."""
    at = [
        np.mean(crystals.column(ramps, "u2")[:, 1] / 0.01**2 / [r["linear_u2"] for r in ramps])
        for ramps in GROUPS.values()
    ]
    off = 100.0 * np.abs(np.array(at) - 1.0).max()
    first = {law: crystals.column(of(law), "force_spread")[:, 1].mean() for law in LAWS}
    return (
        f"At eta = 0.01 linear response gives u^2 to {off:.1f} % in all packings. "
        "The spread of the contact forces grows with eta, and is "
        f"{first['disks'] / first['droplets']:.1f} times larger for disks than for droplets."
    )


def logarithm() -> str:
    found = {(row["law"], row["number"]): row["u2"] for row in RESULT["impurities"]}
    each = {law: (found[law, 4096] - found[law, 1024]) / np.log(4.0) for law in LAWS}
    told = [f"{each[law]:.4f} ({law})" for law in LAWS]
    return f"u^2/eta^2 grows by {', '.join(told)} for each factor e of N at phi = 0.94."


def opened() -> str:
    """Spread of the forces of linear response where contacts are lost."""
    found = []
    for ramps in GROUPS.values():
        per_spread = crystals.column(ramps, "force_spread")[:, 1].mean() / 0.01
        lost = crystals.line(ramps, "z", crystals.LOST)
        found += [per_spread * np.mean(lost)] if np.isfinite(lost).all() else []
    return (
        "They open where the standard deviation of the forces, by linear response, is "
        f"{min(found):.2f} to {max(found):.2f} of their mean, with every law and phi."
    )


def lost() -> str:
    disks = [half(*key) for key in GROUPS if key[0] == "disks"]
    loose = [half(law, 0.92, 256) for law in LAWS]
    return (
        f"Disks lose their order at eta = {min(disks):.2f} to {max(disks):.2f}, at every phi and "
        f"N. At phi = 0.92 all laws lose it at {min(loose):.2f} to {max(loose):.2f}, because "
        "particles are nearly round there."
    )


def longer() -> str:
    """Differences of laws with the same sizes."""
    told = [crystals.shown(*apart(law, "disks", 0.94, 4096)) for law in LAWS[1:]]
    return (
        "With the same sizes at phi = 0.94 and N = 4096, rings lose their order later than disks "
        f"by {told[0]}, soft rings by {told[1]}, droplets by {told[2]}."
    )


def energies() -> str:
    """Energies of packings on the way down over those of crystals, means of each law, phi and N."""
    at = {
        eta: [np.mean(crystals.cost(ramps, eta)) for ramps in GROUPS.values()] for eta in (0.3, 0.4)
    }
    near, far = (f"{min(values):.2f} to {max(values):.2f} times" for values in at.values())
    return (
        f"On the way down packings have {near} the energy of the crystal with the same sizes at "
        f"eta = 0.3, and {far} at 0.4."
    )


def at_spread(law: str, name: str, eta: float) -> float:
    """A mean of 1024 particles at phi = 0.94."""
    ramps = of(law)
    return float(np.nanmean(crystals.column(ramps, name)[:, ramps[0]["up"]["eta"].index(eta)]))


def ratio(law: str, name: str, eta: float) -> float:
    """Over the value of the crystal."""
    return at_spread(law, name, eta) / at_spread(law, name, 0.0)


def elastic() -> str:
    shear = [at_spread("disks", "G", eta) / at_spread("disks", "K", eta) for eta in (0.0, 0.3)]
    rings, drops = (
        [ratio(law, name, eta) for name in ("pressure", "G", "K")]
        for law, eta in (("rings", 0.3), ("droplets", 0.39))
    )
    return (
        f"At phi = 0.94, G/K of disks falls from {shear[0]:.2f} in the crystal to {shear[1]:.2f} "
        f"at eta = 0.3, where psi_6 is still {at_spread('disks', 'psi6', 0.3):.2f}. Rings become "
        f"stiffer: at 0.3 pressure, G and K are {rings[0]:.1f}, {rings[1]:.1f} and {rings[2]:.1f} "
        "times those of the crystal. Droplets keep all three until the first contact opens; at "
        f"0.39 they are {drops[0]:.2f}, {drops[1]:.2f} and {drops[2]:.2f} times those of the "
        "crystal."
    )


def took() -> str:
    return f"takes {crystals.seconds(RESULT) / 60.0:.0f} minutes of processor time"


TABLES = (table,)
SENTENCES = (
    *(answer, linear, logarithm, opened, lost, longer, energies),
    *(elastic, took),
)
PAGES = {PAGE: (TABLES, SENTENCES)}
