"""What is to be known before a recording is made or fitted: the check, the plan, the proof on one's own rig."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..errors import BadInput
from ..files.arguments import number_of, several_of, shown, text_of
from ..recording import Reading, Recording, recordings_of
from ..recording.prescribed import refuse_channels
from .model import Model, oscillator_of
from .options import mode_text, with_reading
from .python_words import speaks_python
from .workflow import Say, silent

if TYPE_CHECKING:
    from ..foresight.check import Check
    from ..foresight.excitation import Excitation
    from ..foresight.plan import Plan
    from ..foresight.proof import Proof
    from ..foresight.virtual import Integrator, Noise
    from ..model import Oscillator


def checked(
    read: Callable[[], Sequence[Recording]],
    *,
    fixed: Mapping[str, float | str] | None = None,
    mass: float | str | None = None,
    mode: str | None = None,
    notes: Say = silent,
    progress: Say = silent,
) -> Check:
    """What recordings tell before a fit; for arguments and errors see ``commands.check``."""
    from ..foresight.check import check
    from ..identify.motion.modes import mode_beside
    from ..model import Response
    from ..model.known_values import known_values
    from ..model.limits import checked_value

    recordings = read()
    refuse_channels(recordings)
    if not recordings:
        raise BadInput("no recording was given; name at least one file with a decay or a driven response")
    if fixed is not None and not isinstance(fixed, Mapping):
        raise BadInput(f'fixed is such as {{"mass": 0.27}}, not {shown(fixed)}')
    stated = {**(fixed or {}), **({} if mass is None else {"mass": mass})}
    for key, value in stated.items():
        text_of(key, "the name of a parameter")
        if not isinstance(value, str):
            checked_value(key, value)
    force = next((r.force_unit for r in recordings if r.force is not None), "N")
    known = known_values(stated, [], Response(recordings[0].quantity, recordings[0].unit), force)
    alone = mode_beside(recordings, mode, None, notes)[0]
    return check(alone, fixed=known, progress=progress)


def noise_of(
    model: Oscillator,
    like: Sequence[Recording],
    noise: float | str | None,
    force_noise: float | str | None,
    beside: Path | None,
) -> Noise:
    """Noise as stated, or as recordings of the same sensors show it; else those of the model, where they lie there.

    Raises:
        BadInput: neither was given, or a unit measures something else.
    """
    from ..foresight.virtual import Noise
    from ..identify.signals.signals import noise_levels
    from ..model.oscillator import Response

    unit = model.response.unit
    for recording in like:
        if Response(recording.quantity, recording.unit) != model.response:
            raise BadInput(
                f"{recording.name} shows {recording.quantity} in {recording.unit}, the model {model.response.quantity} "
                f"in {unit}; state the noise itself"
            )
    if noise is None and not like and beside is not None:
        like = _of_model(model, beside)
    seen = [noise_levels(recording) for recording in like]
    sensor = size(noise, unit, "the noise") if noise is not None else max((s for s, _ in seen), default=None)
    force = size(force_noise, model.force_unit, "the noise of the force") if force_noise is not None else None
    if sensor is None:
        raise BadInput(
            "how much noise the sensor has is not known: the recordings that the model was identified from are not "
            "beside it; state it (--noise 1um of a displacement), or name a recording with the same sensors (--like)"
        )
    if not sensor > 0:
        raise BadInput("the noise must be above zero: without noise everything is told by any motion")
    return Noise(sensor, max((f for _, f in seen), default=0.0) if force is None else force)


def _of_model(model: Oscillator, folder: Path) -> list[Recording]:
    """The recordings that a model was identified from, as far as they lie in a folder as they were and can be read."""
    from ..model.oscillator import Response

    found = []
    for known in model.identified.recordings:
        try:
            read = recordings_of(folder / str(known.get("file", "")))
        except BadInput:
            continue
        found += [r for r in read if r.sha256 == known.get("sha256") and Response(r.quantity, r.unit) == model.response]
    return found


def size(given: float | str, unit: str, what: str) -> float:
    """A number in ``unit``, as such or as a text with a unit of its own; raises BadInput for another."""
    from ..model.quantity import in_unit

    number = in_unit(given, unit, what)
    if not (math.isfinite(number) and number >= 0):
        raise BadInput(f"{what} is {given!r}; give a number that is not below zero")
    return number


def planned(
    model: Oscillator,
    want: str | Sequence[str],
    *,
    like: Sequence[Recording] = (),
    noise: float | str | None = None,
    force_noise: float | str | None = None,
    most_amplitude: float | str | None = None,
    most_force: float | str | None = None,
    most_seconds: float | str | None = None,
    tests: str | Sequence[str] = (),
    fs: float | None = None,
    tries: int = 3,
    seed: int = 0,
    beside: Path | None = None,
    progress: Say = silent,
) -> Plan:
    """The test that would tell what is wanted; for arguments and errors see ``commands.plan``."""
    from ..foresight.plan import TESTS, Bounds, plan

    wants = [want] if isinstance(want, str) else several_of(want, "what is wanted")
    for one in wants:
        text_of(one, "what is wanted, such as 'cubic 1%',")
    kinds = [tests] if isinstance(tests, str) else several_of(tests, "tests")
    for kind in kinds:
        if text_of(kind, "a test") not in TESTS:
            raise BadInput(f"{kind!r} is no test; there are {', '.join(TESTS)}")
    bounds = Bounds(
        amplitude=amplitude_of(model, most_amplitude),
        force=math.inf if most_force is None else above(most_force, model.force_unit, "the most force"),
        seconds=Bounds(1.0).seconds if most_seconds is None else above(most_seconds, "s", "the most time"),
        tests=tuple(kinds) or TESTS,
    )
    often = {"tries": whole(tries, "tries", 0), "seed": whole(seed, "seed", 0)}
    level = noise_of(model, like, noise, force_noise, beside)
    if fs is not None:
        fs = above(fs, "Hz", "the sampling rate")
    return plan(model, wants, bounds, level, fs=fs, **often, progress=progress)


def above(given: float | str, unit: str, what: str) -> float:
    """As ``size``, above zero."""
    number = size(given, unit, what)
    if not number > 0:
        raise BadInput(f"{what} is {given!r}; give a number above zero")
    return number


def whole(given: Any, what: str, least: int) -> int:
    """A whole number from ``least`` on; raises BadInput for another thing."""
    number = number_of(given, what)
    if not (math.isfinite(number) and number == int(number) and number >= least):
        raise BadInput(f"{what} must be a whole number from {least} on, not {shown(given)}")
    return int(number)


def amplitude_of(model: Oscillator, given: float | str | None) -> float:
    """How far the rig may move: as given, or as far as its model was identified; raises BadInput without either."""
    if given is not None:
        return above(given, model.response.displacement_unit, "the most amplitude")
    if model.amplitude is None or not 0 < model.amplitude.max < math.inf:
        raise BadInput(f"{model.name}: how far it may move is not known; state it with --most-amplitude, such as 5mm")
    return model.amplitude.max


def proved(
    model: Oscillator,
    *,
    like: Sequence[Recording] = (),
    noise: float | str | None = None,
    force_noise: float | str | None = None,
    amplitude: float | str | None = None,
    hide: str | None = None,
    runs: int | None = None,
    seed: int = 0,
    beside: Path | None = None,
    progress: Say = silent,
) -> Proof:
    """A rig simulated, identified again and counted; for arguments and errors see ``commands.prove_on``."""
    from ..foresight.proof import prove, usual_tests

    if hide is not None:
        text_of(hide, "the law to hide")
    count = (_HIDDEN_RUNS if hide else _RUNS) if runs is None else whole(runs, "runs", 1)
    seed = whole(seed, "seed", 0)
    level = noise_of(model, like, noise, force_noise, beside)
    tests, fs = usual_tests(model, amplitude_of(model, amplitude), force=model.mass is not None)
    known = not model.terms and min(model.preload.value, model.dry.value) >= 0
    return prove(
        model,
        tests,
        level,
        fs=fs,
        runs=count,
        seed=seed,
        integrator=independent() if known else None,
        hidden=hide,
        diagnosing=None if hide is None else _named,
        progress=progress,
    )


#: How often a rig is simulated where nobody says: a diagnosis takes a minute, an identification a second.
_RUNS, _HIDDEN_RUNS = 20, 3


def _named(model: Oscillator, recordings: Sequence[Recording]) -> list[str]:
    from .workflow import SECONDS, diagnosed, seconds_allowed

    # one that is stopped early names nothing, which would say nothing of the errors and names asked for here
    seconds = seconds_allowed(None if os.environ.get(SECONDS, "").strip() else math.inf)
    found, _ = diagnosed(model, recordings, (), seconds=seconds)
    return [effect.effect for effect in found.effects]


def independent() -> tuple[str, Integrator]:
    """That of the built-in stand, for Eq. 17 with preload and friction that are not below zero, and its name."""
    from ..examples.oscillator import integrate_pieces

    def integrate(model: Oscillator, played: Excitation, fs: float) -> np.ndarray:
        from ..examples.virtual_recording import acceleration

        values = {"mass": 1.0} | {name: float(value) for name, value in model.values().items()}
        samples = played.signal(fs)
        begin = float(played.level) if played.kind == "decay" else 0.0
        x, v = integrate_pieces(values, _pieces(samples, 1 / fs)[:-1], 1 / fs, begin, 0.0)
        shown = {"displacement": x, "velocity": v}
        quantity = model.response.quantity
        return shown[quantity] if quantity in shown else acceleration(values, x, v, samples)

    return "an integrator that shares no code with the engine", integrate


def _pieces(samples: np.ndarray, dt: float) -> np.ndarray:
    """(n, 6) a spline of fifth degree through samples (n,): its Taylor coefficients over each step, in steps."""
    from scipy.interpolate import make_interp_spline

    degree = 5
    time = np.arange(samples.size) * dt
    spline = make_interp_spline(time, samples, k=degree)
    return np.column_stack([spline(time, k) * dt**k / math.factorial(k) for k in range(degree + 1)])


@with_reading
def check(
    *given: Any,
    fixed: Mapping[str, float | str] | None = None,
    mass: float | str | None = None,
    mode: str | float | None = None,
    progress: Say | None = None,
    **options: Unpack[Reading],
) -> Check:
    """What recordings tell of Eq. 17 and how well, before anything is fitted.

    Args:
        given: recordings of one rig, as ``dashpot.read`` takes them.
        fixed: parameters that keep a value, as ``dashpot.identify`` takes them.
        mass: kg, or such as "270 g", where only decays were recorded or it is known.
        mode: which of several modes.
        progress: called with one line a step.
        options: how to read, see ``dashpot.recording.Reading``.

    Returns:
        Quality of each recording, and of each parameter the standard error that a fit is expected to state.

    Raises:
        BadInput: the recordings do not belong together or cannot carry a model.

    Examples:
        >>> import dashpot
        >>> told = dashpot.check(dashpot.examples.recordings()["bursts"], part="0:15")
        >>> told["cubic"].state, f"{100 * told['cubic'].std / told['cubic'].value:.1f} %"
        ('told', '0.1 %')
    """
    say = progress or silent
    how = {"fixed": fixed, "mass": mass, "mode": mode_text(mode)}
    return checked(lambda: recordings_of(*given, **options), **how, notes=say, progress=say)


@speaks_python
def plan(
    model: Model | Oscillator | str | Path,
    want: str | Sequence[str],
    *,
    noise: float | str | None = None,
    force_noise: float | str | None = None,
    like: Any = (),
    most_amplitude: float | str | None = None,
    most_force: float | str | None = None,
    most_seconds: float | str | None = None,
    tests: str | Sequence[str] = (),
    fs: float | None = None,
    tries: int = 3,
    seed: int = 0,
    progress: Say | None = None,
) -> Plan:
    """The test that would tell a parameter so well: release, sweep, random or stepped force, its level and length.

    Args:
        model: of the rig, as far as it is known.
        want: "cubic 1%", "dry 0.001 m/s2", "friction 5%", or several of these.
        noise: of the sensor, a standard deviation: a number in SI or such as "1 um".
        force_noise: the same of the recorded force.
        like: recordings with the same sensors, whose noise is taken where it is not stated; left out, those that the
            model was identified from, where they lie beside its file.
        most_amplitude: how far the rig may move; None: as far as it was identified.
        most_force: the largest force; None: what the stroke allows.
        most_seconds: the longest test; None: ten minutes.
        tests: which of "decay", "sweep", "random", "stepped" can be made; all where none is named.
        fs: samples a second; None: sixty a cycle.
        tries: how often the plan is simulated and identified.
        seed: of the noise in these.
        progress: called with one line a step.

    Raises:
        BadInput: what is wanted is no quantity of the model, or noise or amplitude are not known.

    Examples:
        >>> import dashpot
        >>> from dashpot.examples.truth import TRUTH
        >>> stand = dashpot.Model.from_values(TRUTH, name="stand")
        >>> found = dashpot.plan(stand, "cubic 5%", noise="1 um", most_amplitude="5 mm", tests="decay", tries=0)
        >>> found.excitation.kind, found.tells
        ('decay', True)
    """
    how = {"most_amplitude": most_amplitude, "most_force": most_force, "most_seconds": most_seconds, "tests": tests}
    seen = _seen(like)
    say = progress or silent
    noises = {"noise": noise, "force_noise": force_noise, "like": seen, "beside": _folder_of(model)}
    return planned(oscillator_of(model), want, **noises, **how, fs=fs, tries=tries, seed=seed, progress=say)


@speaks_python
def prove_on(
    model: Model | Oscillator | str | Path,
    *,
    noise: float | str | None = None,
    force_noise: float | str | None = None,
    like: Any = (),
    most_amplitude: float | str | None = None,
    hide: str | None = None,
    runs: int | None = None,
    seed: int = 0,
    progress: Say | None = None,
) -> Proof:
    """One's own rig simulated with its noise, identified again, and the stated errors counted; ``passed`` says.

    Args:
        model: the rig.
        noise: of the sensor, as ``dashpot.plan`` takes it.
        force_noise: the same of the recorded force.
        like: recordings with the same sensors, as ``dashpot.plan`` takes them.
        most_amplitude: how far it is moved; None: as far as it was identified.
        hide: a law of the model that the identification is not told of, for the diagnosis to name.
        runs: how often; None: 20, and with ``hide``, of which each takes a minute, 3.
        seed: of the noise.
        progress: called with one line a run.

    Raises:
        BadInput: noise or amplitude are not known, or the law is not in the model.

    Examples:
        >>> import dashpot
        >>> from dashpot.examples.truth import TRUTH
        >>> stand = dashpot.Model.from_values({**TRUTH, "mass": None}, name="stand")
        >>> proof = dashpot.prove_on(stand, noise="5 um", most_amplitude="5 mm", runs=2)
        >>> proof.passed, proof.simulated_by
        (True, 'an integrator that shares no code with the engine')
    """
    seen = _seen(like)
    noises = {"noise": noise, "force_noise": force_noise, "like": seen, "beside": _folder_of(model)}
    how = {"amplitude": most_amplitude, "hide": hide, "runs": runs, "seed": seed}
    return proved(oscillator_of(model), **noises, **how, progress=progress or silent)


def _folder_of(model: Any) -> Path | None:
    return Path(model).parent if isinstance(model, str | Path) else None


def _seen(like: Any) -> list[Recording]:
    return [] if isinstance(like, tuple | list) and not like else recordings_of(like)
