"""Oscillatory shear, and the storage and loss modulus."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from ..common.errors import ParameterError
from ..common.progress import progress
from ..common.steps import Steps
from ..common.validate import count, expect, number_or_nan, positive, whole
from ..engine.close_balance import imbalance_under
from ..engine.disks import Disks
from ..engine.droplet_simulation import DropletSimulation
from ..engine.relaxation import TOLERANCE
from ..engine.simulation import Simulation
from ..engine.spheres import Spheres
from ..state.disk_state import DiskState
from ..state.droplet_state import DropletState
from ..state.sphere_state import SphereState
from ..state.state import State
from .flow import flow, flow_command, flow_dynamics, leans, refuse_without_flow
from .shear import S, Shearable, check_shear, sheared_state
from .small_strains import following, tolerance_under, unbalanced_modulus
from .starts import simulate

# States of a cycle at least: with three, the first harmonic is not told from a constant and others.
_FEWEST = 8

# Time steps of a cycle at least: the stress lags behind the strain by half a step.
_STEPS = 4000

# Displacement of the upper side of the box since the begin of a run, and its rate, for LAMMPS.
_COURSE = """
variable deformable_phase equal {omega!r}*({begin!r}+elapsed*dt)
variable deformable_tilt equal {width!r}*(sin(v_deformable_phase)-{shift!r})
variable deformable_rate equal {width!r}*{omega!r}*cos(v_deformable_phase)
variable deformable_tilt_z equal {part!r}*v_deformable_tilt
variable deformable_rate_z equal {part!r}*v_deformable_rate
"""


def oscillate(
    sim: Shearable[S],
    strain: float,
    period: float | None = None,
    cycles: int = 1,
    steps: int = 40,
    tolerance: float | None = None,
    friction: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> Iterator[S]:
    """Shear to and fro, by strain sin(2 pi t/period) about the strain of the start.

    With a period particles flow as in `shear` at a rate: overdamped, with a friction against the
    flow (LAMMPS' *fix deform* with *remap x*, and *fix brownian*). Without a period, or with an
    infinite one, each state is relaxed.

    Args:
        sim: a `Simulation` or, without a period, `Disks` or `Spheres`; it ends in the last state.
        strain: amplitude of the shear strain, above 0.
        period: of a cycle [time]; None or infinite: quasistatic.
        cycles: number of cycles.
        steps: states of a cycle, 8 or more, after equal parts of it.
        tolerance: of the relaxations without a period; by default 1e-4 of the strain, at most
            1e-6.
        friction: as in `shear`, with a period.
        temperature: as in `shear`.
        timestep: as in `shear`.
        seed: as in `shear`.

    Yields:
        The states, from the first part of the first cycle to the end of the last one.

    Raises:
        ParameterError: see `shear`.
        LammpsError: see `shear`.
    """
    expect("sim", sim, Simulation, DropletSimulation, Disks, Spheres)
    strain = positive("strain", strain)
    check_shear(sim, strain, count("steps", steps))
    if steps < _FEWEST:
        raise ParameterError(f"steps must be at least {_FEWEST} in a cycle, not {steps}")
    flowing = {"friction": friction, "temperature": temperature, "timestep": timestep}
    before = sim.strain or 0.0
    part = np.arange(1, steps * count("cycles", cycles) + 1) / steps
    strains = (before + strain * np.sin(2.0 * np.pi * (part % 1.0))).tolist()
    states: Iterator[S]
    if period is None or number_or_nan(period) == math.inf:
        refuse_without_flow("period", **flowing, seed=seed)
        if tolerance is None:
            tolerance = tolerance_under(strain, TOLERANCE)
        states = _relaxed(sim, before, strains, tolerance, _step(strain, steps))
    else:
        period = positive("period", period)
        flows, dynamics = flow_dynamics(sim, **flowing, tolerance=tolerance, seed=seed)
        dynamics = replace(dynamics, limit=period / _STEPS)
        omega = 2.0 * math.pi / period
        height = float(sim.box[1, 1])
        course = _course(omega, strain * height, leans(flows) / height)
        flowed = flow(flows, dynamics, strain * omega, period / steps, strains, course, seed)
        states = cast(Iterator[S], flowed)
    return Steps("oscillate", states, lambda: replace(sim.state(), strain=before))


def _step(strain: float, steps: int) -> float:
    """Strain from a state to the next one at most, of so many in a cycle of this amplitude."""
    return 2.0 * math.pi * strain / steps


def _course(omega: float, width: float, part: float) -> Callable[[float], str]:
    """Commands for a run that begins so long after the start: by width sin(omega t).

    Args:
        omega: of the strain [1/time].
        width: of the displacement of the upper side [length].
        part: of it that the side along z takes in a box that leans along y.
    """
    xz = "variable v_deformable_tilt_z v_deformable_rate_z" if part else ""

    def commands(begin: float) -> str:
        shift = math.sin(omega * begin)
        variables = _COURSE.format(omega=omega, begin=begin, shift=shift, width=width, part=part)
        return variables + flow_command("variable v_deformable_tilt v_deformable_rate", xz)

    return commands


def _relaxed(
    sim: Shearable[S], before: float, strains: Sequence[float], tolerance: float, step: float
) -> Iterator[S]:
    """The relaxed states at these strains, which differ by this step at most."""
    with (
        following(sim, sim.state().packing, step),
        progress("shearing", unit="state", total=len(strains)) as bar,
    ):
        for strain in strains:
            state = sheared_state(sim, strain - before, strain, tolerance)
            bar.set_postfix(stress=f"{state.shear_stress:.3g}")
            bar.update()
            yield state
            before = strain


@dataclass(frozen=True)
class DynamicModulus:
    """The first harmonic of the stress under a strain gamma sin(omega t), over gamma.

    Attributes:
        storage: G', in phase with the strain [energy/length^d].
        loss: G'', in phase with the rate [energy/length^d].
        storage_error: standard error of the mean of G' over cycles, and what forces that are not
            balanced may add [energy/length^d].
        loss_error: the same of G'' [energy/length^d].
        harmonics: amplitude of the stress that is none of this, over that which is: noise, and
            higher harmonics where the response is not linear.
    """

    storage: float
    loss: float
    storage_error: float
    loss_error: float
    harmonics: float


def dynamic_modulus(
    state: State | DropletState | DiskState | SphereState,
    strain: float,
    period: float | None = None,
    cycles: int = 3,
    discarded: int = 1,
    steps: int = 40,
    tolerance: float | None = None,
    friction: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> DynamicModulus:
    """G' and G'' of a state, which does not change, from the stress of `oscillate`.

    The stress sigma of a cycle of n states gives G' = 2/(n strain) sum sigma sin(omega t), and G''
    with the cosine. A slow flow has the G' of `shear_modulus`. Linear response is
    `state.complex_modulus`, without an amplitude and without noise.

    Contacts and, without a period, relaxed forces are balanced up to a part epsilon of the largest
    or mean contact force. With |F_c| and d_c of the contacts and the room V the error of the stress
    is about epsilon sum |F_c| d_c/(d V), in errors divided by the strain.

    Args:
        state: of a `Simulation` or, without a period, of `Disks`.
        strain: amplitude. Small packings respond linearly up to some hundredth of phi - phi_J.
        period: of a cycle [time]; None or infinite: quasistatic.
        cycles: number of cycles that count, 2 or more for an error.
        discarded: number of cycles before, in which the response settles.
        steps: as in `oscillate`, as all that follows.
        tolerance: of relaxations.
        friction: with a period.
        temperature: of the noise.
        timestep: of the flow.
        seed: of the noise.

    Raises:
        ParameterError: see `oscillate`.
        LammpsError: see `oscillate`.
    """
    expect("state", state, State, DropletState, DiskState, SphereState)
    if count("cycles", cycles) < 2:
        raise ParameterError("cycles must be at least 2, as their scatter is the error, not 1")
    if whole("discarded", discarded) < 0:
        raise ParameterError(f"discarded must not be negative, not {discarded}")
    with simulate(state, state.law) as sim:
        states = oscillate(
            sim,
            strain,
            period,
            cycles + discarded,
            steps,
            tolerance,
            friction,
            temperature,
            timestep,
            seed,
        )
        stress, left = np.array([(each.shear_stress, each.residual) for each in states]).T
    quasistatic = period is None or number_or_nan(period) == math.inf
    unbalanced = float(left.max()) if quasistatic else imbalance_under(_step(strain, steps))
    bound = unbalanced_modulus(state, unbalanced, strain)
    phase = 2.0 * np.pi * np.arange(1, steps + 1) / steps
    cycle = stress.reshape(-1, steps)[discarded:]
    storage, loss = (
        2.0 / (steps * strain) * np.sum(cycle * wave, axis=1)
        for wave in (np.sin(phase), np.cos(phase))
    )
    rest = cycle - cycle.mean(axis=1, keepdims=True)
    rest -= strain * (np.outer(storage, np.sin(phase)) + np.outer(loss, np.cos(phase)))
    size = strain * np.sqrt(np.mean(storage**2 + loss**2) / 2.0)
    scatter = np.std([storage, loss], axis=1, ddof=1) / np.sqrt(cycles)
    storage_error, loss_error = np.hypot(scatter, bound)
    return DynamicModulus(
        float(storage.mean()),
        float(loss.mean()),
        float(storage_error),
        float(loss_error),
        float(np.sqrt(np.mean(rest**2)) / size) if size else 0.0,
    )
