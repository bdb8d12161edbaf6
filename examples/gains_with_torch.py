"""Finds the gains of all taxels, and where a ball pressed with a known load, with an optimiser of PyTorch.

taxelsim.torch.tactile() is a differentiable function of poses, loads and gains, so that a loss, an optimiser or a network of PyTorch may
stand around it. Prints how far gains and places are off at first and at the end.

python3 examples/gains_with_torch.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import torch

import taxelsim
from taxelsim.pictures import draw_taxels, save_figure
from taxelsim.torch import outputs_for, tactile

N, STEPS, MILLIMETRE = 128, 400, 1e-3  # presses; gradient steps; m


def main() -> None:
    torch.manual_seed(5)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(radius=0.02)])
    simulator = taxelsim.Simulator(model, N, outputs=outputs_for())
    loads = torch.linspace(2, 8, N)

    def images(places: torch.Tensor, gains: torch.Tensor) -> torch.Tensor:
        poses = torch.nn.functional.pad(places * MILLIMETRE, (0, 5)) + torch.tensor([0, 0, 0, 1.0, 0, 0, 0])  # the load determines z
        return tactile(simulator, poses, loads, gains)

    true_places = (torch.rand(N, 2) - 0.5) * torch.tensor([18.0, 45.0])
    true_gains = torch.exp(0.15 * torch.randn(6, 14))
    truth = images(true_places, true_gains)
    places = (true_places + torch.randn(N, 2)).requires_grad_()
    gains = torch.ones(6, 14, requires_grad=True)
    optimiser, errors = torch.optim.Adam([{"params": places, "lr": 0.05}, {"params": gains, "lr": 0.02}]), []
    schedule = torch.optim.lr_scheduler.LinearLR(optimiser, 1.0, 0.01, STEPS)
    for _ in range(STEPS):
        with torch.no_grad():
            off = (places - true_places).norm(dim=1).median()
            errors.append((100 * (gains / true_gains - 1).abs().mean().item(), 1000 * off.item()))
        loss = (images(places, gains) - truth).square().sum()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
    print("gains off by {:.1f} %, places by {:.0f} um at first; gains by {:.2f} %, places by {:.1f} um now".format(*errors[0], *errors[-1]))
    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([["true gains", "gains found"], ["error"] * 2], figsize=(12, 6.5), layout="constrained")
    for name, values in (("true gains", true_gains), ("gains found", gains.detach())):
        figure.colorbar(draw_taxels(axes[name], sensor, values.numpy(), range=1.5), ax=axes[name], label=name)
    axes["error"].semilogy(errors, label=["gains (%)", "places (µm)"])
    axes["error"].set(xlabel="gradient step", ylabel="error")
    axes["error"].legend()
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "gains_with_torch.png", figure)


if __name__ == "__main__":
    main()
