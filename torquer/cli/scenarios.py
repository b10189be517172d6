"""``torquer scenarios``: the scenarios that ship."""

import click

from torquer.cli.options import sentences


@click.command()
@sentences
def scenarios() -> None:
    """The scenarios that ship, one line each."""
    from sim.scenario.schema import shipped

    for scenario in shipped():
        click.echo(f"{scenario.name:<14} {scenario.summary}")
