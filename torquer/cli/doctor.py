"""``torquer doctor``: what torquer needs of this machine."""

import click

from torquer.cli.options import JSON, examples, sentences

EXAMPLES = examples(
    "torquer doctor", "torquer doctor --json", "torquer doctor --quiet   # what is missing alone"
)


@click.command(epilog=EXAMPLES)
@JSON
@sentences
def doctor() -> int:
    """What is there, what is missing, and what to type.

    Exit code 0: what flights need is there. 1: something that they need is missing. What is optional (extras,
    CAN interfaces) does not count.
    """
    from sim.doctor import examine, report

    return report(examine())
