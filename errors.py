"""The errors a user can meet; the one module that every folder may import."""


def printable(text: str) -> str:
    """The text without what would not print, line breaks kept: what files and names hold must not steer a terminal."""
    return "".join(c if c.isprintable() or c == "\n" else "\ufffd" for c in text)


#: Longest line of an error that is shown whole: a screen of 20 lines of 80.
LONGEST = 1600


def shortened(text: str) -> str:
    """The text without the middle of lines longer than LONGEST: what is wrong and what to do stand at their ends."""
    part = LONGEST // 2 - 10
    return "\n".join(
        line if len(line) <= LONGEST else f"{line[:part]} [...] {line[-part:]}" for line in text.split("\n")
    )


class DashpotError(Exception):
    """Base of every error that dashpot raises on purpose.

    The text is one sentence for the user: what is wrong, where, and what to do next.
    """

    def __str__(self) -> str:
        return shortened(printable(super().__str__()))


class BadInput(DashpotError):
    """The input cannot be used as it is; the command line turns this into exit code 2."""


class TellsNothing(BadInput):
    """A recording that is read as it should be and tells nothing of its rig; others of the same rig do without it."""


class Unwritable(BadInput):
    """A place on this machine takes no file, whatever the input: with room or permission there all goes well."""


class ToolchainMissing(DashpotError):
    """A compiler that this step needs is not on the machine."""
