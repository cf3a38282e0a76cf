"""Droplets in three dimensions beside other commands: results are those of a fresh run.

Each entry is a command of docs/works_with.md.
"""

import pytest
from combinations import assert_same
from droplets import EXACT
from emulsion import TEMPERATURE, Emulsion
from test_works_with import AT_END_OF_STEP, ENERGY, NVE, WITH_BATH, of

T, BAROSTAT = f"{TEMPERATURE} {TEMPERATURE}", "iso 0.04 0.04 20"
SPLIT = "group some id 1:5\ngroup rest subtract all some\n"
TRICLINIC = "change_box all triclinic\n"
FIXES = {
    "fix nve": of(NVE, conserves=ENERGY),
    "fix nve/limit": of("fix move all nve/limit 0.01", conserves=ENERGY),
    "fix nve/sphere": of("fix move all nve/sphere", conserves=ENERGY, atoms="sphere 1"),
    "fix nvt": of(f"fix move all nvt temp {T} 50", conserves=WITH_BATH),
    "fix nph": of(f"fix move all nph {BAROSTAT} pchain 0", conserves=WITH_BATH),
    "fix npt": of(f"fix move all npt temp {T} 50 iso 0.04 0.04 100 pchain 0", conserves=WITH_BATH),
    "fix npt in a tilted box": of(
        f"{TRICLINIC}fix move all npt temp {T} 50 x 0.04 0.04 100 y 0.04 0.04 100 yz 0 0 100"
    ),
    "fix press/berendsen": of(NVE + f"fix b all press/berendsen {BAROSTAT} modulus 0.1"),
    "fix nvt/sllod": of(
        f"{TRICLINIC}fix d all deform 1 xy erate 0.02 remap v\nfix move all nvt/sllod temp {T} 5"
    ),
    "fix deform": of(NVE + "fix d all deform 1 x scale 0.995 z erate -0.001 remap x"),
    "fix deform with remap v": of(NVE + "fix d all deform 1 x erate -0.001 remap v"),
    "fix deform with flips": of(NVE + TRICLINIC + "fix d all deform 1 xz erate 0.2 remap x"),
    "fix langevin": of(NVE + f"fix b all langevin {T} 5 4711 tally yes", conserves=WITH_BATH),
    "fix temp/csvr": of(NVE + f"fix b all temp/csvr {T} 5 4711", conserves=WITH_BATH),
    "fix brownian": of(f"fix move all brownian {TEMPERATURE} 4711 gamma_t 1"),
    "fix viscous": of(NVE + "fix b all viscous 0.05"),
    "fix deformable/propel": of(NVE + "fix b all deformable/propel 1e-3 20 4711"),
    "fix setforce": of(
        SPLIT + "velocity some set 0 0 0\n" + NVE + "fix b some setforce 0 0 0", conserves=ENERGY
    ),
    "fix gravity": of(NVE + "fix b all gravity 1e-4 vector 0 0 -1"),
    "fix spring/self": of(
        NVE + "fix b all spring/self 0.01\nfix_modify b energy yes", conserves=ENERGY
    ),
    "fix move": of(SPLIT + "fix m some move linear 0.02 0 0\nfix move rest nve"),
    "fix rigid": of(SPLIT + "fix m some rigid single\nfix move rest nve", conserves=ENERGY),
    "fix momentum": of(NVE + "fix b all momentum 5 linear 1 1 1 angular"),
    "fix adapt": of(
        "variable grow equal 0.99+1e-5*step\nfix b all adapt 1 atom diameter v_grow scale yes\n"
        + NVE,
        atoms="sphere 1",
        words=" radius atom",
    ),
    "fix deposit": of(
        "change_box all x scale 2.0\nregion r block 6.5 7.3 0 5 0 5\n"
        + NVE
        + "fix b all deposit 3 1 10 4711 region r near 2.1"
    ),
    "fix evaporate": of("region r block 0 5 0 5 0 5\n" + NVE + "fix b all evaporate 20 1 r 1"),
    "fix atom/swap": of(NVE + "fix b all atom/swap 10 2 4711 0.1 ke no types 1 2"),
    "fix gcmc": of(NVE + f"fix b all gcmc 10 5 5 1 4711 {TEMPERATURE} 0.3 0.1"),
    "fix widom": of(NVE + f"fix b all widom 10 5 1 4711 {TEMPERATURE}"),
    "fix nvt/uef": of(f"{TRICLINIC}fix move all nvt/uef temp {T} 5 erate 0.002 0.002"),
    "fix nphug": of(f"fix move all nphug temp {T} 50 x 0.04 0.04 100"),
    "fix msst": of("fix move all msst x 0.1 q 100 mu 0.1"),
    "fix viscosity": of(NVE + "fix b all viscosity 10 x y 10", conserves=ENERGY),
    "fix thermal/conductivity": of(
        NVE + "fix b all thermal/conductivity 10 z 10", conserves=ENERGY
    ),
    "fix ehex": of(NVE + "fix b all ehex 1 1e-9"),
    "fix flow/gauss": of(NVE + "fix b all flow/gauss 1 0 0"),
    "fix wall/flow": of(NVE + f"fix b all wall/flow x 0.01 {TEMPERATURE} 4711 2 1.0 3.0"),
    "fix wall/reflect": of(
        "change_box all boundary p p f\nvelocity all zero linear\n"
        + NVE
        + "fix b all wall/reflect zlo EDGE zhi EDGE"
    ),
    "fix balance": of(NVE + "fix b all balance 20 1.0 shift xyz 5 1.1", conserves=ENERGY),
}
MINIMIZE = "minimize 0 1e-10 200 400\nrun 0"
COMMANDS = {
    "change_box": of("change_box all x scale 0.999 z scale 0.999 remap", "run 0"),
    "change_box to a tilted box": of(
        TRICLINIC + "change_box all xy delta 0.5 yz delta -0.9 remap", "run 0"
    ),
    "change_box with boundary": of("change_box all boundary f p f", "run 0"),
    "replicate": of("replicate 2 3 1", "run 0"),
    "create_atoms": of(
        "change_box all x scale 2.0\ncreate_atoms 1 random 3 4711 NULL overlap 2.1 maxtry 9999",
        "run 0",
    ),
    "delete_atoms": of("delete_atoms random count 5 yes all NULL 4711 compress no", "run 0"),
    "displace_atoms": of("displace_atoms all random 0.02 0.02 0.02 4711", "run 0"),
    "set": of("set atom 1*4 type 1", "run 0"),
    "reset_atoms": of("delete_atoms random count 5 yes all NULL 1\nreset_atoms id", "run 0"),
    "minimize": of("min_style fire", MINIMIZE),
    "min_style deformable/lbfgs": of("min_style deformable/lbfgs", MINIMIZE),
    "min_style cg": of("min_style cg", MINIMIZE),
    "min_style sd": of("min_style sd", MINIMIZE),
    "min_style hftn": of("min_style hftn", MINIMIZE),
    "min_style quickmin": of("min_style quickmin", MINIMIZE),
    "fix box/relax": of("fix b all box/relax iso 0.04 vmax 1e-3", "minimize 0 0 50 100\nrun 0"),
    "run_style respa": of(NVE + "run_style respa 2 2 pair 2", "run 50\nrun_style verlet\nrun 0"),
    "pair_modify nofdotr": of(NVE + "pair_modify nofdotr", conserves=ENERGY),
    "neighbor": of(NVE + "neighbor 0.5 nsq", conserves=ENERGY),
    "neighbor multi": of(NVE + "neighbor 0.1 multi\ncomm_modify mode multi", conserves=ENERGY),
    "neigh_modify": of(NVE + "neigh_modify every 2 delay 4 check no", conserves=ENERGY),
    "comm_modify": of(NVE + "comm_modify cutoff 6 vel yes", conserves=ENERGY),
    "comm_style tiled": of(NVE + "comm_style tiled\nbalance 1.0 rcb", conserves=ENERGY),
    "atom_modify sort": of(NVE + "atom_modify sort 1 1.0", conserves=ENERGY),
}


@pytest.mark.parametrize("name", [*FIXES, *COMMANDS])
def test_as_a_fresh_run(name, tmp_path):
    row = {**FIXES, **COMMANDS}[name]
    scene = Emulsion(tmp_path, style=EXACT + row.words, atoms=row.atoms)
    scene.run(row.setup)
    before = scene.conserved(row.conserves)
    scene.run(row.go.replace("run 200", "run 100"))
    after = scene.conserved(row.conserves)
    if any(word in name for word in AT_END_OF_STEP):
        scene.run("run 0")
    assert_same(scene.results(), scene.fresh(tmp_path).results())
    if row.conserves:
        part = 5e-3 if "langevin" in name else 1e-3
        assert after == pytest.approx(before, abs=part * scene.value("ke"))
