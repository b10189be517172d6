"""``torquer scenarios``: the shipped scenarios."""

import click

from torquer.cli.options import JSON, examples, sentences

EXAMPLES = examples(
    "torquer scenarios", "torquer scenarios --json", "torquer scenarios --schema > scenario.schema.json"
)


@click.command(epilog=EXAMPLES)
@click.option("--schema", is_flag=True, help="Print the JSON Schema of scenario files, for editors.")
@JSON
@sentences
def scenarios(schema: bool) -> None:
    """List the shipped scenarios, one line each."""
    from sim.console import answer, say
    from torquer.api.scenarios import scenarios

    if schema:
        from sim.scenario.keys.editor_schema import as_text, json_schema

        say(as_text().rstrip())
        answer({"schema": json_schema()})
        return
    every = scenarios()
    for name, scenario in every.items():
        say(f"{name:<14} {scenario.summary}")
    answer({"scenarios": [{"name": name, "summary": scenario.summary} for name, scenario in every.items()]})
