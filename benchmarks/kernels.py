"""Nanoseconds per particle of each C++ kernel, by the number of contacts z.

    python benchmarks/kernels.py [--out benchmarks/results/kernels.json]

`geometry` is distance, direction and contact line of z pairs (a force call needs z/2 of them for a
particle); `ring_any_number` is the ring law without the code that is compiled for each small z.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).parent


def measure() -> list[dict[str, float]]:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "kernels"
        compiler = os.environ.get("CXX", "g++")
        options = ["-O3", "-DNDEBUG", "-std=c++17", f"-I{HERE.parent / 'src' / 'core'}"]
        source = HERE / "kernels.cpp"
        subprocess.run([compiler, *options, str(source), "-o", str(program)], check=True)
        done = subprocess.run([program], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "kernels.json")
    options = parser.parse_args()
    rows = measure()
    for row in rows:
        print("  ".join(f"{key} {value:5.0f}" for key, value in row.items()))
    options.out.parent.mkdir(parents=True, exist_ok=True)
    result = {"command": "python benchmarks/kernels.py", "unit": "ns per particle", "rows": rows}
    options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
