"""What the identification of a long recording takes: processor, memory, and how far it is from the truth.

    python benchmarks/long_recordings.py [MILLIONS ...]

A sweep of the paper's rig through its resonance at 1 kHz, as long as asked for (0.1, 0.3 and 1.2 million samples), each
in a process of its own. Printed are the seconds of processor, those that each million samples take (which stay alike
where the time is linear), the seconds that pass, the peak memory above that of a process in which a short recording has
just been identified, over what the recording's own numbers take (time, force and response), and by how many of its
standard errors the parameter is off that is off the most.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.recording import Recording

FS = 1000.0
MILLIONS = ("0.1", "0.3", "1.2")
_SHORT = 8000
_COLUMNS = 3


def sweep(n: int) -> Recording:
    """A recording of n samples."""
    return recording_of(
        sweep=(1.0, 5.0, 20.0), fs=FS, seconds=n / FS, noise=2e-6, force_noise=1e-3, name=f"sweep of {n}"
    )


def _resident() -> int:
    """Bytes that this process has in memory."""
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def measured(n: int) -> str:
    """One row of the table."""
    recording = sweep(n)
    identify([sweep(_SHORT)])
    own = 8 * n
    assert recording.force is not None
    base = _resident() - recording.force.nbytes - recording.response.nbytes
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # the peak is counted from here
    before, clock = time.process_time(), time.perf_counter()
    found = identify([recording]).oscillator.parameters()
    seconds, passed = time.process_time() - before, time.perf_counter() - clock
    status = Path("/proc/self/status").read_text(encoding="ascii")
    peak = 1024 * int(next(line for line in status.splitlines() if line.startswith("VmHWM")).split()[1])
    off = max(abs(p.value - TRUTH[name]) / p.std for name, p in found.items() if p.std)
    return (
        f"{n / 1e6:10.2f} {seconds:11.1f} {seconds / n * 1e6:15.1f} {passed:10.1f} "
        f"{(peak - base) / (_COLUMNS * own):13.1f} {off:22.2f}"
    )


def main() -> None:
    """Measure each length in a process of its own."""
    if sys.argv[1:2] == ["--one"]:
        print(measured(round(1e6 * float(sys.argv[2]))), flush=True)
        return
    print("million samples  processor s  s a million  passed s  memory/numbers  off (standard errors)")
    for millions in sys.argv[1:] or MILLIONS:
        subprocess.run([sys.executable, "-P", __file__, "--one", millions], check=True)


if __name__ == "__main__":
    main()
