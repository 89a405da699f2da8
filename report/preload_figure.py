"""Fig. 1 of the paper: force and backbone of a preloaded spring."""

from __future__ import annotations

import numpy as np

from ..model.backbone import preload_backbone
from ..model.display import scale_of
from .style import EXACT, MODEL, drawing, legend_below, svg

#: Amplitudes to so many times F0/k.
_REACH = 6.0
#: Where the frequency is twice omega0, in F0/k: 1/(1 + A k/F0) = cos(pi/4).
TWICE = float(np.sqrt(2.0) - 1.0)


def preload_figure(omega0: float, preload: float, mass: float, key: str = "preload") -> str:
    """SVG of the static force over displacement, and of Eq. 1 with the amplitude at which it has doubled.

    Args:
        omega0: rad/s.
        preload: F0/m, m/s².
        mass: kg.
        key: name of the picture within its page.
    """
    unit = preload / omega0**2
    x = np.concatenate([-np.linspace(_REACH, 0, 60), np.linspace(0, _REACH, 60)]) * unit
    sign = np.repeat([-1.0, 1.0], 60)
    force = mass * (omega0**2 * x + preload * sign)
    across, up = scale_of("m", x), scale_of("N", force)
    a = np.geomspace(0.02, _REACH, 240) * unit
    with drawing(height=3.3) as figure:
        static, backbone = figure.subplots(1, 2)
        static.plot(x * across.factor, force * up.factor, color=MODEL, label="preloaded spring")
        static.plot(
            x * across.factor, mass * omega0**2 * x * up.factor, "--", color=EXACT, lw=0.9, label="without preload"
        )
        static.set_xlabel(across.label("Displacement"))
        static.set_ylabel(up.label("Force"))
        static.set_title("Static force")
        backbone.plot(preload_backbone(omega0, preload, a) / omega0, a * across.factor, color=MODEL)
        backbone.axvline(1.0, color=EXACT, linestyle="--", linewidth=0.9)
        backbone.plot([2.0], [TWICE * unit * across.factor], "o", color=EXACT, label="doubled, at 0.414 F0/k")
        backbone.set_xlim(0.9, 4.0)
        backbone.set_ylim(0, None)
        backbone.set_xlabel("ω/ω₀")
        backbone.set_ylabel(across.label("Amplitude"))
        backbone.set_title("Backbone, Eq. 1")
        handles, labels = static.get_legend_handles_labels()
        more, words = backbone.get_legend_handles_labels()
        legend_below(figure, handles + more, labels + words, columns=3)
        return svg(figure, key, "Preloaded spring: force over displacement, and amplitude over natural frequency")
