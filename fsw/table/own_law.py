"""A user law as the onboard table names it: its digest, its gains, and a guard around each call."""

import signal
from dataclasses import dataclass, replace
from inspect import signature, unwrap
from itertools import islice
from math import isfinite
from operator import index
from pathlib import Path
from shlex import quote
from threading import current_thread, main_thread
from types import FrameType
from typing import Any

from fsw.core.laws.entry import Aim
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, OwnLaw, Setpoint
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.laws.table import LAWS
from fsw.input import own_code
from fsw.input.own_code import error_clause
from fsw.input.quantities import with_values
from fsw.input.schema import Nested, TableError
from fsw.own_law import GROUP, ControlLaw, Law
from fsw.own_law import Demand as OwnDemand
from fsw.table.given_law import given_law
from fsw.table.sections import ControlTable

LONGEST_S = 5.0
"""Processor time after which a call is aborted."""
MOST_MEMORY = 1000
"""Numbers that a law may carry from one tick to the next."""
ARGUMENTS = ("inputs", "memory", "setpoint", "config")
"""Of a law, in this order."""
ASKED_TWICE = 16
"""In each tick that is a multiple of this the law is called twice; a pure one gives the same answer."""


ONLY_ITS_OWNER = "only whoever has it can replay the run, by torquer.load(RUN, law=IT)"
"""Of a law that was given as an object."""


class LawError(TableError):
    """A user law has failed in flight; the message is a sentence that names law, tick and fault."""

    exit_code = 1


def named(values: Nested, folder: Path) -> Nested:
    """The values of a table in which a user law has an absolute path and the digest of its source.

    Nothing is executed. A law that has a digest already stays as it is: it may be that of a run, whose source
    need not be here.

    Args:
        values: of an onboard table, or of a scenario with its ``[flight]``.
        folder: of the file that has them.

    Raises:
        TableError: the source cannot be read.
    """
    control, below = values.get("control"), values.get("flight")
    if isinstance(below, dict):
        values = {**values, "flight": named(below, folder)}
    law = control.get("law") if isinstance(control, dict) else None
    if not isinstance(control, dict) or not isinstance(law, str) or law in LAWS or "law_sha256" in control:
        return values
    if own_code.given_as(law) is not None:
        given = given_law()
        digest = {} if given is None or given.sha256 is None else {"law_sha256": given.sha256}
        return {**values, "control": {**control, **digest}}
    found = own_code.find(law, folder, GROUP)
    if found is None:
        return values
    return {**values, "control": {**control, "law": found.reference, "law_sha256": found.sha256}}


def withheld(control: ControlTable) -> str:
    """Why the source of the table's own law is not executed, as a sentence."""
    if own_code.given_as(control.law) is not None:
        return f"the run flew a user law ({flown(control)}): {ONLY_ITS_OWNER}"
    return (
        f"the run flew a user law ({flown(control)}), which is executed only where it is named again: "
        f"--law {quote(control.law)}"
    )


def flown(control: ControlTable) -> str:
    """The table's own law and its digest, in words."""
    digest = "without a digest" if control.law_sha256 is None else f"SHA-256 {control.law_sha256[:16]}..."
    return f"{own_code.display(control.law)}, {digest}"


def declared(control: ControlTable) -> ControlLaw:
    """What the source of the table's own law declares; it is executed.

    Raises:
        TableError: it is withheld, cannot be loaded, or is not a law.
    """
    if control.law_withheld:
        raise TableError(withheld(control))
    found = _found(control)
    if isinstance(found, ControlLaw):
        parts = {"point": found.point, "acquire": found.acquire or found.point}
        for name, part in parts.items():
            _check_form(part, f"{control.law}: {name}")
        if not isinstance(found.aim, Aim):
            raise TableError(
                f"{control.law}: its aim is none of {', '.join(f'Aim.{aim.name}' for aim in Aim)}"
            )
        return found
    if callable(found) and not isinstance(found, type):
        _check_form(found, control.law)
        return ControlLaw(found)
    kind = f"the class {found.__name__}" if isinstance(found, type) else f"of type {type(found).__name__}"
    raise TableError(f"{control.law} is {kind}, not a law: neither a function nor a ControlLaw")


def _found(control: ControlTable) -> object:
    """What the table's own law names, loaded or given as an object."""
    if own_code.given_as(control.law) is None:
        return own_code.load(control.law, control.law_sha256, GROUP)
    given = given_law()
    if given is None or given.sha256 != control.law_sha256:
        raise TableError(
            f"the law is {flown(control)}: only whoever has it can fly it, by torquer.fly with law=IT"
        )
    return given.law


def _check_form(form: object, what: str) -> None:
    """Refuse what cannot be called with the arguments of a law, before it flies."""
    if not callable(form):
        raise TableError(f"{what} is no function")
    try:
        signature(form, follow_wrapped=False).bind(*ARGUMENTS)
    except TypeError as error:
        raise TableError(f"{what} cannot be called as a law, with {', '.join(ARGUMENTS)}: {error}") from None
    except ValueError:  # one of a compiled module, which does not tell
        return


def with_own_law(config: ControlConfig, control: ControlTable) -> ControlConfig:
    """The configuration with the table's own law and its gains.

    Raises:
        TableError: it cannot be loaded, is not a law, or a gain is not allowed.
    """
    law, name = declared(control), control.law_name
    gains, given = dict(config.gains), control.gains.get(name, {})
    if law.gains is not None:
        gains[name] = with_values(law.gains, given, f"control.gains.{name}", control.law)
    elif given:
        raise TableError(f"{control.law}: control.gains.{name}: the law has no gains of its own")
    called = own_code.display(control.law)
    forms = (law.acquire or law.point, law.point)
    acquire, point = (GuardedLaw(form, called, _file_of(form, control.law)) for form in forms)
    return replace(config, gains=gains, own=OwnLaw(name, acquire, point))


def _file_of(form: Law, reference: str) -> str:
    """The file that a traceback names, of a function that this process had before the law was asked for."""
    here = own_code.given_as(reference) is not None or own_code.is_running(reference)
    code = getattr(unwrap(form), "__code__", None) if here else None
    return reference.rpartition(":")[0] if code is None else str(code.co_filename)


@dataclass(frozen=True, slots=True)
class GuardedLaw:
    """A user law: of its answers only a complete ``Demand`` of finite numbers is passed on.

    Attributes:
        law: the function.
        name: of the law, for messages.
        file: of its source; empty: an installed package.
    """

    law: Law
    name: str
    file: str = ""

    def __call__(self, inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
        """The demand of the law.

        Raises:
            LawError: it fails, gives anything else, takes too long, or is not pure.
        """
        demand = self._ask(inputs, memory, setpoint, config)
        if inputs.tick % ASKED_TWICE == 0 and self._ask(inputs, memory, setpoint, config) != demand:
            raise self._error(
                inputs,
                "it gives two answers to the same input: it keeps state outside Demand.memory, "
                "draws random numbers or reads a clock",
            )
        return demand

    def _ask(self, inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
        try:
            answer = _within(LONGEST_S, self.law, inputs, memory, setpoint, config)
        except _TooLongError:
            raise self._error(inputs, f"it takes more than {LONGEST_S:g} s") from None
        except (Exception, SystemExit) as error:
            raise self._error(inputs, f"it fails: {error_clause(error, self.file)}") from None
        try:
            return whole(answer)
        except ValueError as error:
            raise self._error(inputs, str(error)) from None

    def _error(self, inputs: LawInput, what: str) -> LawError:
        return LawError(f"the law {self.name}, tick {inputs.tick}: {what}")


def whole(answer: object) -> Demand:
    """The answer of a law, its numbers as floats.

    Raises:
        ValueError: it is not a demand of finite numbers.
    """
    if not isinstance(answer, Demand | OwnDemand):
        raise ValueError(f"it returns {_kind(answer)}, not a Demand")
    impulse, wheel = answer.impulse_body_nms, answer.wheel_torque_nm
    return Demand(
        _vector("m_body_am2", answer.m_body_am2),
        None if impulse is None else _vector("impulse_body_nms", impulse),
        _numbers("memory", answer.memory),
        None if answer.pulse is None else _pulse(answer.pulse),
        None if wheel is None else _number("wheel_torque_nm", wheel),
    )


def _pulse(value: object) -> Pulse:
    pair = (value.coil, value.level) if isinstance(value, Pulse) else value
    try:
        coil, level = map(index, pair)  # type: ignore[call-overload]  # whatever they gave
    except (TypeError, ValueError):
        coil, level = -1, 0
    if coil not in range(3) or level not in range(-3, 4):
        raise ValueError("pulse is not a coil 0 to 2 and a level -3 to 3")
    return Pulse(coil, level)


def _number(name: str, value: object) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]  # whatever they gave
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} is {_kind(value)}, not a number") from None
    if not isfinite(number):
        raise ValueError(f"{name} is not finite: {number:g}")
    return number


def _vector(name: str, values: object) -> tuple[float, float, float]:
    numbers = _numbers(name, values)
    if len(numbers) != 3:
        raise ValueError(f"{name} has {len(numbers)} numbers, not 3")
    x, y, z = numbers
    return (x, y, z)


def _numbers(name: str, values: object) -> tuple[float, ...]:
    try:
        given = list(islice(iter(values), MOST_MEMORY + 1))  # type: ignore[call-overload]  # whatever they gave
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} is {_kind(values)}, not a sequence of numbers") from None
    try:
        numbers = tuple(map(float, given))
    except (TypeError, ValueError, OverflowError):
        numbers = tuple(_number(f"{name}[{at}]", value) for at, value in enumerate(given))  # tells which
    if len(numbers) > MOST_MEMORY:
        raise ValueError(f"{name} has more than {MOST_MEMORY} numbers")
    if not all(map(isfinite, numbers)):
        raise ValueError(f"{name} is not finite: {', '.join(f'{number:g}' for number in numbers[:6])}")
    return numbers


def _kind(value: object) -> str:
    return "nothing" if value is None else f"a {type(value).__name__}"


class _TooLongError(BaseException):
    """No Exception, so that a law which catches those does not catch it."""


def _interrupt(signum: int, frame: FrameType | None) -> None:
    raise _TooLongError


def _within(seconds: float, law: Law, *arguments: Any) -> object:  # noqa: ANN401  (those of the law)
    """Call a law for no longer than this much processor time; only the main thread can interrupt it."""
    if current_thread() is not main_thread() or not hasattr(signal, "setitimer"):
        return law(*arguments)
    before = signal.signal(signal.SIGVTALRM, _interrupt)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        return law(*arguments)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)
