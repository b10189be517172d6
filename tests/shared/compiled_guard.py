"""A patch of a compiled function is refused: its compiled callers would not see it."""

from types import ModuleType

import pytest

from fsw.compiled import SWITCH, standing


def refuse_patches(modules):
    """Let ``monkeypatch.setattr`` and ``delattr`` raise for what stands in one of these modules."""
    if not modules:
        return
    for name in ("setattr", "delattr"):
        setattr(pytest.MonkeyPatch, name, _guarded(getattr(pytest.MonkeyPatch, name), modules))


def _guarded(patch, modules):
    def guarded(self, target, *words, **more):
        compiled = modules & set(_modules_of(target))
        if compiled:
            raise TypeError(
                f"{min(compiled)} is compiled, and its callers would not see the patch: "
                "mark the test 'interpreted'"
            )
        return patch(self, target, *words, **more)

    return guarded


def _modules_of(target):
    """The module that a target is or stands in; of a dotted name each that it may be."""
    if isinstance(target, str):
        parts = target.split(".")
        return [".".join(parts[:end]) for end in range(1, len(parts))]
    return [target.__name__ if isinstance(target, ModuleType) else getattr(target, "__module__", None)]


def interpreted_alone():
    """The mark of a file whose classes inherit from compiled ones, which needs them interpreted.

    A compiled run skips the file here, before it fails.
    """
    if standing().modules:
        pytest.skip(f"make test runs it with {SWITCH}=1", allow_module_level=True)
    return pytest.mark.interpreted
