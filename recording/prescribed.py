"""Recordings of a motion that was imposed: which of them say nothing of what is asked."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import BadInput
from .recording import Recording


def refuse_prescribed(recordings: Sequence[Recording]) -> None:
    """Raises BadInput where a motion was prescribed: what is asked for is of an oscillator."""
    for recording in recordings:
        if recording.prescribed:
            raise BadInput(
                f"{recording.name}: its motion was prescribed, which says nothing of an oscillator; identify "
                "--prescribed finds the force law by itself (identify_element in Python), and diagnose and simulate "
                "take its file"
            )


def refuse_channels(recordings: Sequence[Recording]) -> None:
    """Raises BadInput where channels were given to what asks for none."""
    for recording in recordings:
        if recording.channels:
            raise BadInput(
                f"{recording.name}: the channel {recording.channels[0].name} was given, and what depends on one is "
                "asked of a prescribed motion alone (--prescribed), or taken from an element (--from); leave it out"
            )


def refuse_free(recordings: Sequence[Recording]) -> None:
    """Raises BadInput where nobody says that a motion was prescribed: what is asked for is a force law by itself."""
    for recording in recordings:
        if not recording.prescribed:
            raise BadInput(
                f"{recording.name}: nobody says that its motion was prescribed; name the column of that motion with "
                "--prescribed"
            )
