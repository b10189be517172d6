"""``torquer scenarios``: the shipped scenarios."""

import click

from torquer.cli.options import sentences


@click.command()
@sentences
def scenarios() -> None:
    """List the shipped scenarios, one line each."""
    from sim.scenario.schema import shipped

    for scenario in shipped():
        click.echo(f"{scenario.name:<14} {scenario.summary}")
