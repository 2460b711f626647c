"""``prag-asp completion``: scripts for completion in shells."""

from __future__ import annotations

import click

from prag_asp.cli.terminal import say


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print the completion script for a shell.

    It completes commands, options, domains, rules, actions and more.

    For bash, add this line to ~/.bashrc: eval "$(prag-asp completion bash)"

    For zsh, add this line to ~/.zshrc, below compinit: eval "$(prag-asp completion zsh)"

    For fish, write the script to ~/.config/fish/completions/prag-asp.fish
    """
    from click.shell_completion import get_completion_class

    from prag_asp.cli.registry import COMPLETION, PROGRAM, cli
    from prag_asp.cli.shell_completion import add_shells

    add_shells()
    completer = get_completion_class(shell)
    assert completer is not None, "click knows every shell of the choice"
    say(completer(cli, {}, PROGRAM, COMPLETION).source().rstrip("\n"))
