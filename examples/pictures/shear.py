"""The animation of README: an emulsion under shear, its force chains and its stress."""

import io

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

STRAIN, STEPS = 0.48, 64

jammed = ld.jam(ld.bidisperse(64, sizes=(0.5, 0.7), seed=3)).packing
with ld.Simulation(jammed, ld.Ring(kA=np.inf, kP=0, tension=1.0)) as sim:
    sim.compress(phi=0.92, steps=6)
    run = sim.shear(STRAIN, steps=STEPS)
strain, stress = (run.table()[name] for name in ("shear_strain", "shear_stress"))
side = run[0].packing.box[1, 1]
squeezed = [state.pressures * state.packing.radii for state in run]  # 1 if alone
scale = {"cmap": "YlGnBu", "vmin": np.min(squeezed), "vmax": np.max(squeezed), "colorbar": False}

pictures = []
for n, state in enumerate(run):
    figure, (above, below) = plt.subplots(
        2, 1, figsize=(4.8, 4.4), dpi=100, height_ratios=(3.6, 1), layout="constrained"
    )
    state.plot(above, color=squeezed[n], forces=True, **scale)
    above.set(title="", xlim=(-0.1, (1.0 + STRAIN) * side + 0.1), ylim=(-0.1, side + 0.1))
    above.axis("off")
    above.get_legend().remove()
    below.plot(strain[: n + 1], stress[: n + 1], color="#d55e00", lw=1.5)
    below.set(xlim=(0.0, STRAIN), ylim=(1.1 * min(0, *stress), 1.1 * max(stress)))
    below.set(xlabel="shear strain", ylabel="shear stress")
    with io.BytesIO() as file:
        figure.savefig(file)
        pictures.append(Image.open(file).convert("RGB"))
    plt.close(figure)

colors = pictures[-1].quantize(24, dither=Image.Dither.NONE)  # few, so that the file is small
first, *others = (
    picture.quantize(palette=colors, dither=Image.Dither.NONE) for picture in pictures
)
first.save("shear.gif", save_all=True, append_images=others, duration=250, loop=0, optimize=True)
