"""Levels of SIMD instructions: which are compiled, and what other processors say."""

import os
import platform
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from lammps_deformable import core

ROOT = Path(__file__).parents[2]
OBJECTS = ROOT / "build" / "make" / "CMakeFiles"
LEVELS = "plain", "avx2", "avx512"

# levels.cpp with kernels that are empty, for a processor that the command line names
PROGRAM = """
#include "{source}/kernels/levels.cpp"
#include <cstdio>
#define LEVEL(NAME)                                                                  \\
  namespace deformable::NAME {{                                                      \\
  const BatchKernel sector_kernels[1] = {{}}, ring_kernels[1] = {{}};                \\
  const ForceKernels force_kernels = {{}};                                           \\
  const DropletKernels droplet_kernels = {{}};                                       \\
  const DropletKernels sticking_droplet_kernels = {{}};                              \\
  const FrontKernels front_kernels = {{}};                                           \\
  }}
DEFORMABLE_LEVELS
int main(int, char **words)
{{
  if (!deformable::batch_kernels(words[1]))
    std::puts(deformable::why_no_kernels("DEFORMABLE_SIMD", words[1]).c_str());
}}
"""
PROCESSOR = "namespace deformable {{ inline Level processor_level() {{ return Level::{level}; }} }}"


def said(folder, compiled, processor, level=""):
    """What the choice of kernels says, with these levels compiled and on this processor."""
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    assert compiler, "the plugin was built by a compiler that is not here: name it by CXX"
    header = (ROOT / "src" / "kernels" / "processor.h").read_text()
    names = header[: header.index("inline Level processor_level")]
    (folder / "kernels").mkdir(exist_ok=True)
    own = PROCESSOR.format(level=processor)
    (folder / "kernels" / "processor.h").write_text(f"{names}}}\n{own}\n#endif\n")
    (folder / "levels.cpp").write_text(PROGRAM.format(source=ROOT / "src"))
    table = "".join(f"LEVEL({name})" for name in reversed(compiled))
    command = [compiler, "-std=c++17", "-O0", f"-I{folder}", f"-I{ROOT / 'src'}"]
    command += [f"-DDEFORMABLE_LEVELS={table}", folder / "levels.cpp", "-o", folder / "levels"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return subprocess.check_output([folder / "levels", level], text=True, timeout=60)


def test_a_processor_that_lacks_what_was_compiled(tmp_path):
    """Both levels and the way out in one line, in the place of an illegal instruction."""
    (line,) = said(tmp_path, ["avx512"], "avx2").splitlines()
    for words in ("compiled for processors with avx512", "this one has avx2", "SIMD_LEVELS=all"):
        assert words in line
    assert said(tmp_path, ["avx512"], "avx512") == ""
    assert said(tmp_path, ["avx2"], "avx512") == ""


@pytest.mark.parametrize(
    ("level", "words"),
    [
        ("sse9", "DEFORMABLE_SIMD is 'sse9': compiled are plain, avx2, avx512, of which this "),
        ("avx512", "is 'avx512': compiled are plain, avx2, avx512, of which this processor has "),
        ("plain", ""),
    ],
)
def test_a_level_that_is_asked_for(level, words, tmp_path):
    found = said(tmp_path, LEVELS, "avx2", level)
    assert found.startswith("DEFORMABLE_SIMD") is bool(words)
    assert words in found


def test_all_levels_are_tested():
    """`make test` compiles all levels; of another build this would pass without a comparison."""
    known = platform.machine() == "x86_64" and Path("/proc/cpuinfo").exists()
    flags = Path("/proc/cpuinfo").read_text().split() if known else []
    expected = {"plain"} | {"avx2"} & set(flags) | {"avx512"} & {f[:6] for f in flags}
    assert set(core.simd_levels()) >= expected, "compile with -D DEFORMABLE_SIMD_LEVELS=all"


def test_levels_share_no_code():
    """The linker keeps one of several weak functions, for all levels: it may have instructions
    that this processor lacks."""
    nm, objects = shutil.which("nm"), sorted(OBJECTS.glob("deformable_batches_*/**/*.o"))
    if not nm or not objects:
        pytest.skip("no nm" if not nm else "no object files: `make test` leaves them in build/make")
    for file in objects:
        told = subprocess.check_output([nm, "--defined-only", file], text=True)
        code = re.findall(r"^\w* ?[TWi] (\w+)$", told, re.MULTILINE)
        assert re.search(r" t ", told), file
        assert code == [], file
