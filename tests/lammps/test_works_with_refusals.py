"""Commands that the pair styles refuse, by one line and before the first step."""

import pytest
from combinations import Packing
from laws import EXACT
from test_refusals import refuses

GROUP = "group some id 1:5\n"
REFUSED = {
    "compute group/group": (
        GROUP + "compute c some group/group all\nthermo_style custom step c_c\nrun 0",
        "not support compute group/group",
    ),
    "compute pair/local": (
        "compute c all pair/local eng\ncompute r all reduce sum c_c inputs local\n"
        "thermo_style custom step c_r\nrun 0",
        "not support compute pair/local",
    ),
    "compute centroid/stress/atom": (
        "compute c all centroid/stress/atom NULL pair\ncompute r all reduce sum c_c[1]\n"
        "thermo_style custom step c_r\nrun 0",
        "not support compute centroid/stress/atom",
    ),
    "compute stress/mop": (
        "compute c all stress/mop x 2.0 total\nthermo_style custom step c_c[1]\nrun 0",
        "not support compute stress/mop",
    ),
    "compute stress/cartesian": (
        "compute c all stress/cartesian x 0.1 NULL 0\nrun 0",
        "not support compute stress/cartesian",
    ),
    "compute born/matrix": ("compute c all born/matrix", "not support compute born/matrix"),
    "pair_write": ("pair_write 1 1 10 r 0.5 1.2 file X", "not support pair_write"),
    "fix adapt pair": (
        "variable v equal 1\nfix a all adapt 1 pair {name} reach * * v_v\nrun 0",
        "reach not supported",
    ),
    "run_style respa inner": (
        "run_style respa 2 2 inner 1 0.5 0.6 outer 2\nfix m all nve\nrun 1",
        "rRESPA",
    ),
    "min_style deformable/lbfgs with fix box/relax": (
        "fix b all box/relax iso 1e-3\nmin_style deformable/lbfgs\nminimize 0 1e-9 9 9",
        "min_style cg",
    ),
    "min_style fire with fix box/relax": (
        "fix b all box/relax iso 1e-3\nmin_style fire\nminimize 0 1e-9 9 9",
        "box/relax",
    ),
    "pair_modify tail": ("pair_modify tail yes\nrun 0", "tail"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    commands, message = REFUSED[name]
    with refuses(message):
        Packing(EXACT["balanced"]).run(commands.format(name="deformable/ring"))


def test_pair_style_after_read_restart(tmp_path):
    packing = Packing(EXACT["balanced"])
    packing.run(f"run 0\nwrite_restart {tmp_path / 'restart'}")
    with refuses("re-specify .*deformable"):
        packing.run(f"clear\nread_restart {tmp_path / 'restart'}\nrun 0")
