"""A plain filter, and its steps on a copy: a test then has the estimate before and after."""

from fsw.core.estimation import mekf
from fsw.core.estimation.mekf_config import mekf_config


def plain_filter(moments_kgm2, tick_s=1.0, **changes):
    """A filter of attitude and rate alone, of a body with these moments of inertia."""
    a, b, c = moments_kgm2
    given = {
        "magnetometer_sigma_t": 2e-7,
        "sun_sigma_rad": 0.01,
        "attitude_sigma_rad": 0.01,
        "rate_sigma_radps": 0.01,
        "torque_noise_nm_rts": 1e-9,
        "gate_nis": 16.0,
    } | changes
    return mekf_config(((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)), tick_s, {}, **given)


def predict(estimate, *words):
    """The estimate after a tick."""
    after = estimate.copy()
    mekf.predict(after, *words)
    return after


def predict_step(estimate, *words):
    """The estimate after a piece of a tick."""
    after = estimate.copy()
    mekf.predict_step(after, *words)
    return after


def correct(estimate, *words):
    """The corrected estimate."""
    after = estimate.copy()
    mekf.correct(after, *words)
    return after


def update_field(estimate, *words, **named):
    """The estimate after a field sample; None where it was refused."""
    return _updated(mekf.update_field, estimate, words, named)


def update_sun(estimate, *words, **named):
    """The estimate after a Sun direction; None where it was refused."""
    return _updated(mekf.update_sun, estimate, words, named)


def update_both(estimate, *words, **named):
    """The estimate after both; None where they were refused."""
    return _updated(mekf.update_both, estimate, words, named)


def _updated(update, estimate, words, named):
    after = estimate.copy()
    return after if update(after, *words, **named) else None


def known_of(estimate):
    """Attitude, rate and parameters, as the predictions of measurements take them."""
    return estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
