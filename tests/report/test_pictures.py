"""Pictures: sound SVG with a unit in every label, small, the same every time, and the physics in them right."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import islice
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest
from dashpot.identify import Identification
from dashpot.identify.hilbert.static_force import static_force
from dashpot.recording import Recording
from dashpot.report.backbone_distance import distance_figure
from dashpot.report.backbone_figure import backbone_figure
from dashpot.report.characteristics import friction_figure, stiffness_figure
from dashpot.report.comparison import comparisons
from dashpot.report.decimate import envelope
from dashpot.report.levels import sine_level, sine_levels
from dashpot.report.residual import spectrum_figure
from dashpot.report.time_history import agreement_figure, recording_figure

LABEL = re.compile(
    r"(Frequency|Amplitude|Time|Force|Displacement|Velocity|Damping|Spectral|Model −|Friction force|Restoring force)"
)
TITLES = {"Friction force", "Restoring force", "Damping curve"}


def pictures(identification: Identification, verified: Callable[..., object] | None = None) -> Iterator[str]:
    proof = verified(identification) if verified else None
    yield backbone_figure(identification, proof)  # pyright: ignore[reportArgumentType]
    if identification.measured.curves:  # noise alone gives no backbone to be held against
        yield distance_figure(identification, proof)  # pyright: ignore[reportArgumentType]
    yield stiffness_figure(identification)
    yield friction_figure(identification)
    for r, decays in zip(identification.recordings, identification.hilbert.decays, strict=True):
        yield recording_figure(r, decays)
    for c in comparisons(identification, proof):  # pyright: ignore[reportArgumentType]
        yield agreement_figure(c, "displacement", identification.oscillator.response.unit)
        yield spectrum_figure(c, 12.0, identification.oscillator.response.unit)


@pytest.mark.parametrize("kind", ["stand", pytest.param("roll", marks=pytest.mark.long), "volts"])
def test_every_picture_is_sound_small_and_labelled_with_units(kind, identifications, verified) -> None:
    for text in pictures(identifications[kind](), verified):
        tree = ElementTree.fromstring(text)
        assert tree.get("role") == "img"
        title = tree.find("{http://www.w3.org/2000/svg}title")
        assert title is not None
        assert title.text
        assert tree.get("aria-labelledby") == title.get("id")
        assert len(text) < 150_000
        words = [(e.text or "").strip() for e in tree.iter("{http://www.w3.org/2000/svg}text")]
        labels = [w for w in words if LABEL.match(w) and w not in TITLES]
        assert len(labels) >= 2
        assert [w for w in labels if not re.search(r"\[[^\]]+\]$", w)] == []
        assert not any("$" in w for w in words)
        numbers = " ".join(e.get("d") or "" for e in tree.iter())
        assert "nan" not in numbers.lower()
        assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]*"', "", text)


def test_pictures_are_the_same_every_time_whatever_the_user_has_set(identifications) -> None:
    identification = identifications["volts"]()
    first = list(islice(pictures(identification), 1, 5))
    with matplotlib.rc_context({"font.size": 30, "svg.fonttype": "path", "axes.grid": False}):
        second = list(islice(pictures(identification), 1, 5))
        assert matplotlib.rcParams["font.size"] == 30
    assert first == second


def test_drawing_does_not_load_pyplot() -> None:
    import subprocess
    import sys

    program = (
        "import sys, numpy as np\n"
        "from dashpot.recording import Recording\n"
        "import dashpot.report.page\n"
        "assert 'matplotlib' not in sys.modules\n"
        "from dashpot.report.time_history import recording_figure\n"
        "recording_figure(Recording('a', 10.0, np.sin(np.arange(100.0))))\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    run = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_a_long_recording_stays_small_and_keeps_its_spike() -> None:
    x = np.sin(np.arange(400_000) * 0.08)
    x[123_456] = 5.0
    text = recording_figure(Recording("long.csv", 1000.0, x, x))
    assert len(text) < 150_000
    e = envelope(np.arange(x.size) / 1000.0, x)
    assert e.high.max() == 5.0
    assert e.time[np.argmax(e.high)] == pytest.approx(123.456, abs=0.3)
    # a cycle is 78.5 samples and a stretch 444: the rms over a part of a cycle adds little
    assert np.median(e.rms) == pytest.approx(np.sqrt(0.5), rel=0.05)


def test_envelope_passes_over_what_is_not_there() -> None:
    signal = np.concatenate([np.full(50, np.nan), np.ones(50)])
    e = envelope(np.arange(100.0), signal, 10)
    assert np.all(np.isnan(e.low[:5]))
    assert np.all(e.high[5:] == 1.0)


@pytest.mark.parametrize(
    ("force", "fundamental"),
    [
        (lambda x: 3.0 * x, lambda a: 3.0 * a),
        (lambda x: 2.0 * x**3 + x, lambda a: 1.5 * a**3 + a),
        (lambda x: 0.7 * np.sign(x) + x, lambda a: 4 / np.pi * 0.7 + a),
        (lambda x: x * np.abs(x), lambda a: 8 / (3 * np.pi) * a**2),
    ],
    ids=["linear", "cubic", "preload", "quadratic drag"],
)
def test_the_describing_function_is_inverted(force, fundamental) -> None:
    a = np.geomspace(0.02, 2.0, 4000)
    characteristic = static_force(a, fundamental(a))
    assert characteristic.at.size >= 30
    assert np.max(np.abs(characteristic.force - force(characteristic.at))) < 0.01 * np.max(
        np.abs(force(characteristic.at))
    )


def test_static_force_of_too_little_is_empty() -> None:
    assert static_force(np.array([1.0, 2.0]), np.array([1.0, 2.0])).at.size == 0


def test_levels_of_sines_and_of_nothing_else() -> None:
    t = np.arange(20_000) / 1000.0
    sweep = 0.3 * np.sin(2 * np.pi * (5 * t + 0.3 * t**2))
    bursts = np.where(t % 5 < 1.5, 1.2 * np.sin(2 * np.pi * 13 * t), 0.0)
    noise = np.random.default_rng(0).standard_normal(t.size)
    records = [Recording("r", 1000.0, sweep, force) for force in (sweep, bursts, noise, None, 1.02 * sweep)]
    assert sine_level(records[0]) == pytest.approx(0.3, rel=0.01)
    assert sine_level(records[1]) == pytest.approx(1.2, rel=0.02)
    assert sine_level(records[2]) is None
    assert sine_level(records[3]) is None
    assert sine_levels(records) == pytest.approx((0.3, 1.2), rel=0.02)
