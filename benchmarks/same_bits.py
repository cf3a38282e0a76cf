"""Whether checkouts find the same bits of forces.

    python benchmarks/same_bits.py CHECKOUT CHECKOUT [CHECKOUT ...]

Each scene is a short run of LAMMPS in which particles collide. The table has a hash of the places
and forces of its last steps for each checkout: they are the same where not a bit differs. Each
checkout has its compiled plugin in python/lammps_deformable/lib. A change that only moves code must
not change a bit; another one says why it does.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from instructions import lmp_of

PLANE = """
units lj
dimension 2
boundary {boundary}
comm_modify vel yes
lattice hex {density}
region box block 0 12 0 7 -0.5 0.5
region inside block 0.4 11.6 0.4 6.8 -0.5 0.5
create_box 2 box
create_atoms 1 region {where}
set group all type/fraction 2 0.5 12345
displace_atoms all random 0.05 0.05 0.0 12345
mass * 1.0
"""
SPACE = """
units lj
boundary {boundary}
lattice fcc 0.16
region box block 0 4 0 4 0 4
region inside block 0.3 3.8 0.3 3.8 0.3 3.8
create_box 2 box
create_atoms 1 region {where}
set group all type/fraction 2 0.5 12345
displace_atoms all random 0.05 0.05 0.05 12345
mass * 1.0
"""
SPHERES = "set type 1 diameter 1.0\nset type 2 diameter 1.4\nset group all density 1.0\n"
RING, DROPLET = "deformable/ring contact", "deformable/droplet"


class Scene(NamedTuple):
    """A law, what acts beside it, and how many ranks run it."""

    style: str
    more: str = ""
    ranks: int = 1
    boundary: str = "p p p"
    kP: str = "inf"
    spheres: bool = False
    sticks: bool = False

    @property
    def in_space(self) -> bool:
        return "droplet" in self.style

    @property
    def species(self) -> str:
        if self.in_space:
            return "small 1.0 inf 0 tension 1.0\nlarge 1.1 inf 0 tension 1.0\n"
        if self.sticks:
            rows = "small 0.5 inf 0 tension 1.0\nlarge 0.7 inf 0 tension 1.0\n"
            return f"{rows}adhesion small small 0.2\nadhesion small large 0.1\n"
        return f"small 0.5 1.0 {self.kP}\nlarge 0.7 1.0 {self.kP}\n"

    def script(self) -> str:
        head = (SPACE if self.in_space else PLANE).format(
            boundary=self.boundary,
            density=0.62 if self.sticks else 0.75,
            where="box" if self.boundary == "p p p" else "inside",
        )
        if self.spheres:
            head = head.replace("mass * 1.0\n", SPHERES)
        return f"""
atom_style {"sphere" if self.spheres else "atomic"}
{head}
pair_style {self.style}
pair_coeff * * species small large
min_style fire
minimize 0 1e-3 200 400
velocity all create {1e-2 if self.in_space else 1e-4} 12345
fix move all nve
{"" if self.in_space else "fix plane all enforce2d"}
{self.more}
timestep 0.05
dump bits all custom 20 bits id x y z fx fy fz
dump_modify bits sort id format float %.17g
run 200
"""


WALLS = "fix wall all deformable/wall xlo EDGE xhi EDGE ylo EDGE yhi EDGE"
RUB = "fix rub all deformable/friction 0.5 0.2 0.1"
SCENES = {
    "sector": Scene("deformable/sector"),
    "radical": Scene(f"{RING} radical"),
    "radical, kP = 5": Scene(f"{RING} radical", kP="5.0"),
    "balanced": Scene(f"{RING} balanced"),
    "balanced, kP = 5": Scene(f"{RING} balanced", kP="5.0"),
    "curved": Scene(f"{RING} curved"),
    "curved, films": Scene(f"{RING} curved", sticks=True),
    "balanced, walls": Scene(f"{RING} balanced", WALLS, boundary="f f p"),
    "balanced, friction": Scene(f"{RING} balanced", RUB, spheres=True),
    "droplet": Scene(DROPLET),
    "droplet, walls": Scene(DROPLET, f"{WALLS} zlo EDGE zhi EDGE", boundary="f f f"),
    "radical, 2 ranks": Scene(f"{RING} radical", ranks=2),
    "balanced, 2 ranks": Scene(f"{RING} balanced", ranks=2),
    "curved, films, 2 ranks": Scene(f"{RING} curved", sticks=True, ranks=2),
    "droplet, 2 ranks": Scene(DROPLET, ranks=2),
}


def bits(checkout: Path, scene: Scene) -> str:
    """Hash of the places and forces of a scene, with the plugin of a checkout."""
    program, environment = lmp_of(checkout)
    of_ranks = [Path(sys.executable).with_name("mpiexec"), "-n", str(scene.ranks)]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "species").write_text(scene.species)
        (Path(folder) / "in.bits").write_text(scene.script())
        command = [*(of_ranks if scene.ranks > 1 else []), program, "-in", "in.bits"]
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode or f"from {checkout}" not in done.stdout:
            raise RuntimeError(f"{checkout}: {done.stdout[-2000:]}{done.stderr[-500:]}")
        return hashlib.sha256((Path(folder) / "bits").read_bytes()).hexdigest()[:12]


if __name__ == "__main__":
    differ = 0
    for name, scene in SCENES.items():
        found = [bits(Path(each).resolve(), scene) for each in sys.argv[1:]]
        same = len(set(found)) == 1
        differ += not same
        print(f"{name:25s} {'same' if same else 'DIFFER'}  {' '.join(found)}", flush=True)
    sys.exit(differ > 0)
