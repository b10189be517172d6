"""``torquer completion``: the script by which a shell completes the command line."""

import click
from click.shell_completion import get_completion_class

from torquer.cli.options import examples, sentences

EXAMPLES = examples(
    "torquer completion bash > ~/.local/share/bash-completion/completions/torquer",
    "torquer completion zsh > ~/.zfunc/_torquer   # with fpath+=~/.zfunc and compinit in ~/.zshrc",
    "torquer completion fish > ~/.config/fish/completions/torquer.fish",
)
VARIABLE = "_TORQUER_COMPLETE"


@click.command(epilog=EXAMPLES)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@sentences
def completion(shell: str) -> None:
    """Print the completion script of a shell: commands, options, scenarios, keys of --set, buses, laws."""
    click.echo(script(shell))


def script(shell: str) -> str:
    """The script of click for this shell."""
    from torquer.cli.main import main

    kind = get_completion_class(shell)
    assert kind is not None
    return kind(main, {}, "torquer", VARIABLE).source()
