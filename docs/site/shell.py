"""The command `deformable` on the site: what its `--help` says, of all its subcommands."""

import subprocess
import sys

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files


def on_files(files: Files, config: MkDocsConfig) -> Files:
    names = ["--name", "deformable", "--title", "From the shell"]
    command = [sys.executable, "-m", "typer", "lammps_deformable.cli.main", "utils", "docs", *names]
    result = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    page = File.generated(config, "docs/shell.md", content=result.stdout)
    page.dest_uri = page.dest_uri.removeprefix("docs/")
    files.append(page)
    return files
