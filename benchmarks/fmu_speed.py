"""How fast the FMUs are, as ratios of times taken in turn within one run; their size, and how long an export takes.

    python benchmarks/fmu_speed.py [REFERENCE]

REFERENCE, else the environment variable DASHPOT_REFERENCE_FMUS, is a checkout of Reference-FMUs (Modelica Association):
its VanDerPol is compiled from there for the comparison with what others write by hand.
"""

from __future__ import annotations

import inspect
import os
import re
import sys
import sysconfig
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from dashpot.examples.truth import TRUTH
from dashpot.export.binaries import chosen
from dashpot.export.fmu import export_fmu
from dashpot.export.platforms import PLATFORMS, own_platform
from dashpot.model import Oscillator
from dashpot.simulate.compiler import FLAGS

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tests" / "export" / "hosts"))

from bare_c import prepared  # noqa: E402  (the C host of the tests)
from machines import MACHINES  # noqa: E402

Row = tuple[str, str, str]

VERSIONS = (2, 3)
DT, STEPS = 1e-3, 2000
#: The reference integrates by Euler's method in steps of this length; at shorter ones it mostly does nothing.
REFERENCE_DT = 1e-2
ROUNDS = 15
#: As the binaries of an FMU are compiled, but for the standard: the reference wants what POSIX adds.
OPTIONS = tuple(flag for flag in FLAGS if not flag.startswith("-std"))


def sweep(steps: int = STEPS) -> np.ndarray:
    t = np.arange(steps) * DT
    return np.sin(2 * np.pi * (5.0 * t + 7.5 * t**2 / t[-1]))


def in_turn(measures: dict[str, Callable[[], float]], rounds: int = ROUNDS) -> dict[str, float]:
    """The least of each measure, all of them taken in turn so that what slows the machine meets them alike."""
    turns = [{name: measure() for name, measure in measures.items()} for _ in range(rounds)]
    return {name: min(turn[name] for turn in turns) for name in measures}


def rows(folder: Path, reference: Path | None) -> Iterator[Row]:
    """What was measured, what was asked for it and what came out, one after the other."""
    model = Oscillator.from_values(TRUTH)
    ours = {v: export_fmu(model, folder / f"{v}.fmu", version=v, platforms=(own_platform(),)) for v in VERSIONS}
    yield from in_c(folder, ours, reference)
    yield from against_python(folder, model, ours[2])
    yield from under_fmpy(folder, ours)
    yield from size(folder)


def in_c(folder: Path, ours: dict[int, Path], reference: Path | None) -> Iterator[Row]:
    """One step (set, doStep, get) in a host in C against that of VanDerPol."""
    if reference is None or not (reference / "VanDerPol").is_dir():
        yield "VanDerPol of Reference-FMUs: not here; set DASHPOT_REFERENCE_FMUS", "-", "-"
    with ExitStack() as stack:

        def host(fmu: Path, *plan: object, **names: str) -> Callable[[], float]:
            play = stack.enter_context(prepared(fmu, *plan, repeat=50, **names))  # type: ignore[arg-type]
            return lambda: float(play())

        measures = {f"FMI {v}, force held": host(fmu, sweep(), DT, {}, "zero") for v, fmu in ours.items()}
        measures |= {f"FMI {v}, straight lines": host(fmu, sweep(), DT, {}, "first") for v, fmu in ours.items()}
        ones, names = np.ones(STEPS), {"source": "mu", "output": "x0"}
        if reference is not None and (reference / "VanDerPol").is_dir():
            for v in VERSIONS:
                for kind, options in (("", OPTIONS), (", not optimised", (*OPTIONS, "-O0"))):
                    fmu = van_der_pol(reference, v, options, folder / f"VanDerPol-{v}{len(kind)}.fmu")
                    measures[f"VanDerPol {v}{kind}"] = host(fmu, ones, REFERENCE_DT, {}, "zero", **names)
        least = in_turn(measures)
    for name, value in least.items():
        yield f"in a host in C, {name}: a step", "-", f"{value:.0f} ns"
        if name.startswith("FMI"):
            for kind, asked in (("", "1.5 x"), (", not optimised", "-")):
                other = least.get(f"VanDerPol {name[4]}{kind}")
                if other is not None:
                    built = kind.strip(", ") or "compiled with the same options"
                    yield f"   over that of VanDerPol, {built}", asked, f"{value / other:.2f} x"


def van_der_pol(reference: Path, version: int, options: Sequence[str], path: Path) -> Path:
    """The FMU of the checkout for this machine.

    Its own build gives no options of optimisation on Linux and macOS unless it is asked to, nor do the released ones.
    """
    here, name = MACHINES["here"], "VanDerPol"
    main = path.with_suffix(".c")
    sources = [f"src/fmi{version}Functions.c", f"{name}/model.c", "src/cosimulation.c"]
    main.write_text("".join(f'#include "{(reference / source).as_posix()}"\n' for source in sources))
    folders = [f"-I{reference / folder}" for folder in ("include", name)]
    library = here.compile(
        (*options, *folders, f"-DFMI_VERSION={version}", "-DDISABLE_PREFIX"), main, path.with_suffix(here.suffix)
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.write(reference / name / f"FMI{version}.xml", "modelDescription.xml")
        archive.write(library, f"binaries/{here.folders[version - 2]}/{name}{here.suffix}")
    return path


def against_python(folder: Path, model: Oscillator, ours: Path) -> Iterator[Row]:
    """The same host with the FMU that is made without a compiler."""
    what = "in a host in C: the back-end in Python over ours, FMI 2"
    other = export_fmu(model, folder / "python.fmu", backend="python")
    library = Path(sysconfig.get_config_var("LIBDIR") or "") / (sysconfig.get_config_var("LDLIBRARY") or "")
    environment = {
        "LD_PRELOAD": str(library),  # PythonFMU expects Python in the process
        "PYTHONHOME": sys.base_prefix,
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
    }
    force = sweep()
    try:
        with (
            prepared(ours, force, DT, {}, "first", repeat=50) as fast,
            prepared(other, force[:200], DT, {}, "first", repeat=2, environment=environment) as slow,
        ):
            least = in_turn({"ours": lambda: float(fast()), "python": lambda: float(slow())}, 5)
    except RuntimeError as problem:
        yield what, "100 x at least", f"not here: {str(problem)[:60]}"
        return
    yield what, "100 x at least", f"{least['python'] / least['ours']:.0f} x"


def empty_source(path: Path) -> Path:
    """The C text of an FMU that does nothing, with every name that FMPy looks for."""
    from fmpy import fmi2, fmi3

    given = Path(__file__).with_name("empty_fmu.c").read_text(encoding="utf-8")
    pattern = r"\bfmi[23][A-Z]\w+"
    wanted = re.findall(pattern, inspect.getsource(fmi2) + inspect.getsource(fmi3))
    rest = sorted(set(wanted) - set(re.findall(pattern, given)))
    path.write_text(given + "".join(f"CALL int {name}(void) {{ return 0; }}\n" for name in rest))
    return path


def under_fmpy(folder: Path, ours: dict[int, Path]) -> Iterator[Row]:
    """FMPy's simulate_fmu against the same with an FMU that does nothing."""
    from fmpy import extract, read_model_description, simulate_fmu

    here = MACHINES["here"]
    library = here.library(empty_source(folder / "empty.c"), folder / f"empty{here.suffix}").read_bytes()
    time_, force = np.arange(STEPS) * DT, sweep()
    rate = np.append(np.diff(force) / DT, 0.0)
    with ExitStack() as stack:
        for version, fmu in ours.items():
            empty = folder / f"empty-{version}.fmu"
            with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(empty, "w") as target:
                for name in source.namelist():
                    target.writestr(name, library if name.startswith("binaries/") else source.read(name))
            names = ("F",) if version == 2 else ("F", "F_rate")
            signal = np.rec.fromarrays([time_, force, rate][: 1 + len(names)], names=("time", *names))

            def run(path: Path, signal: np.ndarray = signal) -> Callable[[], float]:
                unpacked = stack.enter_context(tempfile.TemporaryDirectory())
                extract(str(path), unpacked)
                description = read_model_description(unpacked, validate=False)

                def measure() -> float:
                    began = time.process_time()
                    simulate_fmu(
                        unpacked,
                        model_description=description,
                        validate=False,
                        fmi_type="CoSimulation",
                        stop_time=time_[-1],
                        step_size=DT,
                        output_interval=DT,
                        input=signal,
                    )
                    return time.process_time() - began

                return measure

            least = in_turn({"ours": run(fmu), "empty": run(empty)})
            asked, ratio = "1.2 x", least["ours"] / least["empty"]
            yield f"under FMPy, FMI {version}: over an FMU that does nothing", asked, f"{ratio:.2f} x"


def size(folder: Path) -> Iterator[Row]:
    """Size of an FMU for every platform that can be built for here, and how long the second takes."""
    platforms, random = chosen(None), np.random.default_rng()

    def seconds(model: Oscillator, version: int) -> float:
        began = time.perf_counter()
        export_fmu(model, folder / "rig.fmu", version=version)
        return time.perf_counter() - began

    for version in VERSIONS:
        seconds(Oscillator.from_values(TRUTH), version)  # compilers prepare themselves at the first use of a target
        changed = Oscillator.from_values({**TRUTH, "dry": 0.1 + 0.2 * random.random()})
        what = f"FMU, FMI {version}, for {len(platforms)} of {len(PLATFORMS)} platforms"
        times = [f"{seconds(changed, version):.1f} s" for _ in range(2)]
        yield f"{what}: size", "300 kB", f"{(folder / 'rig.fmu').stat().st_size / 1000:.0f} kB"
        yield "   compiled anew, after the first time; the same again", "seconds", ", ".join(times)


def reference_fmus(given: str | None = None) -> Path | None:
    """The checkout of Reference-FMUs, where one was named."""
    named = given or os.environ.get("DASHPOT_REFERENCE_FMUS")
    return Path(named).resolve() if named else None


def main() -> None:
    """Print a line for each figure."""
    print(f"{'what':66} {'asked':>18} {'measured':>26}")
    with tempfile.TemporaryDirectory() as folder:
        for what, asked, measured in rows(Path(folder), reference_fmus(*sys.argv[1:2])):
            print(f"{what:66} {asked:>18} {measured:>26}", flush=True)


if __name__ == "__main__":
    main()
