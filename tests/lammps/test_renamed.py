"""What contacts remember follows particles and walls whose names change: springs, films, losses."""

from math import prod

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lammps import lammps
from parallel import TWO, finished
from renamed import HEAP, INVARIANTS, renaming, start

TELL = 'print "TOLD ' + " ".join(f"$({name}:%.15g)" for name in INVARIANTS) + '"\n'
EACH = "reset_timestep 0\nrun 0 post no\n" + TELL
END = (
    "run 40 post no\n"
    + TELL
    + "write_dump all custom {file} x y vx vy omegaz modify format float %.15g\n"
)


def told(output):
    lines = [line for line in output.splitlines() if line.startswith("TOLD")]
    return np.array([[float(word) for word in line.split()[1:]] for line in lines])


def heap(file):
    """Rows of the heap, by their places."""
    rows = np.loadtxt(file, skiprows=9)
    nearest = np.hypot(*(rows[:, None, :2] - HEAP[None]).transpose(2, 0, 1)).argmin(axis=0)
    return rows[nearest]


@pytest.mark.parametrize("grid", [*TWO, pytest.param("2 2 1", marks=pytest.mark.slow)])
def test_all_one_after_the_other(grid, tmp_path):
    """Nothing changes, and the run that follows is the run without them."""
    ranks = prod(map(int, grid.split()))
    script = start(tmp_path, grid) + TELL
    plain = told(finished(ranks, script + END.format(file="plain"), tmp_path))
    assert_something_is_remembered(plain[0])
    steps = "".join(f"{commands}\n{EACH}" for commands in renaming(tmp_path).values())
    renamed = told(finished(ranks, script + steps + END.format(file="renamed"), tmp_path))
    assert len(renamed) == 2 + len(renaming(tmp_path))
    for name, row in zip(["start", *renaming(tmp_path)], renamed[:-1], strict=True):
        np.testing.assert_allclose(row, plain[0], rtol=1e-8, atol=1e-9, err_msg=name)
    np.testing.assert_allclose(renamed[-1], plain[-1], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(
        heap(tmp_path / "renamed"), heap(tmp_path / "plain"), rtol=0, atol=1e-8
    )


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
