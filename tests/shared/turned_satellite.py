"""The same satellite, its axes called otherwise: what a scenario says of it in body axes, in other ones."""

import numpy as np

from fsw.core.laws.plan.law_axes import NAMED, law_axes

J_LAW = np.array([[1.02, 0.03, -0.02], [0.03, 1.85, 0.04], [-0.02, 0.04, 1.95]])
START, RATE_DEGPS = (0.3, -0.5, 0.8), (0.03, -0.05, 0.04)
TORQUE_NM, DIPOLE_AM2 = (1e-7, -2e-7, 3e-7), (0.02, -0.01, 0.03)
PAIRS = [(up, ahead) for up in NAMED for ahead in NAMED if up[-1] != ahead[-1]]


def turned_satellite(up, ahead):
    """Settings of a scenario: what is turned, with a magnetometer that shows the field as it is."""
    axes = law_axes(up, ahead)

    def of_body(v_law):
        return list(v_law if axes is None else axes.to_body(v_law))

    columns = np.array([of_body(axis) for axis in (NAMED["x"], NAMED["y"], NAMED["z"])]).T
    return {
        "knowledge": "perfect",
        "body": {"inertia_kgm2": (columns @ J_LAW @ columns.T).tolist(), "up": up, "ahead": ahead},
        "initial": {"axis": of_body(START), "angle_deg": 35.0, "rate_degps": of_body(RATE_DEGPS)},
        "disturbance": {"torque_nm": of_body(TORQUE_NM), "residual_dipole_am2": of_body(DIPOLE_AM2)},
        "sensors": {"magnetometer": {"noise_nt": 0.0, "quantum_nt": 0.0}},
    }
