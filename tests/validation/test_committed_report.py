"""The report in validation/report agrees with README and docs; `slow` tests measure again."""

import json
import math
from pathlib import Path

import pytest

from validation.report.accuracy import energy_errors, exceptions
from validation.report.packings import mixed_rows

REPORT = json.loads(
    (Path(__file__).parents[2] / "validation" / "report" / "report.json").read_text()
)


def rows(name, **wanted):
    found = [
        row for row in REPORT[name] if all(row.get(key) == value for key, value in wanted.items())
    ]
    assert found
    return found


def test_it_is_a_full_one():
    assert not REPORT["quick"]


def test_each_law_is_right_in_its_regime():
    irregular = {"polygon": "irregular", "n_v": 188, "kL": 1e4}
    for row in rows("single", walls="stick", **irregular):
        assert row["I_sector"] < 1e-4
        assert row["I_sector"] < row["I_ring_kP_inf"]
    for row in rows("single", walls="slip", **irregular):
        assert row["I_ring_kP_inf"] < 5e-4
        assert row["I_ring_kP_inf"] < row["I_sector"]
        assert row["I_ring_kP_inf_steiner"] < 1e-4


def test_the_ring_law_has_the_stiffness_of_the_springs():
    """Soft springs: the law of their stiffness is ten times nearer than those of kP = inf."""
    for row in rows("single", n_v=314, walls="stick", kL=1.0):
        assert row["I_ring"] < 0.1 * min(row["I_sector"], row["I_ring_kP_inf"])


def test_stability():
    """The ring laws keep within all limits; each failure of the sector law has a reason.

    Curved contacts at phi = 1.2 are far beyond the model: one line may say so.
    """
    missed = [row for row in REPORT["stability"] if not row["ok"]]
    crowded = [row for row in missed if row["law"] == "curved"]
    assert {row["case"] for row in crowded} <= {"phi 0.5 to 1.2"}
    assert all("reach" in row["reason"] for row in crowded if row["quantity"] == "states refused")
    others = [row for row in missed if row not in crowded]
    assert {row["law"] for row in others} == {"sector"}
    assert all(row["reason"] for row in others)


def test_lists():
    """What the page and the docs name, and nothing that a section no longer shows."""
    assert {name for name, value in REPORT.items() if isinstance(value, list)} == {
        *("smooth", "pareto", "friction", "hysteresis", "crystal"),
        *("single", "packing", "stiffness_packing", "ablation", "limit", "stability"),
    }
    laws = {"disk", "sector", "radical, kP inf", "radical", "balanced", "curved"}
    assert {row["law"] for row in REPORT["smooth"]} == laws - {"disk"}
    assert {row["law"] for row in REPORT["packing"]} == laws
    assert {row["law"] for row in REPORT["stiffness_packing"]} == {*laws, "balanced, kP inf"}
    assert {row["n_v"] for row in REPORT["single"]} == {188, 314}


def test_beads_tend_to_the_exact_area_deficit():
    for limit in REPORT["limit"]:
        assert limit["rate_n_v"] == pytest.approx(-2.0, abs=0.1)
        assert limit["rate_kP"] == pytest.approx(-1.0, abs=0.1)


def test_speed_up():
    """A thousand times, with contacts on the radical axis, at N = 128 and 1 %."""
    (row,) = rows("packing", n=128, strain=0.01, law="radical, kP inf")
    assert row["seconds_polygons"] / row["seconds"] > 1000.0


def test_balanced_is_right_along_compressions():
    """On its own: 1 % in energy to 3 % strain, 2 % to 4.5 %; every exception has its reason.

    Against rings of 160 vertices there are four from 1 % strain on, by at most 0.45 %. There the
    law with curved contacts agrees with them to 0.3 %: the lines of `balanced` are to blame.
    """
    balanced = rows("smooth", law="balanced", own=True)
    for count in (80, 160):
        found = [row for row in balanced if row["n_v"] == count]
        seeds = {row["seed"] for row in found}
        assert len(seeds) >= 3
        steps = [(row["seed"], round(1000 * row["strain"])) for row in found]
        assert sorted(steps) == sorted((seed, n) for seed in seeds for n in range(5, 55, 5))
    missed = exceptions(REPORT["smooth"])
    assert all(row["reason"] for row in missed)
    fine = [row for row in missed if row["n_v"] == 160 and row["strain"] > 0.0075]
    assert len(fine) <= 4
    assert all(abs(row["energy_ratio"] - 1.0) < row["bar"] + 0.0045 for row in fine)
    for row in fine:
        same = {key: row[key] for key in ("seed", "strain", "n_v", "own")}
        (curved,) = rows("smooth", law="curved", **same)
        assert abs(curved["energy_ratio"] - 1.0) < 0.003
    for row in balanced:
        if row["n_v"] == 160 and row["strain"] > 0.0075:
            assert row["residual"] <= 1e-6
            assert abs(row["pressure_ratio"] - 1.0) < 0.035
            assert row["S_rms"] < 0.02


def test_curved_is_right_along_compressions():
    """Energy to 0.05 % of polygons of very many vertices from 2 to 5 % strain, areas to 0.3 %.

    At 1 % the polygons are not known better than 0.5 %: contacts of those of 160 vertices are
    hardly longer than their spacing.
    """
    found = energy_errors(REPORT["smooth"], "curved")
    assert {0.01, 0.02, 0.03, 0.04, 0.05} <= {round(strain, 9) for strain in found}
    for strain, errors in found.items():
        if strain > 0.0095:
            assert max(errors) < (5e-3 if strain < 0.0195 else 5e-4)
    for row in rows("smooth", law="curved", own=True, n_v=320):
        if row["strain"] > 0.0095:
            assert row["S_rms"] < 3e-3


def test_balanced_is_far_better_than_the_other_laws():
    (balanced,) = rows("pareto", method="balanced")
    for law in ("radical", "radical, kP inf", "sector"):
        (other,) = rows("pareto", method=law)
        assert other["error"] > 10.0 * balanced["error"]
        assert other["energy_error"] > 10.0 * balanced["energy_error"]


def test_rings_as_right_as_the_balanced_law_take_a_hundred_times_as_long():
    (balanced,) = rows("pareto", method="balanced")
    assert 0.003 < balanced["energy_error"] < 0.01
    as_good = [
        row
        for kind in ("smooth", "bead")
        for row in rows("pareto", method=kind)
        if row["energy_error"] <= balanced["energy_error"]
    ]
    assert {row["method"] for row in as_good} == {"smooth"}
    assert min(row["seconds"] for row in as_good) > 100.0 * balanced["seconds"]


def test_smooth_polygons_are_smooth():
    """Bead polygons catch, smooth ones do not; near jamming a packing may find another minimum."""
    for row in rows("friction", smooth=False):
        assert row["friction"] > 0.2
    for row in rows("friction", smooth=True):
        if row["n_v"] >= 80:
            assert row["friction"] < 0.005
    back = [row for row in rows("hysteresis", smooth=True) if row["strain"] > 0.0125]
    assert back
    assert all(abs(row["ratio"] - 1.0) < 0.0003 for row in back)
    caught = [row for row in rows("hysteresis", smooth=False) if 0.0075 < row["strain"] < 0.0175]
    assert all(abs(row["ratio"] - 1.0) > 0.03 for row in caught)
    for indentation in (0.01, 0.03):
        errors = {
            row["n_v"]: abs(row["energy_ratio"] - 1.0)
            for row in rows("crystal", indentation=indentation)
        }
        assert errors[160] < errors[80] < 0.0035


def test_mixtures_of_unequal_stiffness():
    """The law with the rings' own values; in one packing it rests in another place than they."""
    found = rows("stiffness_packing", n=16, law="balanced")
    assert sum(abs(row["own_energy_ratio"] - 1.0) > 0.05 for row in found) <= 1
    for row in found:
        assert row["I"] < 6e-4
        assert row["S_rms"] < 0.03
        assert abs(row["energy_ratio"] - 1.0) < 0.05
        same = {key: row[key] for key in ("strain", "seed", "kA", "kP")}
        (radical,) = rows("stiffness_packing", **same, law="radical, kP inf")
        assert row["S_rms"] < 0.1 * radical["S_rms"]


@pytest.mark.slow
def test_a_mixture_is_that_of_the_report():
    """Rings that have converged have one energy: areas agree to a hundredth of their error."""
    for row in mixed_rows(16, 1, 0.02, 76, (1.0, 10.0), (0.1, math.inf)):
        same = {key: row[key] for key in ("seed", "kA", "kP", "law")}
        (kept,) = rows("stiffness_packing", **same)
        assert row["S_rms"] == pytest.approx(kept["S_rms"], rel=0.1)
