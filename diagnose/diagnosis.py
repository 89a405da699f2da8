"""Model against recordings: what is missing, where, what it is, the mended model, what to record next.

Four steps over one frozen ``Case``: ``prepare`` makes it, ``find`` searches for what is missing, ``simplify`` leaves
out what the best structure does without, and ``tell`` tries it on every recording and says what was found.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..model import Oscillator
from ..model.display import full_stop
from ..model.library import KNOWN
from ..recording.given import recordings_of
from ..recording.recording import Recording
from ..simulate.work import Meter
from .asked_again import asked_again
from .case import Case, Progress, prepare
from .family import first_fit
from .odd_blocks import MOST_TIMES, OddBlock, odd_blocks, without
from .result import Diagnosis
from .search.found import Found
from .search.search import Search
from .simplify import simplify
from .tell import tell
from .time_allowed import SEARCHED, TimeAllowed

_log = logging.getLogger(__name__)

#: The law of a sensor that sits elsewhere all the time.
_SENSOR_OFFSET = "sensor-offset"


def diagnose(
    model: Oscillator,
    recordings: Sequence[Recording] | Any,
    holdout: Sequence[Recording] | Any = (),
    *,
    fmu: Path | None = None,
    progress: Progress = lambda _what, _part: None,
    seconds: float = math.inf,
) -> Diagnosis:
    """Find what physics a model lacks that recordings show.

    Args:
        model: gives the family: Eq. 17 and whatever terms it has; its values are where the fit starts.
        recordings: to fit to; here and in ``holdout`` also what ``recordings_of`` reads.
        holdout: of another level or kind, to judge by; where there are none, stretches of each recording that can
            spare them are held out.
        fmu: where to write the mended model as an FMU; a temporary place where None.
        progress: called with what is being done and how much of all is done, 0 to 1.
        seconds: after which it says the best that it has found, and what it has not tried.

    Raises:
        BadInput: where the recordings are not of this model's rig, or cannot carry a diagnosis.
    """
    meter, allowed = Meter(), TimeAllowed(seconds)
    progress = allowed.forward(progress)
    case, found, left_out = _searched(model, (recordings_of(recordings), recordings_of(holdout)), progress, allowed)
    found = simplify(case, found, progress, allowed)
    if found.untried:
        case = case.noted(
            f"{seconds:.4g} s were too short to try everything (not tried: {'; '.join(dict.fromkeys(found.untried))}); "
            "allow more with --seconds"
        )
    diagnosis = tell(case, found, fmu, progress, allowed)
    if left_out:
        said = f"{full_stop(diagnosis.sentence)} Left out, as no law explains it: {'; '.join(map(str, left_out))}."
        diagnosis = replace(diagnosis, sentence=said)
    diagnosis = replace(diagnosis, work=meter.read(sum(recording.n for recording in case.given)))
    _log.info("%s", diagnosis.work)
    return diagnosis


def _searched(
    model: Oscillator, given: tuple[list[Recording], list[Recording]], progress: Progress, allowed: TimeAllowed
) -> tuple[Case, Found, list[OddBlock]]:
    """What the recordings speak for: again under the hold that they ask for, and without blocks that no law explains.

    Args:
        model: as ``diagnose`` has it.
        given: recordings to fit to, and held out.
        progress: as ``diagnose`` has it.
        allowed: what the whole may take.

    Returns:
        The case of the last search, what it ended with, and what was left out.
    """
    until, left_out, times = allowed.search_until, [], 0
    case = prepare(model, *given, progress)
    taken = time.monotonic() - allowed.begun
    found = find(case, progress, until)
    while True:
        odd: list[OddBlock] = []
        change = asked_again(case, found) if allowed.searching else None
        if change:
            rest = change.of(given[0]), change.of(given[1])
        else:
            odd = odd_blocks(found) if times < MOST_TIMES else []
            times += 1
            rest = without(given[0], odd), without(given[1], odd)
            if rest == given:
                break
        why = str(change) if change else f"without what no law explains ({', '.join(map(str, odd))})"
        if time.monotonic() + taken > until:
            found = replace(found, untried=(*found.untried, f"again {why}"))
            break
        try:
            searched = prepare(model, *rest, progress).noted(*(block.sentence for block in (*left_out, *odd)))
        except BadInput:  # the rest carries no diagnosis
            break
        _log.info("again %s", why)
        again = find(searched, progress, until, None if change else found)
        if again.untried:  # what was found stands until a search that came to its end says otherwise
            found = replace(found, untried=(*found.untried, f"again {why}"))
            break
        given, case, left_out, found = rest, searched, [*left_out, *odd], again
    return case, found, left_out


def find(case: Case, progress: Progress, until: float = math.inf, before: Found | None = None) -> Found:
    """Search the library for the structure that the recordings speak for, from the given family on.

    ``before``: what a search ended with whose recordings were the same but for some blocks.

    Raises BadInput where no model of the family simulates along the recordings.
    """
    family, data, holdout = first_fit(case.data, case.judged, case.family.model)
    # what a sensor shows at zero is no physics of the rig
    laws = [law for law in KNOWN.values() if law.effect != _SENSOR_OFFSET]
    search = Search(
        data, holdout, laws, lambda what, part: progress(what, 0.05 + (SEARCHED - 0.05) * part), until, before
    )
    return search.find(family)
