"""The commands about the installation itself: doctor, completion."""

from __future__ import annotations

import sys

import click

from .terminal import coloured, print_json

_SHELLS = ("bash", "zsh", "fish")


@click.command()
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def doctor(as_json: bool) -> None:
    """What of all that dashpot can use is there: compiler, platforms, extras, cache; 1 where a need is not."""
    from ..face.doctor import checkup

    found = checkup()
    if as_json:
        print_json(found.as_json())
    else:
        click.echo(found.text(coloured))
    if not found.good:
        sys.exit(1)


@click.command()
@click.argument("shell", type=click.Choice(_SHELLS))
def completion(shell: str) -> None:
    """What makes a shell complete dashpot's commands, options, laws and files; to be read by it.

    \b
    bash, for one shell:  eval "$(dashpot completion bash)"
    bash, for good:  dashpot completion bash > ~/.local/share/bash-completion/completions/dashpot
    zsh, in a folder of $fpath:  dashpot completion zsh > ~/.zfunc/_dashpot
    fish:  dashpot completion fish > ~/.config/fish/completions/dashpot.fish
    """
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    assert kind is not None  # it is one of _SHELLS
    made = kind(click.get_current_context().find_root().command, {}, "dashpot", "_DASHPOT_COMPLETE")
    click.echo(made.source_template % made.source_vars())


COMMANDS = (doctor, completion)
