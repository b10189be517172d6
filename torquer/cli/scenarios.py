"""``torquer scenarios``: the shipped scenarios."""

import click

from torquer.cli.options import JSON, examples, sentences

EXAMPLES = examples("torquer scenarios", "torquer scenarios --json")


@click.command(epilog=EXAMPLES)
@JSON
@sentences
def scenarios() -> None:
    """List the shipped scenarios, one line each."""
    from sim.console import answer, say
    from torquer.api.scenarios import scenarios

    every = scenarios()
    for name, scenario in every.items():
        say(f"{name:<14} {scenario.summary}")
    answer({"scenarios": [{"name": name, "summary": scenario.summary} for name, scenario in every.items()]})
