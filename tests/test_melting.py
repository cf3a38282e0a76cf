"""The example of melting: limits that are known exactly, and its committed rows.

Means of motions are compared within 5 of their standard errors, by blocks that are longer than the
time in which the bath forgets, so that no processor and no seed decides.
"""

import json
import math
from pathlib import Path

import deformable
import numpy as np
import pytest
from example_modules import example

pytest.importorskip("matplotlib")
pytest.importorskip("freud")

FOLDER = Path(__file__).parents[1] / "examples" / "melting"
melting = example("melting", "melting")
results = melting.results
RESULT, MIDDLE = (json.loads((FOLDER / f"{n}.json").read_text()) for n in ("small", "middle"))
README = (FOLDER / "README.md").read_text()


def close(values: list[float], expected: float) -> None:
    """Whether the mean of a series is as expected, by 20 blocks after the first tenth."""
    blocks = np.array_split(np.array(values)[len(values) // 10 :], 20)
    found, error = deformable.jackknife(np.mean, [block.mean() for block in blocks])
    assert abs(found - expected) < 5.0 * error, (found, expected, error)
    assert error < 0.1 * abs(expected)


def test_cold_crystal_is_harmonic() -> None:
    """Energy T/2 a mode, <u^2> = T sum 1/k / N by the modes of the Hessian, and order 1."""
    packing, temperature = melting.crystal(16), 1e-7
    with deformable.Simulation(packing, melting.LAW) as sim:
        rest = sim.relax(1e-10)
        stiffness = rest.modes(vectors=False).stiffness
        assert len(stiffness) == 30
        rows = []
        for state in deformable.move(
            sim, 20_000, temperature=temperature, every=40, seed=1, friction=0.3, timestep=0.05
        ):
            u = state.displacements(rest)
            u -= u.mean(axis=0)
            rows.append((state.energy - rest.energy, np.sum(u**2), state.temperature))
    energy, squares, temperatures = np.transpose(rows)
    close(temperatures, temperature)
    close(energy, 15.0 * temperature)
    close(squares, temperature * np.sum(1.0 / stiffness))
    row = melting.measure(state, temperature)
    assert math.hypot(row["psi_x"], row["psi_y"]) == pytest.approx(1.0, abs=1e-4)
    assert row["bragg"] == pytest.approx(1.0, abs=1e-4)
    assert row["defects"] == 0.0


def test_second_virial_coefficient_by_energies_and_by_pressures() -> None:
    """The same by parts; cold droplets are hard disks of the radius 1, with B_2 = 2 pi."""
    for temperature in (0.005, 0.02):
        by_energy, by_pressure = melting.second_virial(temperature)
        assert by_pressure == pytest.approx(by_energy, rel=1e-3)
    assert melting.second_virial(1e-6)[0] == pytest.approx(2.0 * math.pi, rel=0.02)


def test_pressure_of_a_gas_without_contacts() -> None:
    with deformable.Simulation(melting.crystal(16, 0.1), melting.LAW) as sim:
        state = sim.state()
    assert melting.pressure(state, 0.3) * state.packing.area == pytest.approx(16 * 0.3)


def test_neighbors_of_the_crystal() -> None:
    packing = melting.crystal(36)
    i, _, between = melting.neighbors(packing, 1.4 * melting.spacing(packing))
    assert len(i) == 3 * 36
    assert np.hypot(*between.T) == pytest.approx(np.full(108, melting.spacing(packing)))


def test_interrupted_runs_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second call reads the legs that are kept; each begins where the last one ended."""
    monkeypatch.chdir(tmp_path)
    plan, saved = {16: ((0.01,), 2, 80)}, []
    legs = melting.measured(plan, "short", 1, lambda found: saved.append(len(found)))
    assert saved == [2, 4]
    one = melting.leg(16, 0.01, "crystal", 1, 80, melting.started(16, "crystal"))
    two = melting.leg(16, 0.01, "crystal", 2, 80, one["positions"])
    assert [legs[0]["series"], legs[2]["series"]] == [one["series"], two["series"]]
    monkeypatch.setattr(melting.deformable, "move", None)
    again = melting.measured(plan, "short", 1, lambda found: None)
    assert again == legs
    assert list(results.runs({"legs": legs})) == [(16, 0.01, "crystal"), (16, 0.01, "random")]


def test_runs_end_where_a_droplet_finds_no_shape(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_shape(*_: object, **__: object) -> None:
        raise deformable.LammpsError("no shape")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(melting.deformable, "move", no_shape)
    legs = melting.measured({16: ((0.01,), 3, 80)}, "hot", 1, lambda found: None)
    assert [leg["ended"] for leg in legs] == ["no shape"] * 2
    assert results.runs({"legs": legs}) == {}


def test_decay_of_a_power_is_its_exponent() -> None:
    r = np.linspace(1.0, 20.0, 20)
    legs = [{"r": r, "g6": r**-0.25}]
    assert results.decay(legs) == pytest.approx(0.25)


def test_readme_has_the_committed_numbers() -> None:
    for lines in (results.table, results.start_table):
        for data in (RESULT, MIDDLE):
            assert "\n".join(lines(data)) in README
    text = README.replace("\n  ", " ").replace("\n", " ")
    assert results.summary(RESULT) in text
    assert results.summary(RESULT) in (FOLDER / "small.log").read_text()
    hot = [results.runs(RESULT)[64, 0.1, start] for start in melting.STARTS]
    apart = [results.difference(*hot, name) for name in ("psi_6", "defects", "p", "energy")]
    worst = max(abs(value) / error for value, error in apart)
    assert f"agree within {worst:.1f} of their errors" in text


def test_committed_crystal_of_256_droplets_melts_at_lower_temperatures() -> None:
    """Its order falls to less than half of that of 64 droplets, and the neighbors part."""
    small, middle = (
        results.runs(data)[number, 0.08, "crystal"]
        for number, data in ((64, RESULT), (256, MIDDLE))
    )
    orders, parts = (
        [results.value(legs, name)[0] for legs in (small, middle)]
        for name in ("psi_6", "neighbors apart")
    )
    assert orders[1] < 0.5 * orders[0]
    assert parts[0] < 0.05 < 0.5 < parts[1]
    cold = results.runs(MIDDLE)[256, 0.06, "crystal"]
    assert results.value(cold, "neighbors apart")[0] < 0.05
    hot = [results.runs(MIDDLE)[256, 0.1, start] for start in melting.STARTS]
    for name in ("psi_6", "defects", "p", "energy"):
        value, error = results.difference(*hot, name)
        assert abs(value) < error, name


@pytest.mark.parametrize("temperature", [0.02, 0.06, 0.08])
def test_the_committed_crystal_has_less_energy_and_pressure(temperature: float) -> None:
    """Than the run from random positions, which keeps defects."""
    both = [results.runs(RESULT)[64, temperature, start] for start in melting.STARTS]
    for name in ("energy", "p", "defects"):
        value, error = results.difference(*both, name)
        assert value < -3.0 * error, name


def test_committed_gas_follows_virial_coefficients() -> None:
    """The next terms are 0.53 x^3 for hard disks, and 5 standard errors of the motion."""
    for thin in RESULT["dilute"]:
        x = 2.0 * thin["phi"]
        assert abs(thin["z"] - thin["virial"]) < 5.0 * thin["error"] + 0.7 * x**3


def test_committed_baths_have_their_temperature() -> None:
    for legs in [*results.runs(RESULT).values(), *results.runs(MIDDLE).values()]:
        found, error = results.value(legs, "T over bath")
        assert abs(found - 1.0) < 5.0 * max(error, 0.01)
