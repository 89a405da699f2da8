"""Options that take several values, all words up to the next option: ``--holdout a.csv b.csv -o DIR``.

Click gives an option a fixed number of words, so that the second of two files would silently become an argument. The
words are written out before click reads them, ``--holdout a.csv --holdout b.csv``, and the option may be repeated.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click


class SeveralValues(click.Option):
    """An option that takes all words up to the next option, and may be repeated; ``--name=VALUE`` takes that alone."""

    def __init__(self, names: Sequence[str], **settings: Any) -> None:
        super().__init__(names, multiple=True, **settings)


class CommandOfSeveral(click.Command):
    """A command that may have options of several values."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the words; raises UsageError where an option took what the arguments lack."""
        several = [option for option in self.params if isinstance(option, SeveralValues)]
        names = {name for option in several for name in option.opts}
        written = written_out(args, names)
        used = len(written) > len(args)  # known now: reading the words takes them off the list
        try:
            return super().parse_args(ctx, written)
        except click.MissingParameter as problem:
            if not used or not isinstance(problem.param, click.Argument):
                raise
            raise click.UsageError(
                f"{problem.format_message().rstrip('.')}: {' and '.join(sorted(names))} takes all files up to the next "
                "option; name the others before it",
                ctx,
            ) from problem


def written_out(words: Sequence[str], names: set[str]) -> list[str]:
    """``words`` of a command line with the option repeated before each of its values.

    Args:
        words: behind the command's name.
        names: of the options that take several values, ``{"--holdout"}``.

    Raises:
        click.BadOptionUsage: where one of them has no value.
    """
    made: list[str] = []
    taking: str | None = None
    waiting = False
    for i, word in enumerate([*words, "--"]):
        option = len(word) > 1 and word.startswith("-")
        if waiting and option:
            raise click.BadOptionUsage(str(taking), f"Option {taking!r} needs a value.")
        if i == len(words):
            break
        if word == "--":
            return [*made, *words[i:]]
        if taking is not None and not option:
            made += [taking, word]
        elif word not in names:
            made.append(word)
        taking = word if word in names else None if option else taking
        waiting = word in names
    return made
