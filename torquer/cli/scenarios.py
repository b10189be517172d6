"""``torquer scenarios``: the shipped scenarios."""

import click

from torquer.cli.options import sentences


@click.command()
@sentences
def scenarios() -> None:
    """List the shipped scenarios, one line each."""
    from torquer.api.scenarios import scenarios

    for name, scenario in scenarios().items():
        click.echo(f"{name:<14} {scenario.summary}")
