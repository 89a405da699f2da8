"""The page of a Hilbert analysis: FREEVIB and FORCEVIB, their parameters, curves and characteristics."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..export.render import plain_text
from ..identify.hilbert.hilbert_files import UNITS, force_unit_of, shown_value, so_many
from ..model import Response, units
from ..model.display import full_stop, number, pretty_unit, quantity_text, times_text
from ..model.parameter import Parameter
from ..recording.as_recorded import of_length
from .blocks import Block, Code, Items, Page, Section, Table, Text, picture
from .hilbert_figures import BAND, characteristic_figure, curves_figure, time_figure
from .levels import sine_levels
from .modal_table import laws_table, modal_table
from .provenance import files_text
from .within_figure import within_figure

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import ModalCurve
    from ..recording.as_recorded import InUnit
    from ..recording.recording import Recording

_NAMES = {"freevib": "FREEVIB", "forcevib": "FORCEVIB"}


def hilbert_page(
    analysis: HilbertAnalysis,
    recordings: Sequence[Recording],
    files: Sequence[str] = (),
    truth: Mapping[str, float] | None = None,
) -> Page:
    """The page.

    Args:
        analysis: of these recordings.
        recordings: as they were read.
        files: names of the files made beside the page.
        truth: true values by parameter name, where they are known.
    """
    unit = Response(recordings[0].quantity, recordings[0].unit).displacement_unit
    force, length = force_unit_of(recordings), of_length(recordings, unit)
    sections = [
        Section("Parameters", tuple(_parameters(analysis, unit, force, length, truth))),
        Section("Backbones and response", tuple(_backbones(analysis, recordings, unit))),
        Section("Spring and friction", tuple(characteristics(analysis, recordings, unit))),
        Section("Over time", tuple(_over_time(analysis, unit, force, length))),
        Section("Within the cycle", tuple(_within_the_cycle(analysis, unit, length))),
        Section("Left aside", (Items(tuple(full_stop(note) for note in analysis.notes)),) if analysis.notes else ()),
        Section("Where the numbers come from", (*_recordings(recordings), *files_text(files))),
    ]
    count = {name: len(analysis.of(method)) for method, name in _NAMES.items()}
    lead = Text(
        f"{so_many(count['FREEVIB'], 'free decay')} by FREEVIB, {so_many(count['FORCEVIB'], 'driven stretch')} by "
        "FORCEVIB. All numbers here are those of the Hilbert transform alone; dashpot identify fits the motion itself."
    )
    names = dict.fromkeys(r.name.partition("#")[0] for r in recordings)
    how = "Next, the model that fits the motion itself (with the options that the recordings were read with):"
    again = Code(how, f"dashpot identify {shlex.join(names)} -o rig.yaml --report rig.html")
    blocks = [*_warning(analysis), lead, again]
    return Page("Hilbert analysis", sections, lead=blocks)


def _warning(analysis: HilbertAnalysis) -> list[Text]:
    """That the laws leave more than noise, and that no errors are stated there."""
    fits = {name: getattr(analysis, method) for method, name in _NAMES.items()}
    left = [
        f"{times_text(fit.over_noise)} times the noise of {name}'s curves"
        for name, fit in fits.items()
        if fit is not None and not fit.has_errors
    ]
    if not left:
        return []
    words = (
        f"Eqs. 1, 6 and 7 leave {' and '.join(left)}. Something else moves the rig, or it was swept too fast; the "
        "parameters stand in for that, so no error would hold, and none is stated there."
    )
    return [Text(words, "warn", "▲ More than noise is left.")]


def characteristics(analysis: HilbertAnalysis, recordings: Sequence[Recording], unit: str) -> list[Block]:
    """Figs. 5 and 7 with what stands below them."""
    mass = None if analysis.forcevib is None else analysis.forcevib.mass
    force_unit = force_unit_of(recordings)
    sentence = (
        f" Bands: ± {BAND:g} standard errors. Thick: the describing function inverted, so that it is a force. Thin: "
        "Eq. 15 as printed, which is the force's fundamental."
    )
    return [
        picture(
            lambda: characteristic_figure(analysis, unit, force_unit, mass, "spring", "spring"),
            "Static characteristic of the spring (the paper's Fig. 5), whole and without its linear part." + sentence,
        ),
        picture(
            lambda: characteristic_figure(analysis, unit, force_unit, mass, "friction", "friction"),
            "Damping curve h(A) and friction over velocity (the paper's Fig. 7); as printed, Eq. 15 has h for 2 h."
            + sentence,
        ),
    ]


def _parameters(
    analysis: HilbertAnalysis, unit: str, force: str, length: InUnit, truth: Mapping[str, float] | None
) -> list[Block]:
    blocks: list[Block] = []
    table = modal_table(analysis, unit, force, truth=truth, length=length)
    if table is not None:
        blocks.append(table)
    for method, name in _NAMES.items():
        fit = getattr(analysis, method)
        if fit is None:
            continue
        caption = f"{name}'s own fits, one law at a time. Times the noise: rms of what is left over that of the noise."
        blocks.append(laws_table(fit, unit, caption, length))
        spread = analysis.spread(method)
        if spread:
            stated = {key: number(std) if fit.has_errors else "none" for key, std in fit.stds.items()}
            rows = tuple(
                (key, number(value), stated[key], pretty_unit(units.compose(UNITS[key], unit, force)))
                for key, value in spread.items()
            )
            head = ("Parameter", "Spread of single stretches", "± of all together", "Unit")
            blocks.append(Table(head, rows, (1, 2), f"{name} on each stretch by itself: standard deviation."))
    return blocks


def _backbones(analysis: HilbertAnalysis, recordings: Sequence[Recording], unit: str) -> list[Block]:
    caption = (
        "The paper's Fig. 4. Dash-dot: backbones of the decays by FREEVIB (Eq. 12); dotted: those of the driven "
        "stretches by FORCEVIB; dashed: Eq. 14 with the measured curves, at the recorded levels of force; thin: the "
        f"amplitude of the sweep as measured. Bands: ± {BAND:g} standard errors."
    )
    return [picture(lambda: curves_figure(analysis, unit, levels(analysis, recordings)), caption)]


def levels(analysis: HilbertAnalysis, recordings: Sequence[Recording]) -> tuple[float, ...]:
    """Amplitudes of the recorded sines per unit mass; none where the mass is not known."""
    if analysis.forcevib is None or analysis.forcevib.mass is None:
        return ()
    mass = analysis.forcevib.mass
    return tuple(level / mass for level in sine_levels(recordings))


def _over_time(analysis: HilbertAnalysis, unit: str, force: str, length: InUnit) -> list[Block]:
    blocks, of_mass = [], pretty_unit(units.compose(UNITS["mass"], unit, force))
    for i, curve in enumerate(analysis.curves):
        what = "free decay, FREEVIB" if curve.method == "freevib" else "driven stretch, FORCEVIB"
        caption = f"{plain_text(curve.recording)}, stretch {i + 1}: {what}. Bands: ± {BAND:g} standard errors."
        if curve.fit is not None:
            fit = curve.fit
            leans = shown_value("F0/k", fit.derived["F0/k"], fit.derived_std["F0/k"], unit, force, length)
            terms = [f"F0/k {quantity_text(leans) if leans.std else f'{number(leans.value)} {leans.unit}'}"]
            if fit.mass is not None:
                terms.insert(0, f"mass {number(fit.mass, 5)}{_error(fit.mass_std)} {of_mass}")
            caption += f" By itself: {', '.join(terms)}."
        if curve.cut:
            caption += (
                f" Its last {number(curve.cut, 2)} s are left out: friction stops it within the reach of the method's "
                "low-passes, which bends it there."
            )
        low, high = curve.decrement[curve.amplitude.argmin()], curve.decrement[curve.amplitude.argmax()]
        caption += (
            f" Logarithmic decrement {number(float(high))} at the largest amplitude, {number(float(low))} at the least."
        )
        blocks.append(picture(lambda c=curve, i=i: time_figure(c, unit, f"time-{i + 1}"), caption))
    return blocks


def _error(std: float) -> str:
    """The standard error behind a value; nothing where none is stated."""
    return f" ± {number(std, 2)}" if math.isfinite(std) else ""


def _within_the_cycle(analysis: HilbertAnalysis, unit: str, length: InUnit) -> list[Block]:
    """Of the decay that reaches farthest; the CSV file has every one."""
    decays = [curve for curve in analysis.of("freevib") if curve.within is not None]
    if not decays:
        return []
    curve = max(decays, key=lambda curve: float(curve.amplitude.max()))
    caption = (
        f"The decay of {plain_text(curve.recording)} that reaches farthest. Left: the natural frequency at each "
        "instant of its largest cycles. Middle: what a sine leaves out. Right: of the motion above and below "
        "rest, each by the time spent there: two curves where the rig is asymmetric."
    )
    return [picture(lambda: within_figure(curve, unit), caption + _largest(curve, *length))]


def _largest(curve: ModalCurve, factor: float, unit: str) -> str:
    """What happens within the largest cycle of a decay, in a sentence; lengths in ``unit``, of which SI has fewer."""
    cycle = curve.within
    assert cycle is not None  # the caller asks for decays that have it
    at = curve.amplitude.argmax()
    pull = Parameter(factor * float(cycle.restoring[at]), factor * float(cycle.restoring_std[at]), f"{unit}/s2")
    sides = " and ".join(
        f"{number(factor * float(peak[at]), 4)} {unit} at {number(float(omega[at] / (2 * np.pi)), 5)} Hz {side} rest"
        for side, peak, omega in zip(("above", "below"), cycle.peaks, cycle.omega, strict=True)
    )
    reach = number(factor * float(cycle.amplitude[at]), 4)
    return (
        f" With its harmonics the largest cycle reaches {reach} {unit}, where the "
        f"spring pulls with {quantity_text(pull)}; its half-waves have {sides}."
    )


def _recordings(recordings: Sequence[Recording]) -> tuple[Table, ...]:
    rows = tuple((r.name, f"{number(r.duration, 4)} s", r.sha256 or "not read from a file") for r in recordings)
    return (Table(("Recording", "Length", "SHA-256 of the file"), rows, (1,)),)
