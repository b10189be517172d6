"""``torquer header``: the bus contract and a scenario as C."""

from pathlib import Path

import click

from torquer.cli.options import SETTINGS, examples, scenario_argument, sentences

EXAMPLES = examples(
    "torquer header microsat --out firmware/torquer",
    "torquer header my-satellite.toml --out include --force",
)


@click.command(epilog=EXAMPLES)
@scenario_argument()
@click.option(
    "--out",
    "-o",
    required=True,
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="The folder to write into.",
)
@click.option("--force", is_flag=True, help="Replace files that are there.")
@SETTINGS
@sentences
def header(scenario: str, out: Path, force: bool, settings: tuple[str, ...]) -> None:
    """Write C99 that packs and unpacks the messages, and limits, levels and wiring of SCENARIO."""
    from sim.console import say
    from sim.export.c_source import c_files
    from sim.result_files import write_text
    from sim.scenario.schema import load, parse_settings

    files = c_files(load(scenario, parse_settings(settings)))
    for name, text in files.items():
        write_text(out / name, text, force)
    say(f"written: {', '.join(files)} in {out}")
