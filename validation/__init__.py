"""Studies with the package: what was measured, and the programs that measure it again."""

import argparse
import os
from pathlib import Path


def options_of(parser: argparse.ArgumentParser, file: str) -> argparse.Namespace:
    """Options of the command line. Results go into the folder `--out`, by default the study's own.

    Args:
        parser: with the other options.
        file: the program of the study.
    """
    parser.add_argument("--out", type=Path, default=Path(file).parent, help="folder of the results")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    os.chdir(options.out)
    return options
