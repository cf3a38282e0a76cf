"""The error of each law and model over its time, for README, from the report's measurements."""

import json
from pathlib import Path

import matplotlib.pyplot as plt

REPORT = Path(__file__).parents[2] / "validation" / "report" / "report.json"
# label, color, and where the label stands beside the point
LAWS = {
    "radical": ("radical", "#009e73", (8, -4)),
    "balanced": ("balanced, the default", "#d55e00", (8, 6)),
    "curved": ("curved, exact", "#0072b2", (8, 8)),
}
MODELS = {"smooth": ("smooth polygons", "#6a3d9a"), "bead": ("rings of beads", "#555555")}

rows = json.loads(REPORT.read_text())["pareto"]
(known,) = (row["limit_error"] for row in rows if row["method"] == "reference")
figure, ax = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
ax.axhspan(1e-3, known, color="0.9")
ax.text(0.3, 0.75 * known, "the reference is not known better", va="top", fontsize=9, color="0.4")
for method, (label, color) in MODELS.items():
    some = [row for row in rows if row["method"] == method and row["energy_error"] > known]
    x, y = ([row[name] for row in some] for name in ("seconds", "energy_error"))
    ax.plot(x, y, "o-", color=color, lw=1, ms=4)
    ax.annotate(f"{label}, of {some[0]['vertices']} vertices", (x[0], y[0]), (-4, 7),
                textcoords="offset points", ha="center", color=color)  # fmt: skip
    ax.annotate(f"{some[-1]['vertices']}", (x[-1], y[-1]), (6, -3),
                textcoords="offset points", color=color)  # fmt: skip
for method, (label, color, shift) in LAWS.items():
    (row,) = (row for row in rows if row["method"] == method)
    below = row["energy_error"] < known  # only this is known
    at = row["seconds"], max(row["energy_error"], known)
    ax.plot(*at, "v" if below else "o", color=color, ms=8)
    ax.annotate(label, at, shift, textcoords="offset points", color=color)
ax.set(xscale="log", yscale="log", xlim=(4e-3, 40.0), ylim=(1e-3, 2.0))
ax.set(xlabel="processor time of a compression of 16 particles [s]", ylabel="error of the energy")
figure.savefig("accuracy.png", dpi=130)
