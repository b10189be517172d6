"""The steps of the filter on a copy: the estimate before stays as it is, for a test that compares both."""

from fsw.core.estimation import mekf


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
