"""Every figure that dashpot promises, measured: accuracy, and times as ratios within one run.

    python benchmarks/run.py [--quick]

Nothing is asserted here (the tests assert accuracy); the table says what was asked and what came out.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import derivatives_time
import fmu_speed
import numpy as np
from dashpot.examples import recordings
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.export import export
from dashpot.identify import identify
from dashpot.identify.problem.replay import replay
from dashpot.model import Oscillator
from dashpot.recording import read
from dashpot.simulate.casadi_step import exact_step
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import straight_lines
from dashpot.verify.fmu_run import FmuRun
from dashpot.verify.verification import verify
from diagnosis_time import measure
from independent_likelihood import compare

ROWS: list[tuple[str, str, str]] = []


def row(what: str, asked: str, measured: str) -> None:
    """One line of the table, printed at once."""
    ROWS.append((what, asked, measured))
    print(f"{what:66} {asked:>18} {measured:>26}", flush=True)


def renderings(folder: Path, seconds: float) -> None:
    """The FMUs, the CasADi step and the independent integration of the same model under the same force."""
    import fmpy.validation

    model = Oscillator.from_values(TRUTH)
    t = np.arange(round(seconds * 1000)) * 1e-3
    force = np.sin(2 * np.pi * (5.0 * t + 7.5 * t**2 / seconds))
    reference, _ = integrate(TRUTH, force, 1e-3)
    peak = np.max(np.abs(reference))
    export(model, folder / "native.fmu")
    export(model, folder / "python.fmu", backend="python")
    for backend, limit in (("native", "1e-5"), ("python", "1e-4")):
        with FmuRun(folder / f"{backend}.fmu") as run:
            began = time.perf_counter()
            x = run.record(straight_lines(force, 1e-3), t.size, 1e-3)
            spent = time.perf_counter() - began
        row(f"{backend} FMU under FMPy against the independent integration", limit, f"{_error(x, reference):.1e}")
        row("   time per communication step, set + doStep + get", "-", f"{spent / t.size * 1e6:.1f} us")
        problems = fmpy.validation.validate_fmu(str(folder / f"{backend}.fmu"))
        row(f"{backend} FMU: problems found by validate_fmu", "0", str(len(problems)))
    core, p = core_of(model), np.array(list(TRUTH.values()))
    longest = internal_step(model, TRUTH, 9e-3)
    x = core.record(p, np.zeros(2), force, t.size, 1e-3, longest)
    row("compiled engine against the independent integration", "1e-6", f"{_error(x, reference):.1e}")
    step, z, n = exact_step(model, 1e-3, longest), np.zeros(2), min(t.size, 30_000)
    x = np.zeros(n)
    for i in range(1, n):
        z = np.array(step(z, [force[i - 1], force[i]], p, 0.0, 1e-3)).ravel()
        x[i] = z[0]
    row(
        "CasADi exact step against the independent integration",
        "1e-6",
        f"{np.max(np.abs(x - reference[:n])) / peak:.1e}",
    )


def _error(x: np.ndarray, reference: np.ndarray) -> float:
    return float(np.max(np.abs(x - reference)) / np.max(np.abs(reference)))


def rig(folder: Path) -> None:
    """Identification of the built-in rig from its recordings alone, and its FMU against them."""
    files = recordings()
    train = [read(files[kind]) for kind in ("bursts", "sweep_low", "sweep_high")]
    identify(train[:1])  # compiles and imports
    began = time.perf_counter()
    identification = identify(train, name="paper-stand")
    spent = time.perf_counter() - began
    asked = {"mass": 0.5, "omega0": 0.5, "viscous": 0.5, "cubic": 3.0, "preload": 5.0, "dry": 5.0}
    for name, parameter in identification.oscillator.parameters().items():
        off = 100 * (parameter.value / TRUTH[name] - 1)
        sigmas = (parameter.value - TRUTH[name]) / (parameter.std or np.nan)
        row(
            f"{name}: off by, in percent and in its own standard errors",
            f"{asked[name]} %, 3",
            f"{off:.4f} %, {sigmas:.2f}",
        )
    seconds = sum(r.duration for r in train)
    row(f"identification of {seconds:.0f} s of recordings", "20 s", f"{spent:.1f} s")
    export(identification.oscillator, folder / "rig.fmu")
    checks = verify(folder / "rig.fmu", [*train, read(files["multisine"])])
    for check in checks.recordings:
        row(f"FMU against {check.file}: NRMSE over noise floor", "1.1", f"{check.nrmse / check.noise_floor:.3f}")
        if check.backbone_max_error_hz is not None:
            row("   backbone, above 0.3 mm", "0.02 Hz", f"{check.backbone_max_error_hz:.4f} Hz")


def real(folder: Path) -> None:
    """Real recordings, as the Eq. 17 family reproduces them: free-run errors on data held out."""
    fs = 10e6 / 2**14
    columns = {"fs": fs, "force": "V1_V", "response": "V2_V"}
    whole = read(folder / "silverbox_snls80mv.csv.gz", **columns)
    multisines, arrow = whole.slice(40_650, 127_400), whole.slice(100, 40_575)
    edge = int(0.75 * multisines.n)
    began = time.perf_counter()
    model = identify([multisines.slice(0, edge)]).oscillator
    row("Silverbox: identification of 107 s of multisines", "-", f"{time.perf_counter() - began:.1f} s")
    for name, test, last in (("multisine", multisines.slice(edge, None), None), ("arrow", arrow, 32_000)):
        residual = 1e3 * (replay(model, test) - test.response)[50:last]
        text = f"{np.sqrt(np.mean(residual**2)):.2f} mV, {np.std(residual):.2f} mV"
        row(f"Silverbox {name}: free-run rms error, and without its mean", "as it is", text)
    ship = read(folder / "kvlcc2_roll_21338.csv.gz")
    identification = identify([ship])
    row(
        "ship roll decay: mass; NRMSE",
        "null",
        f"{identification.oscillator.mass}; {identification.fit.segments[0].nrmse:.3f}",
    )


def main() -> None:
    """Print the table."""
    quick = "--quick" in sys.argv[1:]
    print(f"{'what':66} {'asked':>18} {'measured':>26}")
    with tempfile.TemporaryDirectory() as folder:
        renderings(Path(folder), 20.0 if quick else 120.0)
        for line in fmu_speed.rows(Path(folder), fmu_speed.reference_fmus()):
            row(*line)
        rig(Path(folder))
    for what, cost in derivatives_time.rows():
        row(
            f"{derivatives_time.COUNT} derivatives in one run: {what}",
            f"{derivatives_time.AIM:.0f} plain runs",
            f"{cost:.1f}",
        )
    data = Path(os.environ.get("DASHPOT_DATA") or Path(__file__).resolve().parents[2] / "shared" / "data")
    if data.is_dir():
        real(data)
    else:
        print("real recordings: not here; set DASHPOT_DATA to their folder")
    ours, theirs, gain = compare(read(recordings()["sweep_high"]).slice(20_000, 22_000 if quick else 30_000))
    row("same likelihood, one record: solve_ivp + least_squares over ours", "ratio", f"{theirs / ours:.0f} x")
    row("   ours, theirs", "-", f"{ours:.2f} s, {theirs:.1f} s")
    row("   log-likelihood of scipy's answer above ours", "-", f"{gain:.2f}")
    for law in ("nothing",) if quick else ("nothing", "quadratic-drag", "stribeck", "two-sided-stop"):
        seconds, ratio, verdict = measure(law)
        row(f"diagnosis of 3 x 40 s at 1 kHz, concealed: {law}", "60 s", f"{seconds:.0f} s, {verdict}")
        row("   the same in simulations of the training records", "-", f"{ratio:.0f}")


if __name__ == "__main__":
    main()
