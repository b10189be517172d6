"""Faults of Sun cells."""

from random import Random

from sim.faults.fault import Fault, Parameters


class WrongCurrent(Fault):
    """One cell has a wrong current."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._cell = round(parameters["cell"]) - 1

    def cells(self, currents: tuple[float, ...]) -> tuple[float, ...]:
        """The currents with that of the faulty cell, if there is one of that number."""
        if self._cell >= len(currents):
            return currents
        wrong = self.wrong(currents[self._cell])
        return (*currents[: self._cell], wrong, *currents[self._cell + 1 :])

    def wrong(self, current: float) -> float:
        """What the faulty cell has in place of this current."""
        raise NotImplementedError


class CellDead(WrongCurrent):
    """A cell has no current."""

    def wrong(self, current: float) -> float:
        """No current."""
        return 0.0


class CellScaled(WrongCurrent):
    """A cell has ``scale`` times its true current."""

    def wrong(self, current: float) -> float:
        """The wrong current."""
        return self.parameters["scale"] * current


class CellsRandom(Fault):
    """Each cell has no current or ``percent`` of full sunlight, at random in each tick."""

    def cells(self, currents: tuple[float, ...]) -> tuple[float, ...]:
        """The random currents."""
        lit = 0.01 * self.parameters["percent"]
        return tuple([self.rng.choice((0.0, lit)) for _ in currents])


class CellStuck(WrongCurrent):
    """A cell keeps its current of the onset, or ``percent`` of full sunlight if that is above 0."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._held = 0.01 * parameters["percent"] or None

    def wrong(self, current: float) -> float:
        """The held current."""
        self._held = current if self._held is None else self._held
        return self._held
