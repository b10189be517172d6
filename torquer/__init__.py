"""Torquer for its users: magnetic attitude control flown, replayed, audited and designed.

``torquer.fly("microsat", orbits=3)`` flies a scenario and gives its ``Run``; every function does what the
command of its name does. What is not asked for is not loaded: ``import torquer`` is quick.
"""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torquer.api.audit import Audit, check
    from torquer.api.calibrate import SatelliteCalibration, calibrate
    from torquer.api.campaign import CampaignRuns, campaign
    from torquer.api.compare import Comparison, compare
    from torquer.api.design import Design, design
    from torquer.api.errors import Error, InputError
    from torquer.api.export import Export, export
    from torquer.api.flight import fly, report
    from torquer.api.judge import JudgedSoftware, judge
    from torquer.api.phasing import WiringVerdict, phasing
    from torquer.api.replay import replay
    from torquer.api.run import Run, load
    from torquer.api.satellites import NewScenario, Sizing, new, size
    from torquer.api.scenarios import TypedScenario, scenario, scenarios
    from torquer.api.telemetry import FollowedPass, telemetry
    from torquer.api.validate import Validation, validate
    from torquer.api.watch import WatchedMoments, watch

_MODULES = {
    "Audit": "audit",
    "CampaignRuns": "campaign",
    "Comparison": "compare",
    "Design": "design",
    "Error": "errors",
    "Export": "export",
    "FollowedPass": "telemetry",
    "InputError": "errors",
    "JudgedSoftware": "judge",
    "NewScenario": "satellites",
    "Run": "run",
    "SatelliteCalibration": "calibrate",
    "Sizing": "satellites",
    "TypedScenario": "scenarios",
    "Validation": "validate",
    "WatchedMoments": "watch",
    "WiringVerdict": "phasing",
    "calibrate": "calibrate",
    "campaign": "campaign",
    "check": "audit",
    "compare": "compare",
    "design": "design",
    "export": "export",
    "fly": "flight",
    "judge": "judge",
    "load": "run",
    "new": "satellites",
    "phasing": "phasing",
    "replay": "replay",
    "report": "flight",
    "scenario": "scenarios",
    "scenarios": "scenarios",
    "size": "satellites",
    "telemetry": "telemetry",
    "validate": "validate",
    "watch": "watch",
}
"""Modules of ``torquer.api`` by what they hold."""

__all__ = [
    "Audit",
    "CampaignRuns",
    "Comparison",
    "Design",
    "Error",
    "Export",
    "FollowedPass",
    "InputError",
    "JudgedSoftware",
    "NewScenario",
    "Run",
    "SatelliteCalibration",
    "Sizing",
    "TypedScenario",
    "Validation",
    "WatchedMoments",
    "WiringVerdict",
    "calibrate",
    "campaign",
    "check",
    "compare",
    "design",
    "export",
    "fly",
    "judge",
    "load",
    "new",
    "phasing",
    "replay",
    "report",
    "scenario",
    "scenarios",
    "size",
    "telemetry",
    "validate",
    "watch",
]


def __getattr__(name: str) -> object:
    """A function or class of ``torquer.api``, loaded when it is first asked for."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    _check_packages()
    found: object = getattr(import_module(f"torquer.api.{_MODULES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return __all__


def _check_packages() -> None:
    """The packages that torquer is made of are those beside it.

    Raises:
        ImportError: another one of the same name comes first, such as a folder of the user's.
    """
    house = Path(__file__).resolve().parents[1]
    for name in ("fsw", "hil_stub", "sim"):
        spec = find_spec(name)
        found = Path(spec.origin).resolve() if spec and spec.origin else None
        found = found.parent if found and found.name == "__init__.py" else found
        if found != house / name:
            raise ImportError(f"torquer needs {house / name}, but {found} comes first on sys.path: rename it")
