"""What ends a plant."""


class PlantError(ValueError):
    """The plant cannot go on: its models end, or its motion does; the message is a clause for people.

    ``exit_code`` is what a process ends with that met it in flight.
    """

    exit_code = 1
