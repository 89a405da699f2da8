"""`python -m dashpot`, and the command `dashpot`."""

import signal


def main() -> None:
    """Load the commands and run one.

    Python answers an interruption in the middle of an import with a traceback; until the command is ready to end well,
    and when it has, the system's answer is used, which is to end without a word.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from .commands.cli import main as run

    run()


if __name__ == "__main__":
    main()
