"""``torquer watch``: the live view of a bus or of a log."""

import click

from torquer.cli.completions import of_buses, of_paces, of_scenarios
from torquer.cli.options import WholeNumber, examples, sentences

EXAMPLES = examples(
    "torquer watch socketcan:vcan0",
    "torquer watch runs/microsat-20250320T120000Z --pace realtime:600",
    "torquer watch loop --web",
)


@click.command(epilog=EXAMPLES)
@click.argument("source", default="auto", metavar="[BUS|RUN|LOG]", shell_complete=of_buses)
@click.option(
    "--pace",
    default="realtime:60",
    show_default=True,
    shell_complete=of_paces,
    help="Of a log: realtime[:FACTOR], or lockstep: as fast as it can be read.",
)
@click.option(
    "--scenario",
    shell_complete=of_scenarios,
    help="Of the satellite: predicts field and Sun. Default: that of the run.",
)
@click.option("--web", is_flag=True, help="As a page on this machine. Needs torquer[watch].")
@click.option("--foxglove", is_flag=True, help="For Foxglove, on this machine. Needs torquer[watch].")
@click.option(
    "--port",
    type=WholeNumber(0, 65535),
    help="Of the page (8025) or of the server for Foxglove (8765); 0: any that is free.",
)
@sentences
def watch(source: str, pace: str, scenario: str | None, web: bool, foxglove: bool, port: int | None) -> int:
    """Watch a bus, or a log at any pace: attitude, pulses, modes, events. It only listens.

    On a terminal a picture that moves; into a file or a pipe a line for each thing that happens.
    """
    if web and foxglove:
        raise click.UsageError("--web and --foxglove exclude each other: start torquer watch twice")
    if port is not None and not (web or foxglove):
        raise click.UsageError("--port belongs to --web or --foxglove")
    from sim.record.pace import parse_pace
    from sim.watch import command

    chosen = command.watch(source, parse_pace(pace), scenario)
    try:
        if web:
            command.serve_page(chosen, 8025 if port is None else port)
        elif foxglove:
            command.serve_foxglove(chosen, 8765 if port is None else port)
        else:
            command.show_on_terminal(chosen)
    except KeyboardInterrupt:  # as it usually ends: there is nothing to say
        return 130
    return 0
