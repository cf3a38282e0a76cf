"""A relaxation as a function of PyTorch with a gradient: radii that give packings a pressure.

python in_torch.py
"""

import lammps_deformable as ld
import torch

jammed = ld.jam(ld.bidisperse(24, seed=3)).packing
start = jammed.at(jammed.phi + 0.05)


class Pressure(torch.autograd.Function):
    @staticmethod
    def forward(context, radii):
        with ld.Simulation(start.replace(radii=radii.numpy()), ld.Ring(kP=0.3)) as sim:
            state = sim.relax(1e-9)
        slopes = state.derivatives(by="radii").vjp(pressure=1.0)
        context.save_for_backward(torch.from_numpy(slopes))
        return radii.new_tensor(state.pressure)

    @staticmethod
    def backward(context, weight):
        return weight * context.saved_tensors[0]


def objective(pressure):
    return torch.log(pressure / 0.002) ** 2


if __name__ == "__main__":
    radii = torch.tensor(start.radii, requires_grad=True)
    for step in range(6):
        pressure = Pressure.apply(radii)
        off = objective(pressure)
        off.backward()
        print(f"step {step}: pressure {pressure.item():.6f}, off {off.item():.2e}")
        with torch.no_grad():
            radii -= 2.0 * off * radii.grad / torch.sum(radii.grad**2)
        radii.grad = None
