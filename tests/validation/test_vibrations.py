"""Modes of packings above jamming: density of states, omega*, boson peak, exponents."""

from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest

from validation.jamming import vibrations
from validation.jamming.vibrations import (
    EDGES,
    boson_peak,
    density,
    exponent,
    measure,
    onset_frequency,
    plateau,
    summarize,
)

MIDDLE = np.sqrt(EDGES[1:] * EDGES[:-1])


def spectrum(frequencies: np.ndarray, **named: Any) -> dict[str, Any]:
    counts = np.histogram(frequencies, EDGES)[0].tolist()
    return {"counts": counts, "modes": len(frequencies), "complete": None} | named


def sample(cut: float, number: int = 400_000) -> np.ndarray:
    """Frequencies up to 2 with D = 1/2 above the cut, and proportional to omega^2 below."""
    share = np.linspace(0.0, 1.0, number, endpoint=False) + 0.5 / number
    below = cut / (3.0 * (2.0 - cut) + cut)  # integral of (omega/cut)^2 is cut/3
    low = cut * np.cbrt(share[share < below] / below)
    return np.concatenate([low, cut + (2.0 - cut) * (share[share >= below] - below) / (1 - below)])


def test_density_of_a_whole_spectrum_is_normalized() -> None:
    rng = np.random.default_rng(1)
    rows = [spectrum(rng.uniform(0.01, 3.0, 500)), spectrum(rng.uniform(0.1, 2.0, 300))]
    found, error = density(rows)
    assert np.sum(found * np.diff(EDGES)) == pytest.approx(1.0, rel=1e-12)
    there = found > 0.0
    counts = np.sum([row["counts"] for row in rows], axis=0)
    assert found[there] / error[there] == pytest.approx(np.sqrt(counts[there]), rel=1e-12)


def test_few_modes_count_up_to_where_they_are_complete() -> None:
    whole = sample(0.1)
    lowest = np.sort(whole)[:20_000]
    part = spectrum(lowest) | {"modes": len(whole), "complete": float(lowest[-1])}
    (found, _), (expected, _) = density([part]), density([spectrum(whole)])
    known = EDGES[1:] <= part["complete"]
    assert np.array_equal(found[known], expected[known])
    assert np.isnan(found[~known]).all()


@pytest.mark.parametrize("cut", [0.003, 0.1])
def test_end_of_the_plateau_and_boson_peak(cut: float) -> None:
    """D = omega^2 ends at half the plateau at cut/sqrt(2); D/omega is largest at the cut.

    Both are found to an interval, 26 %.
    """
    rows = [spectrum(sample(cut))]
    level = plateau(rows)
    assert level == pytest.approx(1.0 / (2.0 - cut * 2.0 / 3.0), rel=0.01)
    assert onset_frequency(rows, level) == pytest.approx(cut / np.sqrt(2.0), rel=0.15)
    assert boson_peak(rows) == pytest.approx(cut, rel=0.26)


def test_no_plateau_no_frequency() -> None:
    rows = [spectrum(np.full(100, 0.01))]
    assert np.isnan(onset_frequency(rows, 1e9))


def test_exponent_of_a_power_law() -> None:
    rows = [{"wanted": x, "excess_phi": x, "pressure": 2.0 * x**1.5} for x in (1e-4, 1e-3, 1e-2)]
    assert exponent(rows, "pressure", 1e-4, 1e-2) == pytest.approx(1.5, rel=1e-12)
    assert np.isnan(exponent(rows, "pressure", 1e-4, 1e-4))


@pytest.mark.parametrize("contact", ["radical", "curved"])
def test_the_unit_of_frequencies_is_that_of_all_modes(contact: str) -> None:
    """The trace of the Hessian is the sum of all stiffnesses, without variables of lines."""
    jammed = ld.jam(ld.bidisperse(24, seed=1)).packing
    law = ld.Ring(contact=contact)
    with ld.Simulation(jammed.at(jammed.phi + 0.02), law) as sim:
        state = sim.relax()
    exact = state.modes(vectors=False).stiffness.sum() / (2.0 * state.network_contacts)
    assert vibrations._spectrum(state, None)["stiffness"] == pytest.approx(exact, rel=1e-10)


def test_packings_are_near_the_wanted_distance() -> None:
    """p = 0.4 x of disks; all modes are counted, and K is the change of pressure with ln phi."""
    wanted = [1e-3, 1.01e-3]
    rows = measure("disk", 64, 2, wanted)
    for row, excess in zip(rows, wanted, strict=True):
        assert row["excess_phi"] == pytest.approx(excess, rel=0.3)
        assert row["pressure"] == pytest.approx(0.4 * excess, rel=1e-6)
        assert sum(row["counts"]) == row["modes"]
        assert row["residual"] < 1e-5
        # n n^T - (o/d) t t^T of each contact, with the mean overlap o of about 0.9 p
        assert 1.0 - row["stiffness"] == pytest.approx(row["pressure"], rel=0.5)
    first, second = rows
    change = (second["pressure"] - first["pressure"]) / np.log(second["phi"] / first["phi"])
    assert change == pytest.approx(first["bulk_modulus"], rel=0.01)
    assert [row["packings"] for row in summarize(rows)] == [1, 1]
