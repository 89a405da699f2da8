"""The three pictures of README and home page, from built-in recordings: python -P docs/site/home_pictures.py [DIR].

They are what the pages of `identify` and `diagnose` show: a recording with its model, the backbone that the recording
shows beside the model's, and damping before and after a diagnosis of the rig with a hidden drag. A test makes them
again and compares.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from dashpot.examples import recordings
from dashpot.examples.broken import FS, records
from dashpot.face.model import Model
from dashpot.face.workflow import diagnosed, identified, page_of_diagnosis
from dashpot.identify.identification import Identification
from dashpot.recording import Recording, read
from dashpot.report.chart import Chart
from dashpot.report.matplotlib_figure import drawn
from dashpot.report.page import identification_page
from dashpot.report.style import MEASURED, MODEL

FOLDER = Path(__file__).resolve().parents[1]
#: File, and what it shows.
PICTURES = {
    "home-recording.svg": "home-recording",
    "home-backbone.svg": "backbone",
    "home-diagnosis.svg": "mended-curves",
}


def charts() -> dict[str, Chart]:
    """The chart of each file."""
    bursts = read(recordings()["bursts"], part=(0.0, 5.0))
    fit = identified(lambda: [bursts], name="stand")
    (decay,) = records("quadratic-drag", names=["ringdown"])
    ringdown = Recording("ringdown", FS, np.asarray(decay.shown))
    plain = identified(lambda: [ringdown], name="broken", mass=0.27)
    found, fmu = diagnosed(plain.oscillator, [ringdown], [], seconds=math.inf)
    shown = [_recording(bursts, fit), *identification_page(fit).charts, *page_of_diagnosis(found, fmu).charts]
    by_key = {chart.key: chart for chart in shown}
    return {file: by_key[key] for file, key in PICTURES.items()}


def _recording(recording: Recording, fit: Identification) -> Chart:
    """A recording, and its model along a part of it."""
    along = Model(fit.oscillator, fit).simulate(recording)
    chart = Chart("home-recording", "A recording of the built-in rig, and the response of its model")
    whole, part = chart.row(1.4, 1, height=220)
    measured, few = 1e3 * recording.response, slice(0, 2600, 4)
    near = slice(1430, 1730, 2)
    whole.line(along.time[few], measured[few], color=MEASURED, width=0.8, label="measured")
    part.line(along.time[near], measured[near], color=MEASURED, width=3.0)
    part.line(along.time[near], 1e3 * along.response[near], color=MODEL, width=1.1, label="model")
    whole.title, part.title = "A burst of force, and the decay behind it", "The model along it"
    for panel in (whole, part):
        panel.x.set(label="Time [s]")
        panel.y.set(label="Displacement [mm]")
    return chart


def main(arguments: list[str]) -> None:
    """Make them again, into the folder given or in their place."""
    folder = Path(arguments[0]) if arguments else FOLDER
    for file, chart in charts().items():
        content = drawn(chart, "svg")
        (folder / file).write_bytes(content)
        print(f"{folder / file}: {len(content) / 1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
