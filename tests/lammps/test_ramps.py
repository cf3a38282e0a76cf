"""Stiffnesses and tensions that fix adapt changes in a run."""

import numpy as np
import pytest
from laws import EXACT, RADICAL, RING_LAWS, two_laws
from materials import pushed
from scene import PACKINGS, Scene
from test_refusals import refuses
from turns import in_turn

VALUES = {"kA": (1.0, 3.0), "kP": (0.1, 0.7), "tension": (0.01, 0.05)}
TEXT = "a 0.5 {kA} {kP} tension {tension}\nb 0.7 1.0 0.3 tension 0.02\n"


def scene(tmp_path, style, hybrid=False, **values):
    """Droplets `a` of these values beside others."""
    file = tmp_path / "species.txt"
    file.write_text(TEXT.format(**{name: pair[0] for name, pair in VALUES.items()} | values))
    case = PACKINGS[0]
    coeff = f"pair_coeff * * {'deformable/ring ' if hybrid else ''}{file} a b"
    names = ["small" if t == 1 else "large" for t in case["type"]]
    if names[0] == "large":
        coeff = coeff.replace("a b", "b a")
    box = (0, case["L"], 0, case["L"])
    style = f"hybrid/overlay {style} zero 1.0" if hybrid else style
    if hybrid:
        coeff += "\npair_coeff * * zero"
    return Scene(case["x"], names, box, style, coeff=coeff)


def type_of_a(some):
    return some.types.index("small") + 1


def adapt(some, name, value, more=""):
    a = type_of_a(some)
    some.run(
        f"variable v equal {value}\n"
        f"fix ramp all adapt 1 pair deformable/ring {name} {a} {a} v_v {more}"
    )


@pytest.mark.parametrize(("name", "law"), in_turn(VALUES, RING_LAWS))
def test_forces_at_every_value(name, law, tmp_path):
    """Along a trajectory with a ramp, as of a new file with the value of that step."""
    first, last = VALUES[name]
    some = scene(tmp_path, EXACT[law])
    adapt(some, name, f"{first}+({last}-{first})*step/40")
    some.run("fix nve all nve\ntimestep 0.02\nvelocity all create 1e-4 4711 loop all")
    some.run("run 20")
    middle = some.lmp.extract_variable("v", None, 0)
    assert first < middle < last
    energy, x = some.lmp.get_thermo("pe"), some.x
    force = some.gather("f", 3)[:, :2]
    fresh = scene(tmp_path, EXACT[law], **{name: repr(middle)}).evaluate(x)
    assert energy == pytest.approx(fresh.energy, rel=1e-9)
    np.testing.assert_allclose(force, fresh.force, rtol=0, atol=1e-9 * np.abs(fresh.force).max())
    other = scene(tmp_path, EXACT[law]).evaluate(x)
    assert abs(other.energy / energy - 1) > 1e-3


@two_laws
def test_below_a_hybrid_style(law, tmp_path):
    some = scene(tmp_path, EXACT[law], hybrid=True)
    adapt(some, "tension", 0.03)
    found = some.evaluate(pushed(PACKINGS[0]))
    fresh = scene(tmp_path, EXACT[law], tension=0.03).evaluate(pushed(PACKINGS[0]))
    assert found.energy == pytest.approx(fresh.energy, rel=1e-12)


@two_laws
def test_reset(law, tmp_path):
    """`reset yes` gives the species its first value back after the run, and a later fix that."""
    some = scene(tmp_path, EXACT[law])
    before = some.energy()
    adapt(some, "kA", 2.5, "reset yes")
    changed = some.energy()
    some.run("unfix ramp\nvariable v delete")
    assert some.energy() == pytest.approx(before, rel=1e-11)
    assert abs(changed / before - 1) > 1e-3
    adapt(some, "kA", 1.0, "scale yes")
    assert some.energy() == pytest.approx(before, rel=1e-11)


def test_soft_from_stiff(tmp_path):
    """The first finite value of kP of a species that conserved its perimeter, and back."""
    file = tmp_path / "stiff.txt"
    file.write_text("a 0.5 1 inf\nb 0.7 1 inf\n")
    for law in EXACT.keys() - {"sector"}:
        some = scene(tmp_path, EXACT[law])
        some.run(f"pair_coeff * * {file} a b")
        stiff = some.energy()
        some.run(
            "variable v equal 1e3\nfix ramp all adapt 1 pair deformable/ring kP * * v_v reset yes"
        )
        assert some.energy() < stiff
        some.run("unfix ramp")
        assert some.energy() == pytest.approx(stiff, rel=1e-11)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("kA", 0.0, "Species a.*kA.*not 0"),
        ("tension", -0.1, "Species a.*floppy"),
        ("tension", 5.0, "Species a.*collapse"),
        ("kP", -1.0, "Species a.*kP.*not -1"),
    ],
)
def test_refusals(name, value, message, tmp_path):
    some = scene(tmp_path, RADICAL)
    adapt(some, name, value)
    with pytest.raises(Exception, match=message):
        some.energy()


def test_unknown_parameter(tmp_path):
    some = scene(tmp_path, RADICAL)
    adapt(some, "skin", 0.1)
    with pytest.raises(Exception, match="skin not supported"):
        some.energy()


def test_values_of_two_types(tmp_path):
    """They would have no effect. Wildcards that include the type itself are fine."""
    some = scene(tmp_path, EXACT["balanced"])
    some.run("variable v equal 2.5\nvariable w equal 0.5")
    for types in ("* *", "1* 2"):
        some.run(f"fix ramp all adapt 1 pair deformable/ring kA {types} v_v\nrun 0\nunfix ramp")
    some.run("fix ramp all adapt 1 pair deformable/ring kA 1 2 v_w")
    with refuses("kA of types 1 and 2.*same type twice"):
        some.run("run 0")
