"""Whether a recording asks for other parameters than the model's, by more than noise and the model's own errors make.

A parameter that is off by five standard errors moves the response by far less than the noise of a sample, and no rms
tells it. The score does (Rao 1948): what is left of the recording, weighted as a fit weighs it, along the directions
in which the parameters move the response. What noise makes of it is drawn and simulated
(``identify/fit/scatter.py``), what the covariance of the model makes of it follows from the information, and
the rest is the model's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from ..identify.fit.offsets import kept_offsets, zeros_of
from ..identify.fit.scatter import scatter
from ..identify.problem.data import data_of, noise_of
from ..identify.problem.descent import search
from ..identify.problem.jumps import smooth_stretches
from ..identify.problem.linearised import Linearised
from ..identify.problem.normal_equations import pseudo_inverse
from ..identify.problem.output_error import OutputError, State
from ..identify.problem.settle import settled
from ..identify.problem.structure import Structure
from ..identify.signals.odds import BY_CHANCE
from ..identify.signals.signals import noise_levels
from ..model import Oscillator
from ..recording.recording import Recording
from .model_inside import covariance_of

#: Draws of force noise: what they make of the score is then known to a tenth.
_DRAWS = 60
#: From so many points the response is taken for linear, each nearer to what the model's own errors allow.
_ROUNDS = 3
#: Steps in which initial states and zeros are brought to the recording, the parameters kept.
_STEPS = 10


@dataclass(frozen=True)
class Score:
    """The step that a recording asks for most.

    Attributes:
        parameter: the one that moves; None for all together.
        unit: of that parameter.
        value: of it in the model; None for all together.
        asks: value that the recording asks for; None for all together.
        gain: of log-likelihood by that step.
        chance: how often noise and the model's own errors ask for as much.
    """

    parameter: str | None
    unit: str
    value: float | None
    asks: float | None
    gain: float
    chance: float

    @property
    def passed(self) -> bool:
        """Whether that may be chance.

        Each step is held to its odds alone: of all seven of Eq. 17 chance fails one recording in a hundred or two.
        """
        return self.chance >= BY_CHANCE

    def sentence(self) -> str:
        """What is asked for, and how far beyond chance that is."""
        what = "other parameters than the model's, all together"
        if self.parameter is not None:
            what = f"{self.parameter} {self.asks:.6g} {self.unit} where the model has {self.value:.6g}"
        return (
            f"it asks for {what}, a gain of {self.gain:.3g} in log-likelihood, which noise and the model's own errors "
            f"make once in {1.0 / max(self.chance, 1e-99):.1g}"
        )

    def as_json(self) -> dict[str, Any]:
        """The form in ``dashpot verify --json``."""
        return {
            "parameter": self.parameter,
            "unit": self.unit,
            "value": self.value,
            "asks": self.asks,
            "gain": self.gain,
            "chance": self.chance,
            "pass": self.passed,
        }


@dataclass(frozen=True, eq=False)
class _Information:
    """What a recording tells of the parameters ``names`` at a model's values.

    (k,) gradient of the log-likelihood, (k, k) information, and (k, k) covariance of the gradient that noise makes.
    """

    names: tuple[str, ...]
    gradient: np.ndarray
    information: np.ndarray
    spread: np.ndarray


def score_of(model: Oscillator, recording: Recording) -> Score | None:
    """The step that a recording asks for most, of each parameter alone and of all together.

    None where nothing in the recording tells of the parameters.
    """
    known, best, gone = _information_of(model, recording), None, None
    for _ in range(_ROUNDS):
        if known is None:
            return best
        own = covariance_of(model, known.names)
        moved = np.zeros(len(known.names)) if gone is None else gone
        gradient = known.gradient + known.information @ moved  # at the model's own values, if the response were linear
        spread = known.spread + known.information @ own @ known.information
        best = _best(model, known, gradient, spread)
        if best is None or best.passed or not np.any(own):
            return best
        # a step that the model's own errors allow may be so long that the response bends: look from its end
        gone = own @ known.information @ pseudo_inverse(spread) @ gradient
        known = _information_of(_moved(model, known.names, gone), recording)
    return best


def _best(model: Oscillator, at: _Information, gradient: np.ndarray, spread: np.ndarray) -> Score | None:
    """The step that is asked for most."""
    steps = [(name, at.information[:, [i]]) for i, name in enumerate(at.names)] + [(None, at.information)]
    scores = [_score(name, moved, gradient, spread, model) for name, moved in steps]
    possible = [score for score in scores if score is not None]
    return min(possible, key=lambda score: (score.chance, -score.gain)) if possible else None


def _moved(model: Oscillator, names: Sequence[str], by: np.ndarray) -> Oscillator:
    """The model with its parameters ``names`` moved by (k,)."""
    old = model.parameters()
    return model.with_parameters(
        {name: replace(old[name], value=old[name].value + float(step)) for name, step in zip(names, by, strict=True)}
    )


def standard_errors(model: Oscillator, recording: Recording) -> dict[str, float]:
    """Standard errors of the parameters by name that a fit to a recording would state; empty where it tells of none.

    At the model's values, by what noise makes of the score (Huber 1967).
    """
    known = _information_of(model, recording)
    if known is None:
        return {}
    inverse = pseudo_inverse(known.information)
    variances = np.diag(inverse @ known.spread @ inverse)
    return dict(zip(known.names, map(float, np.sqrt(np.maximum(variances, 0.0))), strict=True))


def _information_of(model: Oscillator, recording: Recording) -> _Information | None:
    try:
        data = data_of([recording], model, coarse=False)
    except BadInput:
        return None
    structure = Structure(model, data, (), zeros_of(data, [recording], model))
    problem, state = structure.problem.coarsely(), settled(structure.problem, structure.state(None))
    problem, state = kept_offsets(problem, state, model)
    smooth, state = smooth_stretches(problem, state)
    if not structure.free:
        return None
    problem = problem.over(smooth)
    state = _beside(problem, state)
    residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return None
    noise = noise_of(problem.segments, residuals, model.values())
    linearised = Linearised.of(problem, state, residuals, noise)
    known = linearised.over(linearised.unknowns.parameters)
    del linearised
    spread = scatter(problem, state, noise, [noise_levels(recording)[1]] * len(problem.segments), _DRAWS)
    return _Information(structure.free, known.gradient, known.normal, spread)


def _beside(problem: OutputError, state: State) -> State:
    """The point with initial states and the sensors' zeros that suit the recording best, the parameters kept."""
    kept = problem.with_offsets(problem.offsets)
    kept.free, kept.shared = (), len(problem.offsets)
    return search(kept, state, tolerance=1e-3, most=_STEPS).state


def _score(
    name: str | None, moved: np.ndarray, gradient: np.ndarray, spread: np.ndarray, model: Oscillator
) -> Score | None:
    """What a step would gain that moves the gradient along the columns of ``moved`` (k, m); None where it moves none.

    Twice the gain is chi² of m degrees of freedom where only chance asks for it.
    """
    from scipy.special import chdtrc

    whitened = moved.T @ pseudo_inverse(spread)
    information = whitened @ moved
    if not np.all(np.isfinite(information)) or not np.any(np.diag(information) > 0):
        return None
    step = pseudo_inverse(information) @ (whitened @ gradient)
    gain = 0.5 * float(step @ whitened @ gradient)
    chance = float(chdtrc(moved.shape[1], 2.0 * gain))
    if name is None:
        return Score(None, "", None, None, gain, chance)
    parameter = model.parameters()[name]
    return Score(name, parameter.unit, parameter.value, parameter.value + float(step[0]), gain, chance)
