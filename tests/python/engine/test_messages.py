"""Errors of the pair styles tell Python users a way out in Python."""

import lammps_deformable as ld
import pytest


def test_a_larger_diameter() -> None:
    """The species file is LAMMPS' way; `Simulation` writes that file itself."""
    packing = ld.polydisperse(3, [0.5, 0.6, 0.7], phi=0.4, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.lmp.command("set atom 1 diameter 3")
        with pytest.raises(ld.LammpsError, match="in Python: reset to a packing with"):
            sim.state()


def test_beyond_the_model_says_how_many_and_what() -> None:
    packing = ld.jam(ld.bidisperse(12, seed=2)).packing.at(1.15)
    with (
        ld.Simulation(packing, ld.Ring()) as sim,
        pytest.warns(
            ld.BeyondModelWarning,
            match=r"\d+ of 12 particles .* negative radius .* without a known error",
        ),
    ):
        sim.relax(1e-3)
