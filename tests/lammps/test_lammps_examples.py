"""LAMMPS' own examples with the pair styles of the plugin in place of theirs.

They are those of the Debian package lammps-examples, or of the folder that the environment variable
DEFORMABLE_LAMMPS_EXAMPLES names. Steps of 1 and more ranks differ, as IDs do, but energies and
virials depend on positions only.
"""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from example_inputs import RADIUS, SPECIES, Example, without_coefficients
from parallel import in_process, lmp

FOLDER = Path(os.environ.get("DEFORMABLE_LAMMPS_EXAMPLES", "/usr/share/lammps/examples"))
STEPS = 40

NAMES = [
    *("flow/in.flow.couette", "flow/in.flow.pois", "friction/in.friction", "obstacle/in.obstacle"),
    *("indent/in.indent", "indent/in.indent.min", "min/in.min", "min/in.min.box", "fire/in.fire"),
    *("crack/in.crack", "nemd/in.nemd", "DIFFUSE/in.msd.2d", "DIFFUSE/in.vacf.2d"),
    *("VISCOSITY/in.nemd.2d", "VISCOSITY/in.wall.2d", "VISCOSITY/in.mp.2d", "balance/in.balance"),
    *("melt/in.melt", "deposit/in.deposit.atom", "KAPPA/in.ehex", "UNITS/in.ar.lj"),
    *("controller/in.controller.temp", "balance/in.balance.neigh.rcb"),
    *("PACKAGES/momentum/in.momentum", "HEAT/in.lj.ehex", "HEAT/in.lj.hex", "KAPPA/in.heat"),
    *("KAPPA/in.heatflux", "KAPPA/in.langevin", "KAPPA/in.mp", "MC/in.mc"),
    *("VISCOSITY/in.einstein.2d", "atm/in.atm", "granregion/in.granregion.box", "rerun/in.first"),
    *(f"balance/in.balance.{way}.static" for way in ("clock", "group", "neigh")),
    *(f"balance/in.balance.{way}.dynamic" for way in ("clock", "group", "neigh", "var")),
    *(f"steinhardt/in.{lattice}" for lattice in ("bcc", "fcc", "icos")),
    *("rigid/in.rigid.gravity", "rigid/in.rigid.tnr", "pour/in.pour", "pour/in.pour.2d"),
    *(f"deposit/in.deposit.molecule{how}" for how in ("", ".shake", ".rigid-small")),
]


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER.exists(), reason="apt install lammps-examples")
@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("name", NAMES)
def test_an_example(name: str, ranks: int, tmp_path: Path) -> None:
    """Its end is that of a fresh start and of a restart; a strain does the work of its virial."""
    source = FOLDER / name
    for file in source.parent.iterdir():
        if file.is_file():
            shutil.copy(file, tmp_path)
    for data in tmp_path.glob("data*"):
        data.write_text(without_coefficients(data.read_text()))
    (tmp_path / "species").write_text(SPECIES.format(radius=RADIUS))
    example = Example(source, STEPS)
    done = lmp(ranks, example.script(), tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    in_process(example.fresh(), tmp_path)
    in_process(example.restarted(), tmp_path)
    names = ("results", "fresh", "restarted", "larger", "smaller")
    energy, work = {}, {}
    for file in names:
        energy[file], *pressures, volume = np.loadtxt(tmp_path / file)
        work[file] = np.array(pressures) * volume
    scale = max(energy["fresh"], np.abs(work["fresh"]).max())
    assert scale > 0
    for file in ("results", "restarted"):
        assert energy[file] == pytest.approx(energy["fresh"], abs=1e-9 * scale)
        np.testing.assert_allclose(work[file], work["fresh"], rtol=0, atol=1e-9 * scale)
    slope = (energy["smaller"] - energy["larger"]) / 2e-6
    along = work["fresh"][: 2 if example.plane else 3].sum()
    assert slope == pytest.approx(along, abs=1e-6 * scale)
