"""The errors a user can meet; the one module that every folder may import."""


class DashpotError(Exception):
    """Base of every error that dashpot raises on purpose.

    The text is one sentence for the user: what is wrong, where, and what to do next.
    """


class BadInput(DashpotError):
    """The input cannot be used as it is; the command line turns this into exit code 2."""


class ToolchainMissing(DashpotError):
    """A compiler that this step needs is not on the machine."""
