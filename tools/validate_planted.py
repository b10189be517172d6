"""Planted errors: does `torquer validate` end with exit code 1 on each of them?

    python tools/validate_planted.py [NAME ...] [--list] [--timeout SECONDS]

Each plant is one change of one line of a law, a model or the filter, in a copy of the source; the claims that
must notice it are run on the copy, first without any plant. Prints a table. Exit code 1 if a plant survives,
if its text is not in the source once, or if the claims fail without it.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from argument_types import positive

sys.path.insert(0, str(Path(__file__).parent))
from mutation_tests import copy_repository

PACKAGES = ("fsw", "hil_stub", "sim", "torquer")
PASSED, FAILED, TOO_LONG = 0, 1, 124


class Plant(NamedTuple):
    """An error: the module, a text that it holds once, what stands in its place, claims that must fail."""

    name: str
    path: str
    old: str
    new: str
    only: str


PLANTS = (
    Plant(
        "sign of the attitude in pd",
        "fsw/core/laws/pd.py",
        "cross((k_w * w1 + k_a * s1, k_w",
        "cross((k_w * w1 - k_a * s1, k_w",
        "linearisation",
    ),
    Plant(
        "sign of the impulse in predictive",
        "fsw/core/laws/predictive.py",
        "sub(reference_radps, predicted)",
        "sub(predicted, reference_radps)",
        "prediction",
    ),
    Plant(
        "sign of the torque in the genetic search",
        "fsw/core/laws/plan/genetic.py",
        "cross(dipole(point), b_body_t)",
        "cross(b_body_t, dipole(point))",
        "genetic",
    ),
    Plant(
        "sign of the torque in lqr and mpc",
        "fsw/core/laws/lqr.py",
        "return add(inputs.torque_body_nm, table.problem.resting_nm)",
        "return add(scale(-1.0, inputs.torque_body_nm), table.problem.resting_nm)",
        "scenario-cubesat3u",
    ),
    Plant(
        "sign of the wheel in the plant",
        "sim/plant/dynamics/rigid_body.py",
        "(x + hx, y + hy, z + hz)",
        "(x - hx, y - hy, z - hz)",
        "prediction",
    ),
    Plant(
        "gravity gradient 2 mu / r^3 in the plant",
        "sim/plant/environment/surroundings.py",
        "3.0 * MU_M3PS2 / r_norm_m**3",
        "2.0 * MU_M3PS2 / r_norm_m**3",
        "jacobi",
    ),
    Plant(
        "plant's field to degree 12",
        "sim/plant/environment/igrf.py",
        "MAX_DEGREE = 13",
        "MAX_DEGREE = 12",
        "reference.igrf14",
    ),
    Plant(
        "onboard field without the last degree",
        "fsw/core/orbit/igrf.py",
        "degree: int = MAX_DEGREE)",
        "degree: int = MAX_DEGREE - 1)",
        "reference.igrf14",
    ),
    Plant(
        "noise of the magnetometer a third in the filter",
        "fsw/core/estimation/mekf_config.py",
        "[magnetometer_sigma_t**2] * 3",
        "[(magnetometer_sigma_t / 3.0) ** 2] * 3",
        "reference.triad_mekf",
    ),
    Plant(
        "order of the quaternions on board",
        "fsw/core/algebra/quaternion.py",
        "2.0 * (q1 * q2 + q0 * q3), 2.0 * (q1 * q3 - q0 * q2)",
        "2.0 * (q1 * q2 - q0 * q3), 2.0 * (q1 * q3 + q0 * q2)",
        "reference.attitude_a_torquefree",
    ),
    Plant(
        "sidereal time on board a second late",
        "fsw/core/orbit/earth.py",
        "gmst_s = 67310.54841 + since_noon_s",
        "gmst_s = 67309.54841 + since_noon_s",
        "reference.earth_sun",
    ),
    Plant(
        "S taken for the angle in Floquet theory",
        "sim/design/theory/linear.py",
        "2.0 * square / w0**2",
        "1.0 * square / w0**2",
        "reference.floquet",
    ),
    Plant(
        "shadow on board on the day side",
        "fsw/core/orbit/sun.py",
        "return along >= 0.0 or",
        "return along <= 0.0 or",
        "reference.eclipse",
    ),
    Plant(
        "sign of the dipole's torque in the plant",
        "sim/plant/dynamics/torques.py",
        "+ my * bz - mz * by + dx",
        "+ mz * by - my * bz + dx",
        "reference.attitude_c_dipole",
    ),
    Plant(
        "observer of sphere_output without its torque",
        "fsw/core/laws/sphere.py",
        "change = add(pushed, turning)",
        "change = turning",
        "review.feedback.sphere",
    ),
    Plant(
        "half of the attitude in pd_delayed",
        "fsw/core/laws/pd_delayed.py",
        "far_error(q), setpoint.k_w, setpoint.k_a)",
        "far_error(q), setpoint.k_w, 0.5 * setpoint.k_a)",
        "review.feedback.delayed",
    ),
    Plant(
        "three_term without the term of the spin",
        "fsw/core/laws/spin_axis.py",
        "add(scale(k_spin * spin_error_nms, e), scale(k_h, error_body_nms))",
        "scale(k_h, error_body_nms)",
        "review.spin.three_term_gain",
    ),
    Plant(
        "wheel_integral without the integral of yaw",
        "fsw/core/laws/wheel_integral.py",
        "2.0 * k_i * (b2 * i1 - b1 * i2)",
        "2.0 * k_i * (-b1 * i2)",
        "review.wheel.wheel_integral_yaw",
    ),
    Plant(
        "half of the damping in sun_critical",
        "fsw/core/laws/sun_critical.py",
        "scale(-2.0 * xi_radps, omega_body_radps)",
        "scale(-xi_radps, omega_body_radps)",
        "review.one_axis.sun_critical_free",
    ),
    Plant(
        "lqr_disturbed without twice the orbital rate",
        "fsw/core/laws/lqr_disturbed.py",
        "gain[:, 9:] @ np.array(torques)",
        "gain[:, 9:18] @ np.array(torques[:9])",
        "review.optimal.disturbed",
    ),
)


NOTHING = Plant("nothing", "", "", "", "all of these")


class Verdict(NamedTuple):
    """The exit code, the claims that failed, how long it took, and why it broke off, if it did."""

    code: int
    failed: list[str]
    seconds: float
    error: str = ""


def validate(folder: Path, only: list[str], timeout_s: float) -> Verdict:
    """Run these claims of the source in the folder."""
    words = [word for claims in only for word in ("--only", claims)]
    began = time.monotonic()
    try:
        run = subprocess.run(
            [sys.executable, "-m", "torquer", "validate", *words],
            cwd=folder,
            env=os.environ
            | {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", "PYTHONSAFEPATH": "1"},
            capture_output=True,
            text=True,
            timeout=timeout_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Verdict(TOO_LONG, [], timeout_s, f"not done after {timeout_s:g} s")
    failed = [line.split()[1].rstrip(":") for line in run.stdout.splitlines() if line.startswith("FAIL")]
    broken = run.returncode != PASSED and not failed
    error = run.stderr.strip().rpartition("\n")[2] if broken else ""
    return Verdict(run.returncode, failed, time.monotonic() - began, error)


def judge(folder: Path, plant: Plant, timeout_s: float) -> Verdict:
    """Validate the copy with the plant, and take it out again."""
    path = folder / plant.path
    source = path.read_text(encoding="utf-8")
    path.write_text(source.replace(plant.old, plant.new), encoding="utf-8")
    try:
        return validate(folder, [plant.only], timeout_s)
    finally:
        path.write_text(source, encoding="utf-8")


def misplaced(folder: Path, plants: list[Plant]) -> list[str]:
    """Plants whose text the module does not hold once."""
    counts = [(one, (folder / one.path).read_text(encoding="utf-8").count(one.old)) for one in plants]
    return [f"{one.name}: its text is {count} times in {one.path}" for one, count in counts if count != 1]


def found(verdict: Verdict) -> bool:
    """Whether a plant was noticed as it must be: by a claim that fails, be it for want of its figure."""
    return verdict.code == FAILED and bool(verdict.failed)


def row(plant: Plant, verdict: Verdict) -> str:
    """A line of the table."""
    noticed = ", ".join(verdict.failed[:3]) + (", ..." if len(verdict.failed) > 3 else "")
    text = noticed if found(verdict) else f"SURVIVES, exit code {verdict.code}: {verdict.error}".rstrip(": ")
    return f"{plant.name:52} {plant.only:32} {verdict.seconds:5.0f} s  {text}"


def run_all(plants: list[Plant], timeout_s: float) -> int:
    with tempfile.TemporaryDirectory(prefix="planted-") as name:
        folder = Path(name)
        copy_repository(folder, PACKAGES)
        if wrong := misplaced(folder, plants):
            print("\n".join(wrong))
            return FAILED
        print(f"{'planted':52} {'claims':32} time     noticed by", flush=True)
        sound = validate(folder, sorted({one.only for one in plants}), timeout_s)
        print(
            row(NOTHING, sound)
            if sound.failed
            else f"{NOTHING.name:52} {NOTHING.only:32} {sound.seconds:5.0f} s"
        )
        if sound.code != PASSED:
            print(f"FAIL: without a plant the exit code is {sound.code}: {sound.error}".rstrip(": "))
            return FAILED
        missed = 0
        for plant in plants:
            verdict = judge(folder, plant, timeout_s)
            missed += not found(verdict)
            print(row(plant, verdict), flush=True)
    print(f"{len(plants) - missed} of {len(plants)} are noticed")
    return FAILED if missed else PASSED


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="plants by a part of their names; default: all"
    )
    parser.add_argument("--list", action="store_true", help="name them, run nothing")
    parser.add_argument("--timeout", type=positive, default=1800.0, help="seconds for a run (1800)")
    options = parser.parse_args()
    for name in options.names:
        if not any(name in one.name for one in PLANTS):
            parser.error(f"there is no plant with '{name}' in its name: --list names them")
    chosen = [one for one in PLANTS if not options.names or any(name in one.name for name in options.names)]
    if options.list:
        print("\n".join(f"{one.name:52} {one.path}" for one in chosen))
        return PASSED
    return run_all(chosen, options.timeout)


if __name__ == "__main__":
    sys.exit(main())
