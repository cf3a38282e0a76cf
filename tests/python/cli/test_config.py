"""Options in a TOML file, `--config`."""

from pathlib import Path

import lammps_deformable as ld
from programs import command

RUN = """
number = 12
steps = 1
radii = [0.5, 0.6]
kP = inf
seed = 3
"""


def test_options_of_a_file_come_after_those_of_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "run.toml").write_text(RUN)
    done = command("compress", "--config", "run.toml", "--seed", 4, "--out", "a", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    known = ld.Run(tmp_path / "a").parameters
    assert [known[name] for name in ("number", "steps", "radii", "seed")] == [12, 1, [0.5, 0.6], 4]
    again = command("compress", "--config", "run.toml", "--resume", "--out", "a", cwd=tmp_path)
    assert "begun with --seed 4, not 3" in again.stderr


def test_what_is_wrong_is_one_line(tmp_path: Path) -> None:
    for text, message in (
        ("bubbles = 3", "'run.toml' has bubbles, and `deformable compress` has no option --bubb"),
        ('steps = "ten"', "Invalid value for '--steps'"),
        ("steps ten", "'run.toml' cannot be read: "),
        (None, "'run.toml' cannot be read: No such file"),
    ):
        (tmp_path / "run.toml").unlink(missing_ok=True)
        if text is not None:
            (tmp_path / "run.toml").write_text(text)
        done = command("compress", "--config", "run.toml", cwd=tmp_path)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1), text
        assert done.stderr.startswith("error: ")
        assert message in done.stderr
        assert not (tmp_path / "compress").exists()
