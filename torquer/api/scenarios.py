"""``torquer.scenario`` and ``torquer.scenarios``: scenarios as objects."""

from os import PathLike
from pathlib import Path
from typing import Self

from fsw.input.schema import merge
from sim.errors import HarnessError
from sim.result_files import write_text
from sim.scenario import schema
from sim.scenario.schema import shipped
from sim.scenario.settings import nested
from sim.scenario.written import scenario_toml
from torquer.api.arguments import ScenarioLike, Settings, chosen_scenario, path_text
from torquer.api.errors import one_sentence
from torquer.api.printed import PrintedResult


class TypedScenario(schema.Scenario, PrintedResult):
    """A scenario, its sections as attributes: ``scenario.body.inertia_kgm2``; ``print`` shows its file.

    It never changes: ``changed`` gives another one. Functions take it as they take its name.
    """

    @classmethod
    def of(cls, scenario: schema.Scenario) -> Self:
        """The same scenario."""
        values = {name: getattr(scenario, name) for name in schema.Scenario.model_fields}
        return cls.model_construct(scenario.model_fields_set, **values)

    @one_sentence
    def changed(self, settings: Settings | None = None, /, **sections: object) -> Self:
        """A copy with values laid over it, checked as those of a file are.

        ``scenario.changed(time={"tick_hz": 10})`` or ``scenario.changed({"time.tick_hz": 10})``; a section of
        another scenario may be given too.

        Raises:
            InputError: a key that is unknown, of the wrong type or out of range.
        """
        over = merge(nested(settings), nested(sections))
        return self.of(schema.load(self, over))

    @one_sentence
    def write(self, path: str | PathLike[str], *, force: bool = False) -> Path:
        """Write it as a file, which ``torquer.scenario`` and every command read; all keys are in it.

        Args:
            path: ends in ``.toml``.
            force: replace the file if it is there.

        Raises:
            InputError: there is such a file, or it cannot be written.
        """
        file = Path(path_text(path, "path"))
        if file.suffix != ".toml":
            raise HarnessError(f"{file}: a scenario's file ends in .toml")
        if file.exists() and not force:
            raise HarnessError(f"{file} exists, and is not overwritten: choose another name, or force=True")
        write_text(file, scenario_toml(self, str(file)), force)
        return file

    def __str__(self) -> str:
        return scenario_toml(self).rstrip("\n")

    def __repr__(self) -> str:
        return f"<TypedScenario {self.name}>"


@one_sentence
def scenario(scenario: ScenarioLike, *, set: Settings | None = None) -> TypedScenario:
    """A scenario as an object.

    Args:
        scenario: name of a shipped scenario, path of a file, or a scenario.
        set: values laid over it by key.

    Raises:
        InputError: there is none, or a key is unknown or out of range.
    """
    return TypedScenario.of(chosen_scenario(scenario, set))


def scenarios() -> dict[str, TypedScenario]:
    """The scenarios that ship, by name."""
    return {one.name: TypedScenario.of(one) for one in shipped()}
