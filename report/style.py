"""How every picture looks: its colours on a page, and its style where matplotlib draws it.

Colours are those of Okabe and Ito (2008), which people with any kind of colour vision can tell apart; every series
also differs in line or marker. Matplotlib is used through its objects, never pyplot, so that no state is shared.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..model.display import tick_text

MEASURED = "#4d4d4d"
MODEL = "#d55e00"  # what is simulated: model or FMU
FREE = "#0072b2"  # FREEVIB
FORCED = "#009e73"  # FORCEVIB
RESPONSE = "#b0588f"  # Eq. 14; darker than Okabe and Ito's, for thin lines on white
EXACT = "#000000"
BEFORE = MODEL  # the family as it was given; dashed
AFTER = FREE  # the mended model; a full line
LIGHT = "#56b4e9"
GRID = "#e3e3e3"
#: What a page calls each colour; its style sheet says what that is by day and by night.
ROLES = {
    MEASURED: "measured",
    MODEL: "model",
    FREE: "free",
    FORCED: "forced",
    RESPONSE: "response",
    EXACT: "exact",
    LIGHT: "light",
    GRID: "grid",
}

#: Width of a picture in inches: 60 rem of page then show a 10 point letter as about 14 pixels.
WIDTH = 9.2

_STYLE: dict[str, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": "#555555",
    "axes.grid": True,
    "axes.labelcolor": "#222222",
    "axes.labelsize": 10,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "figure.constrained_layout.h_pad": 0.06,
    "figure.constrained_layout.w_pad": 0.06,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib, so that every machine lays out alike
    "font.size": 10,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "legend.fontsize": 9,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "svg.fonttype": "none",  # text stays text: to be searched, read out, and drawn in the page's font
    "text.parse_math": False,  # a $ in a file name is a $
    "xtick.color": "#444444",
    "xtick.labelsize": 9,
    "ytick.color": "#444444",
    "ytick.labelsize": 9,
}


@contextmanager
def styled() -> Iterator[None]:
    """Matplotlib in this style, whatever the user's own matplotlibrc says."""
    import matplotlib

    with matplotlib.rc_context(), warnings.catch_warnings():
        # a name in a script that DejaVu lacks is drawn by the browser's font all the same
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from")
        matplotlib.rcdefaults()
        settings: Any = matplotlib.rcParams  # its stubs know every key by name, and ours are text
        settings.update(_STYLE)
        yield


def log_ticks(axis: Any) -> None:
    """Ticks of a logarithmic matplotlib axis: decades, and 2 and 5 between them where there are few decades."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1.0,) if high > 30 * low else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(tick_text)
    axis.set_minor_formatter(NullFormatter())
