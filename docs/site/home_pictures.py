"""The three pictures of README and home page, made from built-in recordings: python -P docs/site/home_pictures.py [DIR].

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
from dashpot.face.workflow import diagnosed, identified, page_of_diagnosis
from dashpot.recording import Recording, read
from dashpot.report.chart import Chart
from dashpot.report.matplotlib_figure import drawn
from dashpot.report.page import identification_page

FOLDER = Path(__file__).resolve().parents[1]
#: File, and what it shows.
PICTURES = {
    "home-recording.svg": "recording-1",
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
    shown = [*identification_page(fit).charts, *page_of_diagnosis(found, fmu).charts]
    by_key = {chart.key: chart for chart in shown}
    return {file: by_key[key] for file, key in PICTURES.items()}


def main(arguments: list[str]) -> None:
    """Make them again, into the folder given or in their place."""
    folder = Path(arguments[0]) if arguments else FOLDER
    for file, chart in charts().items():
        content = drawn(chart, "svg")
        (folder / file).write_bytes(content)
        print(f"{folder / file}: {len(content) / 1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
