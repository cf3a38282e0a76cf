"""The picture of what foam_or_particles.py has measured.

python picture.py rows_512.json
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from validation.foam_or_particles.fits import (
    LAWS,
    SHAPES,
    SHARES,
    SHOWN,
    chosen,
    column,
    error_of,
    excess_phi,
    fit,
    mean,
    means,
    read,
    shares,
)


def draw(rows, file):
    """z - z_iso of the laws and of foam above thresholds, moduli, and numbers of contacts."""
    number = rows[0]["number"]
    laws = [law for law in LAWS if len(chosen(rows, law, number)) > 1]
    foam = chosen(rows, laws[0], number)
    figure, axes = plt.subplots(2, 3, figsize=(14, 8), layout="constrained")
    (one, two, three), (four, five, six) = axes
    for law in laws:
        packings = chosen(rows, law, number)
        x, z, error = mean(excess_phi(packings)), *means(packings, 0.0)
        one.errorbar(x, z, error, fmt="o", ms=3, label=law)
        two.errorbar(np.sqrt(x), z / np.sqrt(x), error / np.sqrt(x), fmt="o-", ms=3, lw=0.6)
    line = np.geomspace(1e-4, 0.1, 100)
    for shape, style in (("sum", "-"), ("root", ":"), ("line", "--")):
        found, _, _ = fit(foam, shape)
        z = sum(a * line**power for a, power in zip(found, SHAPES[shape], strict=True))
        one.loglog(line, z, "k" + style, lw=1, label=f"{laws[0]}, {shape}")
    one.set(xlabel=r"$x = \phi - \phi_J$", ylabel=r"$z - z_\mathrm{iso}$", ylim=(0.01, 3.0))
    two.set(ylabel=r"$(z - z_\mathrm{iso})/\sqrt{x}$", title="a root is level, a sum a line")
    for threshold in SHOWN:
        x, z, error = mean(excess_phi(foam)), *means(foam, threshold)
        label = f"{threshold:g} of the mean force"
        three.errorbar(np.sqrt(x), z / np.sqrt(x), error / np.sqrt(x), fmt="o-", ms=3, label=label)
    three.set(title=f"{laws[0]}: contacts that bear more than")
    for axes in (two, three):
        axes.set(xlabel=r"$\sqrt{x}$", ylim=(-4.0 if axes is three else 0.0, 8.0))
    for law, marker in (("foam", "o"), ("straight films", "x")):
        packings = chosen(rows, law, number)
        for name, color in (("bulk_modulus", "C0"), ("shear_modulus", "C1"), ("pressure", "C2")):
            if packings:
                x, y = mean(excess_phi(packings)), column(packings, name)
                label = f"{name.replace('_', ' ')}, {law}"
                style = {"fmt": marker, "ms": 4, "color": color, "label": label}
                four.errorbar(x, mean(y), error_of(y), **style)
                if name == "shear_modulus":
                    phi = mean(column(packings, "phi"))
                    five.errorbar(phi, mean(y), error_of(y), **style)
    dense = np.linspace(0.9069, 0.995)
    five.plot(dense, np.sqrt(np.sqrt(3) / (2 * np.pi) * dense), "k--", label="hexagonal array")
    four.set(xscale="log", yscale="log", xlabel=r"$x$", ylabel=r"[$\gamma/R_0$]", ylim=(1e-4, None))
    five.set(xlabel=r"$\phi$", ylabel=r"shear modulus [$\gamma/R_0$]")
    phi, shared = mean(column(foam, "phi")), mean(shares(foam))
    rest = (1.0 - shared[:, :1]) * shared[:, 1:]
    six.stackplot(phi, shared[:, 0], *rest.T, labels=("rattlers", *SHARES), alpha=0.8)
    six.set(xlabel=r"$\phi$", ylabel=f"part of the particles, {laws[0]}", ylim=(0, 1))
    six.set_xlim(phi[0], phi[-1])
    for axes in (one, three, four, five):
        axes.legend(frameon=False, fontsize=8)
    six.legend(fontsize=8, loc="lower right", title="contacts")
    figure.savefig(file, dpi=80)


if __name__ == "__main__":
    (name,) = sys.argv[1:]
    draw(read([name]), name.replace("rows", "foam_or_particles").replace(".json", ".png"))
