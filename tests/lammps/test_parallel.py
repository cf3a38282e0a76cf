"""Any number of ranks, in any grid, gives the same answers from the same data file."""

import re

import numpy as np
import pytest
from laws import BALANCED, CURVED, EXACT, RADICAL
from materials import packing
from parallel import FEW, GRIDS, TWO, assert_same, finished, lmp, on_grids, report, reported
from programs import BIN, program
from scene import HEADER, MEASURE, PACKINGS, SPECIES, Scene

STEPS = 0, 20
SCALARS = "pe c_virial[1] c_virial[2] c_virial[4] c_pair[1] c_pair[2]"
COLUMNS = "x y fx fy c_energy c_stress[1] c_stress[2] c_stress[4] f_shape[*]"
SCRIPT = (
    HEADER.replace("atomic", "{atoms}")
    + """
processors {grid}
read_data {data}
pair_style {style}
pair_coeff * * {species}
neighbor 0.3 bin
{commands}
"""
    + MEASURE.replace("{style}", "{name}")
    + "\nfix move all nve\ntimestep 0.02\n"
    + "".join(report(steps, SCALARS, COLUMNS) for steps in STEPS)
)
FORCES, PRESSURE, CONTACT_LENGTH = slice(2, 4), 11, 13  # of the columns

EDGE = PACKINGS[0]["L"] + 0.55  # a room a little larger than the packing's box
SCENES = {
    "dense": "",
    # most particles that touch have one contact, some of them across the border of two ranks
    "loose": "change_box all x scale 1.05 y scale 1.05 remap",
    "walls": f"""
change_box all x final -0.55 {EDGE} y final -0.55 {EDGE}
region walls block -0.55 {EDGE} -0.55 {EDGE} -0.5 0.5
fix walls all deformable/wall walls
fix_modify walls virial yes
""",
    # across the borders of the ranks, with new neighbor lists in each step
    "drift": "velocity all set 3.0 2.0 0.0 sum yes\nneigh_modify every 1 delay 0 check no",
    "1 copy": "velocity all create 1e-3 4711 loop geom\nneighbor 0.05 bin",
}
SCENES["16 copies"] = "replicate 4 4 1\n" + SCENES["1 copy"]

# pair style, species, scene, grids; differences of the first step, and of all
ALONG_Y = "1 1 1", "1 2 1"  # where the border cuts pairs with one contact each
SECTOR, SOFT = ("deformable/sector", "small large"), (RADICAL, "fixed skinned")
CASES = {
    "sector, loose": (*SECTOR, "loose", ALONG_Y, 1e-12, 1e-12),
    "sector, walls": (*SECTOR, "walls", ALONG_Y, 1e-12, 1e-12),
    "radical": (RADICAL, "small large", "dense", GRIDS, 1e-12, 1e-12),
    "radical, any stiffness, loose": (*SOFT, "loose", ALONG_Y, 1e-12, 1e-12),
    "radical, any stiffness, walls": (*SOFT, "walls", FEW, 1e-12, 1e-12),
}
CASES |= {
    f"{law}, radii of atoms": (f"{EXACT[law]} radius atom", "any", "drift", TWO, 1e-12, 1e-12)
    for law in ("radical", "balanced")
}
LOOSE = f"{BALANCED} balance 1e-8 100"
BENT = f"{CURVED} balance 1e-8 100"
CASES |= {
    "balanced": (LOOSE, "fixed skinned", "1 copy", TWO, 1e-12, 3e-7),
    "balanced, 16 copies": (LOOSE, "fixed skinned", "16 copies", TWO, 1e-12, 3e-7),
    "balanced, exact": (EXACT["balanced"], "fixed skinned", "16 copies", TWO, 1e-12, 1e-11),
    "balanced, droplets": (BALANCED, "drop large", "1 copy", TWO, 1e-11, 3e-7),
    "curved": (BENT, "fixed skinned", "1 copy", FEW, 1e-12, 1e-12),
    "curved, 16 copies": (BENT, "fixed skinned", "16 copies", TWO, 1e-12, 1e-12),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_ranks_and_grids(case, tmp_path):
    """Forces and tilts are the same on both ranks that share a pair, also when those change.

    If they were not, forces would not add up to zero. With `balanced` a rank relaxes pairs that are
    inside of it, so answers differ by the tolerance, 1e-8: forces by a few times that, as the
    smallest eigenvalue of the compliances is below that of a pair, and stresses are sums of six.
    Otherwise all ranks take the same steps, and answers differ by rounding, which a few violent
    steps multiply. The force on a particle is a sum of larger contact forces, p L, which round.
    Droplets are beside rings that conserve their perimeter.
    """
    style, species, scene, grids, first, later = case
    boundary = "f f p" if scene == "walls" else "p p p"
    material = "radii of atoms" if species == "any" else "perimeter conserved"
    start = packing(PACKINGS[0], RADICAL, material, boundary=boundary)
    start.run(f"velocity all create 1e-4 4711 loop all\nwrite_data {tmp_path / 'data'} nofix")
    folders = on_grids(
        SCRIPT,
        tmp_path,
        grids,
        boundary=boundary,
        atoms="sphere" if species == "any" else "atomic",
        data=tmp_path / "data",
        style=style,
        name=style.split()[0],
        species=f"{SPECIES} {species}",
        commands=SCENES[scene],
    )
    for steps in STEPS:
        found = reported(folders, steps)
        scalars, rows = found["1 1 1"]
        assert scalars[0] > 1e-6
        columns = np.abs(rows[:, 2:])
        scale = columns.max(axis=0)
        scale[FORCES] = (columns[:, PRESSURE] * columns[:, CONTACT_LENGTH]).max()
        assert_same(found, first if steps == 0 else later, scale=scale)
        for _, of_atoms in found.values() if scene != "walls" else ():
            rest = of_atoms[:, 2:][:, FORCES].sum(axis=0)
            assert (np.abs(rest) <= 1e-14 * len(rows) * scale[FORCES]).all()


def test_errors_end_all_ranks(tmp_path):
    """One rank reads the species file: all ranks stop if it is missing."""
    Scene.packing(PACKINGS[0], RADICAL).run(f"write_data {tmp_path / 'data'} nofix")
    fields = {"atoms": "atomic", "boundary": "p p p", "grid": "2 1 1", "data": "data"}
    fields |= {"style": RADICAL, "name": "deformable/ring", "commands": ""}
    result = lmp(2, SCRIPT.format(species="nowhere.txt small large", **fields), tmp_path)
    assert result.returncode != 0
    assert "Cannot open the species file 'nowhere.txt'" in result.stdout + result.stderr


ONE_LARGE = """
units lj
dimension 2
region box block -30 30 -30 30 -0.5 0.5
create_box 2 box
lattice hex 1.2
region hole sphere 0 0 0 20.3 side out units box
{atoms}
mass * 1.0
pair_style deformable/ring
pair_coeff * * species small large
neighbor 0.3 nsq
neigh_modify one 20000 page 400000
comm_modify cutoff 3
run 0
"""
FILL = "region fill block -30 30 -30 30 -0.5 0.5 units box\ncreate_atoms 1 region fill"
AROUND = """
region fill intersect 2 box hole
create_atoms 1 region fill
create_atoms 2 single 0 0 0 units box
"""


def test_one_large_particle_needs_no_memory(tmp_path):
    """Ranks send each other what their shared pairs need, not the most that any particle has."""
    (tmp_path / "species").write_text("small 0.5 1 inf\nlarge 20 1 inf\n")
    megabytes = {}
    for atoms in (FILL, AROUND):
        told = finished(2, ONE_LARGE.format(atoms=atoms), tmp_path)
        memory = re.search(r"Per MPI rank .* = .*\| (\S+) Mbytes", told)
        megabytes[atoms] = float(memory[1])
    assert megabytes[AROUND] < 1.5 * megabytes[FILL]


@pytest.mark.parametrize(
    ("first", "second", "error"),
    [
        ("DEFORMABLE_TUNING=planned=0", "DEFORMABLE_TUNING=planned=1", ""),
        ("DEFORMABLE_SIMD=plain", "DEFORMABLE_SIMD=sse9", ""),
        ("DEFORMABLE_SIMD=sse9", "DEFORMABLE_SIMD=plain", "DEFORMABLE_SIMD is 'sse9'"),
    ],
)
def test_environment_is_that_of_rank_0(first, second, error, tmp_path):
    """Other ranks would go through other stages, and all would wait for each other."""
    Scene.packing(PACKINGS[0], RADICAL).run(f"write_data {tmp_path / 'data'} nofix")
    (tmp_path / "in.script").write_text(
        SCRIPT.format(
            atoms="atomic",
            boundary="p p p",
            grid="2 1 1",
            data="data",
            style=BALANCED,
            name="deformable/ring",
            species=f"{SPECIES} small large",
            commands="",
        )
    )
    of_ranks = ["-n", "1", "env", first, BIN / "lmp", "-in", "in.script", "-log", "none"]
    of_ranks += [":", "-n", "1", "env", second, *of_ranks[4:]]
    done = program("mpiexec", *of_ranks, cwd=tmp_path, timeout=60)
    assert (done.returncode != 0) == bool(error)
    assert error in done.stdout + done.stderr
