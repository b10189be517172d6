"""Whatever the attitude and however fast the body turns: a law answers with numbers, and ends no step."""

from functools import cache
from math import isfinite

import numpy as np
import pytest

from fsw.core.laws.interface import FieldSample
from fsw.core.laws.table import LAWS
from fsw.table.config import flight_config
from fsw.table.table import flight_table

BODY = {"inertia_kgm2": [1.02, 1.85, 1.95], "wheel_nms": [0.0, 0.0, 0.05]}
DRIVEN = {"inertia_kgm2": 2e-4, "max_torque_nm": 2e-3, "max_momentum_nms": 0.12}
OF_DRIVEN_WHEEL = {"two_coils", "wheel_allocation", "pitch_wheel"}
RATES_RADPS = (1e-5, 1e-3, 0.02, 0.4, 30.0)
"""From less than the orbital rate to as fast as anything is spun up."""


@cache
def control(law):
    own = {"wheel": DRIVEN, "body": {**BODY, "wheel_nms": [0.0, 0.0, 0.0]}} if law in OF_DRIVEN_WHEEL else {}
    return flight_config(flight_table({"body": BODY, "control": {"law": law}} | own, "table")).control


@pytest.mark.parametrize("rate_radps", RATES_RADPS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.filterwarnings("error")
def test_a_law_answers_with_numbers(bench, law, rate_radps):
    random, config, orbit = np.random.default_rng(round(1e5 * rate_radps)), control(law), bench.Orbit()
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    direction = random.normal(size=3)
    tick = int(random.integers(0, 6000))
    inputs = bench.inputs_at(
        orbit,
        tick,
        1.0,
        axes * np.sign(np.linalg.det(axes)),
        rate_radps * direction / np.linalg.norm(direction),
        FieldSample((1.5e-5, -2.6e-5, 3.3e-5), tick=tick - 1),
        sun_eci=np.array([0.6, 0.0, 0.8]),
    ).replace(
        ephemeris=bench.model_of(orbit),
        torque_body_nm=(1e-7, -2e-7, 5e-8),
        dipole_body_am2=(0.05, -0.02, 0.03),
        wait_ticks=(0, 0, 0),
        wheel_nms=0.05,
    )
    for mode in ("acquire", "point"):
        first = getattr(LAWS[law], mode)(inputs, (), config.setpoint, config)
        later = inputs.replace(tick=tick + 1)
        second = getattr(LAWS[law], mode)(later, first.memory, config.setpoint, config)
        for demand in (first, second):
            assert all(map(isfinite, (*demand.m_body_am2, *demand.memory)))
