"""How every picture looks, and how a matplotlib figure becomes text to put into a page.

Colours are those of Okabe and Ito (2008), which people with any kind of colour vision can tell apart; every series
also differs in line or marker. Matplotlib is used through its objects, never pyplot, so that no state is shared.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
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
_NUMBER = re.compile(r"-?\d+\.\d{2,}")
_FONT = 'font-family: system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, sans-serif'


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


@contextmanager
def drawing(width: float = WIDTH, height: float = 4.0) -> Iterator[Any]:
    """A matplotlib Figure of that size in inches, in this style.

    Draw on it and call ``svg`` within the block.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasSVG(figure)
        yield figure


def svg(figure: Any, key: str, title: str) -> str:
    """The figure as an SVG element: the same figure gives the same text, and nothing in it points outside.

    Args:
        figure: made by ``drawing``.
        key: a word of letters, digits and hyphens that no other picture of the page has; identifiers start with it.
        title: what the picture shows, for those who cannot see it.
    """
    import matplotlib

    matplotlib.rcParams["svg.hashsalt"] = key
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    # its rule for every element would reach the whole page
    text = re.sub(r"<defs>\s*<style[^>]*>.*?</style>\s*</defs>\s*", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{key}-', text)
    text = re.sub(r'(xlink:href="#|url\(#)', rf"\1{key}-", text)
    text = re.sub(r'(\b(?:d|points|transform|x|y)=")([^"]*)"', _rounded, text)
    text = re.sub(r"font-family: [^;\"]*; ?", "", text)  # that of the head holds for all
    text = re.sub(r' transform="rotate\(-0 [^"]*"', "", text)
    text = re.sub(r"font: ([^\"';]*?)(\d[\d.]*px) [^;\"]*", r"font-size: \2; \1", text)
    text = re.sub(r'style="font-size: ([\d.]+px); (\d+ |bold |italic )', r'style="font-size: \1; font-weight: \2', text)
    text = re.sub(r"\n\s*", "\n", text)
    box = re.search(r'viewBox="([^"]*)"', text)
    size = box.group(1) if box else f"0 0 {72 * WIDTH} 288"
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="{size}" '
        f'role="img" aria-labelledby="{key}-title" '
        f"style='stroke-linejoin: round; stroke-linecap: butt; {_FONT}'>\n"
        f'<title id="{key}-title">{escape(title)}</title>'
    )
    return re.sub(r"<svg[^>]*>", lambda _: head, text, count=1).strip()


def _rounded(match: re.Match[str]) -> str:
    """Coordinates to a hundredth of a point."""
    numbers = _NUMBER.sub(lambda m: f"{float(m.group()):.2f}".rstrip("0").rstrip("."), match.group(2))
    return f'{match.group(1)}{numbers.replace(chr(10), "")}"'


def log_ticks(axis: Any) -> None:
    """Ticks of a logarithmic matplotlib axis: decades, and 2 and 5 between them where there are few decades."""
    from matplotlib.ticker import LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1.0,) if high > 30 * low else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(tick_text)
    axis.set_minor_formatter(NullFormatter())


def legend_below(figure: Any, handles: Any, labels: Any, columns: int) -> None:
    """One legend for the whole figure, below it."""
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, handlelength=3.0, columnspacing=1.8)
