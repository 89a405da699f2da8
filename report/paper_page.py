"""The paper's figures on one page, from recordings of a stand whose parameters are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..identify.hilbert.modal_result import ModalFit
from ..identify.hilbert.static_force import quasi_steady_amplitude
from ..model.backbone import preload_backbone
from ..model.display import number, scale_of
from .blocks import Block, Page, Section, Text, picture
from .chart import Chart
from .hilbert_figures import BAND, curves_figure
from .hilbert_page import characteristics, levels
from .modal_table import modal_table
from .style import EXACT, MODEL
from .time_history import recording_figure

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.motion.decay import Decay
    from ..recording.recording import Recording

_UNIT = "m"


def paper_page(
    analysis: HilbertAnalysis,
    free: Recording,
    decays: Sequence[Decay],
    sweep: Recording,
    truth: Mapping[str, float],
) -> Page:
    """The page: Figs. 1 and 3 to 7 of Feldman, Bucher, Rotberg 2009.

    Args:
        analysis: of both recordings.
        free: bursts with free decays.
        decays: these.
        sweep: slow, through the resonance.
        truth: the stand's parameters.
    """
    recordings = (free, sweep)
    forced = analysis.forcevib
    sections = [
        Section("Fig. 1: preloaded spring", (_preload(forced),) if forced is not None else ()),
        Section("Fig. 3: bursts and free decays", (_history(free, decays, "fig-3"),)),
        Section("Fig. 4: backbones and frequency response", tuple(_backbones(analysis, recordings))),
        Section("Figs. 5 and 7: static characteristics", tuple(characteristics(analysis, recordings, _UNIT))),
        Section("Fig. 6: sweep", (_history(sweep, (), "fig-6"),)),
        Section("Parameters", tuple(filter(None, [modal_table(analysis, _UNIT, "N", truth=truth)]))),
    ]
    lead = Text(
        "The figures of Feldman, Bucher and Rotberg (2009), remade from simulated recordings of "
        "their stand: Eq. 17 with "
        "the printed parameters in SI, 1 µm of sensor noise and 0.1 % of force noise. docs/paper.md has the equations "
        "and errata."
    )
    return Page("The paper's figures", sections, lead=[lead], numbered=False)


def sweep_is_slow(analysis: HilbertAnalysis) -> float:
    """How far Eq. 13 along the sweeps is from the amplitudes measured there: rms of the difference over the largest.

    Small where the sweep may be read as a frequency response. NaN without a sweep.
    """
    parts, top = [], 0.0
    for curve in analysis.of("forcevib"):
        if curve.fit is None or curve.fit.mass is None or np.ptp(curve.omega) < 0.2 * np.median(curve.omega):
            continue
        parts.append(quasi_steady_amplitude(curve, curve.fit.mass) - curve.amplitude)
        top = max(top, float(curve.amplitude.max()))
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) / top if parts else float("nan")


def _preload(forced: ModalFit) -> Block:
    values, mass = forced.both.values, forced.mass or 1.0
    caption = (
        f"With FORCEVIB's omega0 and preload: F0 = {number(mass * values['preload'])} N, F0/k = "
        f"{number(forced.derived['F0/k'])} m. The frequency doubles at 0.414 F0/k, not at half of F0/k as in the text."
    )
    return picture(lambda: preload_figure(values["omega0"], values["preload"], mass), caption)


def _history(recording: Recording, decays: Sequence[Decay], key: str) -> Block:
    caption = "Force and displacement as recorded, by their envelopes where there are too many cycles to see."
    if decays:
        caption += " Shaded: the free decays that FREEVIB evaluates."
    taken = [("free", decay.start, decay.stop) for decay in decays]
    return picture(lambda: recording_figure(recording, taken, key), caption)


def _backbones(analysis: HilbertAnalysis, recordings: Sequence[Recording]) -> list[Block]:
    caption = (
        f"Dash-dot: the decays, each by FREEVIB (Eq. 12); dotted: driven stretches by FORCEVIB; bands: ± {BAND:g} "
        "standard errors. Dashed: Eq. 14 with the measured curves in it; thin: the amplitude of the sweep as measured. "
        f"Along the sweep Eq. 13 is within {number(100 * sweep_is_slow(analysis), 2)} % of the "
        f"largest amplitude, rms: it is slow enough."
    )
    return [picture(lambda: curves_figure(analysis, _UNIT, levels(analysis, recordings), "fig-4"), caption)]


# Fig. 1 of the paper: force and backbone of a preloaded spring.

#: Amplitudes to so many times F0/k.
_REACH = 6.0
#: Where the frequency is twice omega0, in F0/k: 1/(1 + A k/F0) = cos(pi/4).
TWICE = float(np.sqrt(2.0) - 1.0)


def preload_figure(omega0: float, preload: float, mass: float, key: str = "preload") -> Chart:
    """Chart of the static force over displacement, and of Eq. 1 with the amplitude at which it has doubled.

    Args:
        omega0: rad/s.
        preload: F0/m, m/s².
        mass: kg.
        key: name of the chart within its page.
    """
    unit = preload / omega0**2
    x = np.concatenate([-np.linspace(_REACH, 0, 60), np.linspace(0, _REACH, 60)]) * unit
    sign = np.repeat([-1.0, 1.0], 60)
    force = mass * (omega0**2 * x + preload * sign)
    across, up = scale_of("m", x), scale_of("N", force)
    a = np.geomspace(0.02, _REACH, 240) * unit
    chart = Chart(key, "Preloaded spring: force over displacement, and amplitude over natural frequency")
    static, backbone = chart.row(1, 1)
    static.line(x * across.factor, force * up.factor, MODEL, "preloaded spring")
    static.line(x * across.factor, mass * omega0**2 * x * up.factor, EXACT, "without preload", dash="--", width=0.9)
    static.x.set(label=across.label("Displacement"))
    static.y.set(label=up.label("Force"))
    static.title = "Static force"
    backbone.line(preload_backbone(omega0, preload, a) / omega0, a * across.factor, MODEL)
    backbone.rule(1.0, EXACT, width=0.9, upright=True)
    backbone.dots([2.0], [TWICE * unit * across.factor], EXACT, "doubled, at 0.414 F0/k", size=5.0)
    backbone.x.set(label="ω/ω₀", low=0.9, high=4.0)
    backbone.y.set(label=across.label("Amplitude"), low=0.0)
    backbone.title = "Backbone, Eq. 1"
    return chart
