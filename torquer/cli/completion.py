"""``torquer completion``: the script by which a shell completes the command line."""

import click
from click.shell_completion import get_completion_class

from torquer.cli.options import examples, sentences

EXAMPLES = examples(
    "mkdir -p ~/.local/share/bash-completion/completions ~/.zfunc ~/.config/fish/completions",
    "torquer completion bash > ~/.local/share/bash-completion/completions/torquer",
    "torquer completion fish > ~/.config/fish/completions/torquer.fish",
    "torquer completion zsh > ~/.zfunc/_torquer   # ~/.zshrc: fpath+=~/.zfunc; autoload compinit; compinit",
)
VARIABLE = "_TORQUER_COMPLETE"
BASH = """\
_torquer_completion() {
    local IFS=$'\\n' line=${COMP_LINE:0:COMP_POINT} type value words
    IFS=' ' read -ra words <<< "$line"
    [[ $line == *' ' ]] && words+=("''")
    local last=${words[${#words[@]}-1]}
    local before=${last%"${last##*[=:]}"}  # bash replaces what follows = or :
    COMPREPLY=()
    for completion in $(IFS=' ' COMP_WORDS="${words[*]}" COMP_CWORD=$((${#words[@]}-1)) \\
        _TORQUER_COMPLETE=bash_complete $1); do
        IFS=',' read -r type value <<< "$completion"
        if [[ $type == dir ]]; then
            compopt -o dirnames
        elif [[ $type == file ]]; then
            compopt -o default
        else
            COMPREPLY+=("${value#"$before"}")
            [[ $value == *[=:] ]] && compopt -o nospace
        fi
    done
}
complete -o nosort -F _torquer_completion torquer
"""
"""The script of click splits the line at = and :, of which keys of --set and buses have many."""

ONLY_FIRST, EACH_TIME = "$zsh_eval_context[-1] == loadautofunc", "$funcstack[1] == _torquer"
"""The script of click for zsh completes when it is loaded, and then not the next time."""


@click.command(epilog=EXAMPLES)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@sentences
def completion(shell: str) -> None:
    """Print the completion script of a shell: commands, options, scenarios, keys of --set, buses, laws."""
    click.echo(script(shell))


def script(shell: str) -> str:
    """The script for this shell: for bash an own one, else that of click, mended for zsh."""
    if shell == "bash":
        return BASH
    from torquer.cli.main import main

    kind = get_completion_class(shell)
    assert kind is not None
    return kind(main, {}, "torquer", VARIABLE).source().replace(ONLY_FIRST, EACH_TIME)
