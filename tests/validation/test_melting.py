"""The study of melting: limits that are known exactly, what it measures, and its small run.

Means of motions are compared within 5 of their standard errors, by blocks that are longer than the
time in which the bath forgets, so that no processor and no seed decides.
"""

import json
import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from numpy.typing import NDArray

from validation.melting import __main__ as melting
from validation.melting import measure, results

pytest.importorskip("matplotlib")
pytest.importorskip("freud")

FOLDER = Path(__file__).parents[2] / "validation" / "melting"
RESULT = json.loads((FOLDER / "small.json").read_text())


def close(values: list[float], expected: float) -> None:
    """Whether the mean of a series is as expected, by 20 blocks after the first tenth."""
    blocks = np.array_split(np.array(values)[len(values) // 10 :], 20)
    found, error = ld.jackknife([block.mean() for block in blocks])
    assert abs(found - expected) < 5.0 * error, (found, expected, error)
    assert error < 0.1 * abs(expected)


def resting(number: int) -> tuple[ld.Packing, ld.State]:
    packing = measure.crystal(number, measure.PHI)
    with ld.Simulation(packing, measure.LAW) as sim:
        return packing, sim.relax(1e-10)


@pytest.mark.slow
def test_cold_crystal_is_harmonic() -> None:
    """Energy T/2 a mode, <u^2> = T sum 1/k / N by the modes of the Hessian, and order 1."""
    (packing, rest), temperature = resting(16), 1e-7
    stiffness = rest.modes(vectors=False).stiffness
    assert len(stiffness) == 30
    rows = []
    with ld.Simulation(packing, measure.LAW) as sim:
        sim.relax(1e-10)
        for state in sim.run(
            20_000, temperature=temperature, every=40, seed=1, drag=0.3, timestep=0.05
        )[1:]:
            u = state.displacements(rest)
            u -= u.mean(axis=0)
            rows.append((state.energy - rest.energy, np.sum(u**2), state.temperature))
    energy, squares, temperatures = np.transpose(rows)
    close(temperatures, temperature)
    close(energy, 15.0 * temperature)
    close(squares, temperature * np.sum(1.0 / stiffness))
    found = measure.measured(16, measure.PHI, state.packing.positions[None], state.hexatic()[None])
    assert math.hypot(found["psi_x"][0], found["psi_y"][0]) == pytest.approx(1.0, abs=1e-4)
    assert found["bragg"] == pytest.approx(1.0, abs=1e-4)
    assert found["defects"] == 0.0


def test_waves_of_a_harmonic_crystal_have_the_moduli_of_linear_response() -> None:
    """<u u> = T/H; lattices make short waves softer by (q a)^2/24, 6 % here at most."""
    packing, rest = resting(256)
    box, sites = packing.box.diagonal(), packing.positions
    hessian, moduli = rest.hessian().operator, rest.moduli()
    softness = []
    for wave in measure.waves(box):
        phases = sites @ wave
        across = np.array([-wave[1], wave[0]]) / np.hypot(*wave)
        for direction in (across, wave / np.hypot(*wave)):
            u = (np.cos(phases)[:, None] * direction).ravel()
            stiffness = u @ (hessian @ u) / (u @ u)  # <|u_q|^2> = T / (N stiffness)
            softness.append(box.prod() * (wave @ wave) / (len(sites) * stiffness))
    across, along = np.reshape(softness, (-1, 2)).mean(axis=0)
    assert 1.0 / across == pytest.approx(moduli.mean_shear_modulus, rel=0.04)
    expected = moduli.bulk_modulus + moduli.mean_shear_modulus
    assert 1.0 / along == pytest.approx(expected, rel=0.04)


def test_displacements_are_from_the_nearest_sites_of_a_lattice_that_drifts() -> None:
    """Particles may have changed their places, and a row may have slipped."""
    packing, rng = measure.crystal(64, measure.PHI), np.random.default_rng(1)
    u = 0.1 * rng.normal(size=(64, 2))
    u -= u.mean(axis=0)
    slipped = packing.positions.copy()
    slipped[:8, 0] += measure.spacing(packing)
    slipped[[20, 40]] = slipped[[40, 20]]
    found = measure.displacements(
        slipped + u + [3.3, -0.7], packing.positions, measure.spacing(packing)
    )
    assert found == pytest.approx(u, abs=2e-3)  # the drift is that of density waves


def test_softness_of_one_wave() -> None:
    packing = measure.crystal(64, measure.PHI)
    box, sites = packing.box.diagonal(), packing.positions
    q = measure.waves(box)
    wave, amplitude = q[3], 0.01
    u = amplitude * np.cos(sites @ wave)[:, None] * wave / np.hypot(*wave)
    across, along = measure.softness(u, sites, box)
    assert across == pytest.approx(0.0, abs=1e-12)
    expected = box.prod() * (wave @ wave) * (0.5 * amplitude) ** 2 / len(q)
    assert along == pytest.approx(expected)


@pytest.mark.slow
def test_second_virial_coefficient_by_energies_and_by_pressures() -> None:
    """The same by parts; cold droplets are hard disks of the radius 1, with B_2 = 2 pi."""
    for temperature in (0.005, 0.02):
        by_energy, by_pressure = measure.second_virial(temperature)
        assert by_pressure == pytest.approx(by_energy, rel=1e-3)
    assert measure.second_virial(1e-6)[0] == pytest.approx(2.0 * math.pi, rel=0.02)


def test_pressure_of_a_gas_without_contacts() -> None:
    packing = measure.crystal(16, 0.1)
    leg = measure.leg(16, 0.1, 0.1, 1, packing.positions, steps=measure.SAMPLES)
    assert leg["rows"][0]["pressure"] * packing.volume == pytest.approx(16 * 0.1)


def test_neighbors_of_the_crystal_and_of_random_points() -> None:
    packing = measure.crystal(36, measure.PHI)
    box = packing.box.diagonal()
    i, j = measure.neighbors(packing.positions, box)
    assert len(i) == 3 * 36
    between = measure.apart(box, packing.positions[j] - packing.positions[i])
    assert np.hypot(*between.T) == pytest.approx(np.full(108, measure.spacing(packing)))
    places = np.random.default_rng(1).random((200, 2)) @ packing.box
    packing = ld.Packing(places, 0.01, packing.box)
    pairs = measure.neighbors(places, box)
    assert len(pairs[0]) == 600
    with ld.Simulation(packing, ld.Ring()) as sim:
        sides = sim.state().cell_sides
    assert (np.bincount(np.concatenate(pairs), minlength=200) == sides).all()


def flipped(pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    """The first pair parts, and the two that were neighbors of both meet."""
    joined = {tuple(pair) for pair in pairs.T.tolist()}
    i, j = pairs[:, 0].tolist()
    around = [{a + b - k for a, b in joined if k in (a, b)} for k in (i, j)]
    joined.remove((i, j))
    joined.add(tuple(sorted(around[0] & around[1])))
    return np.array(sorted(joined)).T


def test_defects_of_a_bond_that_flips() -> None:
    """Two particles of 5 and two of 7 neighbors: dislocations that are bound."""
    packing = measure.crystal(64, measure.PHI)
    pairs = measure.neighbors(packing.positions, packing.box.diagonal())
    assert not any(measure.defects(pairs, 64).values())
    found = measure.defects(flipped(pairs), 64)
    assert found["defects"] == 4 / 64
    assert found["bound"] == 1 / 64
    assert found["dislocations"] == found["larger"] == found["disclinations"] == 0.0
    found = measure.defects(pairs[:, 1:], 64)  # two particles with 5, apart
    assert found["defects"] == 2 / 64
    assert found["disclinations"] == 2 / 64


def test_waves_and_correlations_of_the_crystal() -> None:
    packing = measure.crystal(144, measure.PHI)
    box, places = packing.box.diagonal(), packing.positions + 0.3
    length = 4.0 * np.pi / (math.sqrt(3.0) * measure.spacing(packing))
    wave, strength = measure.strongest_wave(places, box, length)
    assert strength == pytest.approx(1.0)
    assert np.hypot(*wave) == pytest.approx(length)
    _, sums, pairs = measure.correlation(places, box, np.exp(1j * places @ wave))
    assert sums == pytest.approx(pairs)
    assert pairs[0] == 0.0 < pairs.max()
    random = np.random.default_rng(1).random((1000, 2)) @ packing.box
    assert measure.strongest_wave(random, box, length)[1] < 0.03


@pytest.mark.slow
def test_interrupted_ramps_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second call reads the legs that are kept; each begins where the last one ended."""
    monkeypatch.setattr(measure, "kept", short(50))
    ramp = melting.ramp(16, measure.PHI, "crystal", 1, ((0.01, 2), (0.02, 1)), tmp_path)
    assert [leg["T"] for leg in ramp["legs"]] == [0.01, 0.01, 0.02]
    assert ramp["ended"] == 0
    start = measure.begin(16, measure.PHI, "crystal", 1)
    one = measure.leg(16, measure.PHI, 0.01, 1001, start, steps=50)
    two = measure.leg(16, measure.PHI, 0.01, 1002, one["places"][-1], steps=50)
    for leg, found in zip(ramp["legs"], (one, two), strict=False):
        assert leg["energy"] == np.mean([row["energy"] for row in found["rows"]])
    assert (ramp["ends"][0][1] == two["places"][-1]).all()
    monkeypatch.setattr(ld.Simulation, "run", None)
    again = melting.ramp(16, measure.PHI, "crystal", 1, ((0.01, 2), (0.02, 1)), tmp_path)
    assert again["legs"] == ramp["legs"]


def short(steps: int):  # type: ignore[no-untyped-def]
    """As `kept`, with short legs."""
    usual = measure.kept

    def kept(function, arguments, folder):  # type: ignore[no-untyped-def]
        if function is measure.leg:
            arguments = (*arguments, measure.LAW, measure.BATH, steps)
        return usual(function, arguments, folder)

    return kept


def test_legs_without_a_shape_begin_anew_and_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual, seeds = short(50), []

    def sometimes(function, arguments, folder):  # type: ignore[no-untyped-def]
        if function is not measure.leg:
            return usual(function, arguments, folder)
        seeds.append(arguments[3])
        failed = len(seeds) == 1
        return {"ended": "no shape"} if failed else usual(function, arguments, folder)

    monkeypatch.setattr(measure, "kept", sometimes)
    ramp = melting.ramp(16, measure.PHI, "crystal", 1, ((0.01, 1),), tmp_path)
    assert ramp["ended"] == 1
    assert seeds == [1001, 101_001]
    monkeypatch.setattr(measure, "kept", lambda *_: {"ended": "no shape"})
    with pytest.raises(RuntimeError, match=r"T = 0\.01: no shape"):
        melting.ramp(16, measure.PHI, "crystal", 1, ((0.01, 1),), tmp_path)


def test_a_leg_ends_where_a_droplet_finds_no_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_shape(*_: object, **__: object) -> None:
        raise ld.LammpsError("no shape")

    monkeypatch.setattr(ld.Simulation, "run", no_shape)
    start = measure.crystal(16, measure.PHI).positions
    assert measure.leg(16, measure.PHI, 0.01, 1, start)["ended"] == "no shape"


def test_decay_of_a_power_is_its_exponent() -> None:
    r = np.linspace(1.0, 20.0, 20)
    legs = [{"r": r, "g6": r**-0.25}]
    assert results.decay(legs, "g6") == pytest.approx(0.25)
    assert results.decay(legs, "g6", 8.0, 16.0) == pytest.approx(0.25)
    legs[0]["r"] = 0.4 * r  # half of a small box
    assert math.isnan(results.decay(legs, "g6"))


def test_time_in_which_order_is_forgotten() -> None:
    """A series that forgets a part 1 - c in a sample: the integral is (1 + c)/(2 - 2c)."""
    c, samples, noise = 0.8, [0.0], np.random.default_rng(1).normal(size=40_000)
    for each in noise:
        samples.append(c * samples[-1] + each)
    leg = {"psi_x": 100.0 + np.array(samples), "psi_y": np.zeros(len(samples))}
    expected = results.LEG / len(samples) * (1.0 + c) / (2.0 - 2.0 * c)
    assert results.memory([leg]) == pytest.approx(expected, rel=0.1)


def test_exponents_by_size() -> None:
    small, large = (
        [{"number": n, "T": 0.1, "bragg": b * math.sqrt(n) ** -0.3} for b in (1.0, 1.1, 0.9)]
        for n in (256, 1024)
    )
    assert results.between_sizes(small, large, "Bragg")[0] == pytest.approx(0.3)
