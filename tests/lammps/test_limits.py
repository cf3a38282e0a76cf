"""What happens at each limit of docs/limits.md: an input for each row of its tables."""

import re
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
import test_abi as abi
from parallel import in_process

PAGE = Path(__file__).parents[2] / "docs" / "limits.md"
WORDS = "error", "warning", "counted", "silent"

# Warnings of LAMMPS itself, which are about the inputs.
USUAL = "No fixes with time integration"

SCENE = """
units lj
dimension {dimension}
boundary {boundary}
atom_modify map yes
{before}
region box block {box} {height}
create_box 2 box
{atoms}
mass * 1.0
pair_style deformable/{style}
pair_coeff * * species a {second}
thermo_modify norm no
{after}
{go}
"""
SPECIES = "a 0.5 1 inf\nb 0.2 1 inf\n"
DROPS = "a 0.5 inf 0 tension 1.0\n"
PAIR = [(2, 2), (2.9, 2)]
AROUND = np.pi / 3 * np.arange(6)
FLOWER = [(3, 3), *(3 + 0.8 * np.column_stack([np.cos(AROUND), np.sin(AROUND)]))]


@dataclass
class Input:
    """A script, and what it says."""

    told: str = ""
    atoms: Any = None  # places, or the packing fraction of a crystal
    go: str = "run 0"
    after: str = ""
    before: str = ""
    style: str = "ring"
    species: str = SPECIES
    second: str = "a"
    boundary: str = "p p p"
    dimension: int = 2

    def said(self, folder: Path) -> str:
        """Warnings of a script, or its error."""
        (folder / "species").write_text(self.species)
        plane = self.dimension == 2
        scene = {"box": "0 6 0 6", "height": "-0.5 0.5" if plane else "0 6", "before": self.before}
        if isinstance(self.atoms, float):
            lattice = f"hex {self.atoms / (np.pi / 4)}" if plane else "fcc 1.85"
            scene = {"box": "0 4 0 4", "height": "-0.5 0.5", "before": f"lattice {lattice}"}
            scene |= {} if plane else {"box": "0 2 0 2", "height": "0 2"}
            atoms = "create_atoms 1 box"
        else:
            places = [" ".join(map(str, (*place, 0)[:3])) for place in self.atoms or PAIR]
            atoms = "\n".join(f"create_atoms 1 single {place}" for place in places)
        names = "style second boundary dimension after go"
        own = {name: getattr(self, name) for name in names.split()}
        try:
            log = in_process(SCENE.format(atoms=atoms, **scene, **own), folder)
        except Exception as error:  # of the module lammps
            return str(error)
        return "\n".join(
            line for line in log.splitlines() if "WARNING" in line and USUAL not in line
        )


def counted(packing: ld.Packing, law: ld.Ring | ld.Droplet) -> None:
    """The state counts its particles."""
    with ld.Simulation(packing, law) as sim:
        assert sim.state().beyond == len(packing)


def two_threads() -> None:
    """The second one is refused while the first is in a call."""
    inside, leave = threading.Event(), threading.Event()
    with ld.Simulation(ld.Packing([[1, 1], [1.9, 1]], 0.5, (4, 4)), ld.Ring()) as sim:

        def call() -> None:
            sim.lmp.command("fix pause all external pf/callback 1 1")
            sim.lmp.set_fix_external_callback("pause", wait, None)
            sim.lmp.command("run 0")

        def wait(*_: object) -> None:
            inside.set()
            leave.wait(60)

        thread = threading.Thread(target=call)
        thread.start()
        assert inside.wait(60)
        try:
            with pytest.raises(ld.CallError, match="another thread is in a call"):
                sim.state()
        finally:
            leave.set()
            thread.join()


def wide_films(w: float) -> dict[str, Any]:
    return {"style": "ring contact curved", "species": f"{DROPS}adhesion a a {w}\n"}


STIFF = {"species": "a 0.5 inf 1.0\n", "atoms": FLOWER}
SHAKE = "displace_atoms all random 0.02 0.02 0 1"
ROOM = "min_style deformable/lbfgs\nminimize 0 1e-6 1000 2000\nrun 0"
FAST = "velocity all create 1e-2 1\nfix move all nve\ntimestep 20"
LEAVES = "velocity all set 1 0 0\nfix move all nve\ntimestep 0.01\nthermo 500"
TUBE = {"style": "droplet", "species": DROPS, "dimension": 3, "boundary": "f f p"}
ROUND = "region tube cylinder z 3 3 {} INF INF\nfix tube all deformable/wall tube"
BEYOND = "are beyond the model"
AGAIN = """write_restart again
clear
read_restart again
pair_style deformable/ring
pair_coeff * * again a b"""

# The beginning of each row, and inputs by what happens; tests of other files by their functions.
ROWS: dict[str, dict[str, Input | Callable[..., None]]] = {
    "Outlines exist up to confluence": {
        "warning": Input(BEYOND, 1.12),
        "counted": lambda: counted(ld.crystal("hex", 2, phi=1.12), ld.Ring()),
    },
    "Droplets in space (3D) are right up to loads": {
        "warning": Input(BEYOND, 0.97, style="droplet", species=DROPS, dimension=3),
        "counted": lambda: counted(ld.crystal("fcc", 2, phi=0.97), ld.Droplet()),
    },
    "Free particles are circles and spheres": {
        "silent": Input(atoms=[(3, 3)]),
        "error": Input("tension must not be negative, not -1", species="a 0.5 1 0 tension -1\n"),
    },
    "Contacts slip without friction": {
        "warning": Input("jumps where contacts", style="sector", go="fix m all nve\nrun 1"),
    },
    "Adhesion is for contact curved": {
        "error": Input("adhesion", species=f"{DROPS}adhesion a a 0.1\n"),
        "warning": Input(
            "contact angles are above 0.7",
            [(2, 2, 2), (2.95, 2, 2)],
            style="droplet",
            species=f"{DROPS}adhesion a a 0.6\n",
            dimension=3,
        ),
    },
    "Above w = 0.82 tensions": {
        "warning": Input("but without a film", [(2, 2), (2.99, 2)], **wide_films(0.9)),
    },
    "Above w = 0.27 tensions": {
        "warning": Input(BEYOND, 0.91, **wide_films(0.3)),
        "counted": lambda: counted(
            ld.crystal("hex", 4, phi=0.91),
            ld.Ring(kA=np.inf, kP=0, tension=1, adhesion=0.3, contact="curved"),
        ),
    },
    "Deformations are elastic": {
        "silent": Input(go="displace_atoms all random 0.1 0.1 0 1\nrun 0"),
    },
    "A droplet in a tube": {
        "silent": Input(atoms=[(3.27, 3, 3)], after=ROUND.format(0.75), **TUBE),
        "error": Input("is wider than region", [(3, 3, 3)], after=ROUND.format(0.45), **TUBE),
    },
    "Energies are of shapes at rest": {"silent": Input(go="fix m all nve\nrun 10")},
    "The line between two particles": {
        "error": Input("does not lie well in front", [(2, 2), (2.04, 2)]),
    },
    "Particles much larger than their neighbors": {
        "error": Input("use a reach of 0.", style="ring reach 0.01", atoms=[(2, 2), (2.7, 2)]),
    },
    "kA = inf and contacts without room": {
        "error": Input("leave no room", **STIFF),
        "warning": Input("until there is room", go=ROOM, **STIFF),
    },
    "Contacts that find no balance": {
        "warning": Input("Allow more evaluations", 0.95, after=SHAKE, style="ring balance 1e-14 6"),
        "error": Input("forces are off by", 0.95, after=SHAKE, style="ring balance 1e-14 2"),
    },
    "Time steps that are too long": {
        "error": Input("contact line of atoms", 0.95, after=FAST, go="run 500")
    },
    "A boundary that is not periodic": {
        "silent": Input(boundary="f f p", after=LEAVES),
        "error": Input("Lost atoms", boundary="f f p", after=LEAVES, go="run 1000"),
    },
    "Single precision, GPUs": {"silent": Input(before="suffix gpu")},
    "run_style respa": {
        "error": Input(
            "does not support rRESPA",
            after="fix m all nve\nrun_style respa 2 2 inner 1 4.0 5.0 outer 2",
        ),
    },
    "A Simulation is for one Python thread": {"error": two_threads},
    "compute group/group, pair/local": {
        "error": Input(
            "does not support compute group/group",
            after="compute g all group/group all\nthermo_style custom step c_g",
        ),
    },
    "rerun and dumps have neither": {
        "silent": Input(
            after="dump d all custom 1 frames id type x y",
            go="run 0\nundump d\nrerun frames dump x y",
        ),
    },
    "Binary restart files have no species": {
        "warning": Input(
            "is of another problem",
            after='print "a 0.5 2 inf" file again.species',
            go=AGAIN.replace("* * again a b", "* * again.species a a") + "\nrun 0",
        ),
    },
    "Linux, Python 3.10 and later": {"error": abi.test_what_the_plugin_compares},
}


def plain(cell: str) -> str:
    """A cell without links, code and emphasis."""
    return re.sub(r"\[([^]]*)\]\([^)]*\)|[`*]", r"\1", cell).strip()


def test_rows() -> None:
    """The page has these rows, and what happens are these words."""
    table = [line.strip("|").split(" | ") for line in PAGE.read_text().splitlines()]
    cells = [(plain(row[0]), plain(row[1])) for row in table if len(row) == 2 and row[0][:1] == " "]
    rows = dict(cell for cell in cells if cell[0] != "limit")
    for begins, inputs in ROWS.items():
        (row,) = (text for text in rows if text.startswith(begins))
        assert {*re.findall("|".join(WORDS), rows.pop(row))} == {*inputs}, row
    assert not rows


@pytest.mark.parametrize(
    ("row", "happens"),
    [
        (row, happens)
        for row, inputs in ROWS.items()
        for happens, how in inputs.items()
        if how is not abi.test_what_the_plugin_compares
    ],
)
def test_what_happens(row: str, happens: str, tmp_path: Path) -> None:
    found = ROWS[row][happens]
    if not isinstance(found, Input):
        found()
        return
    said = found.said(tmp_path)
    assert said.startswith("ERROR") == (happens == "error"), said
    assert said == "" if happens == "silent" else found.told in said
