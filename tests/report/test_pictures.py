"""Pictures: a unit in every label, the same every time, and the physics in them right."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from dashpot.identify import Identification
from dashpot.identify.hilbert.static_force import static_force
from dashpot.recording import Recording
from dashpot.report.backbone_distance import distance_figure
from dashpot.report.backbone_figure import backbone_figure
from dashpot.report.characteristics import friction_figure, stiffness_figure
from dashpot.report.chart import Chart, Dots, Line
from dashpot.report.comparison import comparisons
from dashpot.report.d3_chart import as_json
from dashpot.report.levels import sine_level, sine_levels
from dashpot.report.residual import spectrum_figure
from dashpot.report.time_history import agreement_figure, recording_figure
from dashpot.report.used import taken


def pictures(identification: Identification, verified: Callable[..., object] | None = None) -> Iterator[Chart]:
    proof = verified(identification) if verified else None
    yield backbone_figure(identification, proof)  # pyright: ignore[reportArgumentType]
    if identification.measured.curves:  # noise alone gives no backbone to be held against
        yield distance_figure(identification, proof)  # pyright: ignore[reportArgumentType]
    yield stiffness_figure(identification)
    yield friction_figure(identification)
    for i, r in enumerate(identification.recordings):
        yield recording_figure(r, taken(identification, i), f"recording-{i}")
    for i, c in enumerate(comparisons(identification, proof)):  # pyright: ignore[reportArgumentType]
        yield agreement_figure(c, "displacement", identification.oscillator.response.unit, f"agreement-{i}")
        yield spectrum_figure(c, 12.0, identification.oscillator.response.unit, f"spectrum-{i}")


@pytest.mark.parametrize("kind", ["stand", pytest.param("roll", marks=pytest.mark.long), "volts"])
def test_every_picture_has_a_title_and_units_and_something_within_its_view(kind, identifications, verified) -> None:
    for chart in pictures(identifications[kind](), verified):
        assert chart.title
        for panel in chart.panels:
            for axis in (panel.x, panel.y):
                assert re.search(r"\[[^\]]+\]$", axis.label)
            (low, high), (bottom, top) = panel.limits("x"), panel.limits("y")
            seen = [
                np.any((m.x >= low) & (m.x <= high) & (m.y >= bottom) & (m.y <= top))
                for m in panel.marks
                if isinstance(m, Line | Dots)
            ]
            assert any(seen)


def test_pictures_are_the_same_every_time(identifications) -> None:
    identification = identifications["volts"]()
    assert as_json(list(pictures(identification))) == as_json(list(pictures(identification)))


def test_a_page_is_written_without_matplotlib_or_the_package_that_ships_d3() -> None:
    import subprocess
    import sys

    program = (
        "import sys, numpy as np\n"
        "from dashpot.recording import Recording\n"
        "from dashpot.report.blocks import Figure, Page, Section\n"
        "import dashpot.report.page, dashpot.report.diagnosis_page\n"
        "from dashpot.report.time_history import recording_figure\n"
        "chart = recording_figure(Recording('a', 10.0, np.sin(np.arange(100.0))))\n"
        "assert 'd3' in Page('t', [Section('s', (Figure(chart, 'c'),))]).html\n"
        "assert not {'matplotlib', 'mpld3', 'IPython'} & set(sys.modules)\n"
    )
    run = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


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
