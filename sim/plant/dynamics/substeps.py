"""The integration steps of a tick: as many as are needed for none to turn the body too far."""

from math import ceil, sqrt
from typing import final

import numpy as np

from sim.plant.config import PlantConfig
from sim.plant.environment.surroundings import Environment, Surroundings
from sim.plant.errors import PlantError
from sim.plant.rotation import Vec3

MOST_RAD = 0.15
"""Angle (|w| + |h| / J_min) dt of a step, at most.

A Runge-Kutta step of fourth order multiplies an oscillation of x radians a step by 1 - x^6 / 144: this one
loses less than 0.1 % in an orbit at 0.15 rad/s.
"""
MOST_SUBSTEPS = 2048
"""Steps of a tick for the sake of a fast motion; one that needs more is lost."""


@final
class TickSteps:
    """The steps of a tick.

    Args:
        number: how many.
        step_s: length of each.
        stages: at the start, the middle and the end of each, in time: 2 n + 1 of them.
    """

    __slots__ = ("number", "stages", "step_s")

    def __init__(self, number: int, step_s: float, stages: list[Surroundings]) -> None:
        self.number = number
        self.step_s = step_s
        self.stages = stages


@final
class Substeps:
    """Steps a tick: those of ``max_substep_s``, doubled until each turns the body by ``MOST_RAD`` at most.

    The body turns at |w|; it nutates at most at |w| by its own momentum and at |h| / J_min by that of wheels,
    J_min the least of its principal moments of inertia.

    Args:
        config: the plant.
    """

    def __init__(self, config: PlantConfig) -> None:
        inertia, wheel = config.body.inertia_kgm2, config.wheel
        own = inertia if wheel is None else wheel.rest_of(inertia)
        self._least_kgm2 = float(np.linalg.eigvalsh(np.array(own))[0])
        x, y, z = config.body.wheel_body_nms
        self._constant_nms = sqrt(x * x + y * y + z * z)
        self._config = config
        self._least = ceil(1.0 / (config.tick_hz * config.max_substep_s))
        self.environment = Environment(config, self._least)
        """On the grid of a slow motion."""
        self._environments = {self._least: self.environment}  # by steps a tick

    def of(self, tick: int, omega_body_radps: Vec3, driven_nms: float = 0.0) -> TickSteps:
        """The steps of a tick.

        Args:
            tick: the tick.
            omega_body_radps: inertial rate at its start, body axes.
            driven_nms: momentum of a driven wheel then.

        Raises:
            PlantError: the motion is too fast for any number of steps.
        """
        x, y, z = omega_body_radps
        momentum_nms = self._constant_nms + abs(driven_nms)
        rate_radps = sqrt(x * x + y * y + z * z) + momentum_nms / self._least_kgm2
        count, most_radps = self._least, MOST_RAD * self._config.tick_hz
        while rate_radps > most_radps * count:
            count *= 2
            if count > MOST_SUBSTEPS:
                raise lost(tick)
        if count not in self._environments:
            self._environments[count] = Environment(self._config, count)
        return TickSteps(count, 1.0 / (self._config.tick_hz * count), self._environments[count].stages(tick))


def lost(tick: int) -> PlantError:
    """The error of a motion that the integration does not follow."""
    return PlantError(f"the motion diverges in tick {tick}: too fast for the integration")
