"""The mended model fitted to all there is, once a part of it has judged what is missing.

Where the user holds nothing out, stretches of every recording are, and a model that has seen two thirds of a decay
tells the phase of the whole one by so much worse. What is named, and what the table shows, is judged by what was held
out; what is delivered then needs no judge any more and may learn from it too (cross-validation: Stone 1974).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..errors import BadInput
from ..identify.fit.likelihood import maximum_likelihood
from ..identify.provenance import with_provenance
from ..model import Oscillator
from ..recording.recording import Recording
from .repair_trial import record_fits, tells_worse

#: What the user is told of it.
FITTED_TO_ALL = "the model is fitted to what was held out too; the table is of the same structure fitted without"


def fitted_to_all(model: Oscillator, recordings: Sequence[Recording], fixed: Sequence[str]) -> Oscillator | None:
    """The model with the parameters that suit whole recordings best; None where it tells them worse.

    Args:
        model: mended, from stretches of these recordings; its values are where the fit starts.
        recordings: uncut.
        fixed: parameters that keep their values.
    """
    try:
        fit = maximum_likelihood(model, recordings, fixed, near=True)
    except BadInput:  # stretches may simulate where nothing follows the whole
        return None
    found = replace(
        with_provenance(fit, recordings), amplitude=model.amplitude, frequency=model.frequency, hold=model.hold
    )
    records = record_fits(model, found, recordings, holdout=False)
    return None if not records or tells_worse(records) else found
