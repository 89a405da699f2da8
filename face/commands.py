"""One function a command.

``given`` recordings are whatever ``read`` takes; ``progress`` is called with one line a step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..errors import BadInput
from ..files.arguments import path_of, several_of, shown, text_of
from ..recording import Reading, Recording, recordings_of
from .added import identified_with_added
from .fleet import batch as batch
from .fleet import compare as compare
from .fleet import watch as watch
from .foresight import check as check
from .foresight import plan as plan
from .foresight import prove_on as prove_on
from .model import Model, oscillator_of
from .options import mode_text, with_reading
from .workflow import Say, analysed, identified, silent

if TYPE_CHECKING:
    from ..model import Oscillator
    from ..model.law import Law
    from ..model.linear import LinearModel
    from ..verify.verification import Verification
    from .doctor import Checkup
    from .element import ForceElement
    from .hilbert import Hilbert
    from .looked import Look
    from .model import Diagnosis
    from .simulation import Simulation


@with_reading
def read(*given: Any, **options: Unpack[Reading]) -> list[Recording]:
    """Recordings of files, arrays, data frames, SEP 5 dictionaries or Recordings, in any mixture, converted to SI.

    Args:
        given: paths (all records of a file are read; ``runs.mat#run3`` is one), a DataFrame, an xarray Dataset or
            DataArray, SEP 5 dictionaries, arrays by name such as {"time_s": t, "force_N": f, "x_mm": x}, an array (n,)
            with ``fs``, Recordings, or lists of these.
        options: how to read them, see ``dashpot.recording.Reading``.

    Raises:
        BadInput: with one sentence for each thing that is wrong.

    Examples:
        >>> import dashpot, numpy
        >>> t = numpy.arange(2000) / 1000.0
        >>> decay = 5e-3 * numpy.exp(-2.5 * t) * numpy.cos(79.6 * t)
        >>> dashpot.read(decay, fs=1000.0)
        [<Recording 'recording 1': displacement in m, 2000 samples at 1000 Hz, no force>]
    """
    return recordings_of(*given, **options)


def load(path: str | Path) -> Model:
    """The model of a model file.

    Raises:
        BadInput: the file cannot be read or is none; one line a problem.

    Examples:
        >>> import dashpot, pathlib, tempfile
        >>> from dashpot.examples.truth import TRUTH
        >>> path = dashpot.Model.from_values(TRUTH, name="stand").save(pathlib.Path(tempfile.mkdtemp()) / "stand.yaml")
        >>> dashpot.load(path).name
        'stand'
    """
    return Model(oscillator_of(path_of(path, "a model file")))


@with_reading
def identify(
    *given: Any,
    name: str | None = None,
    laws: Sequence[str] | str = (),
    fixed: Mapping[str, float | str] | None = None,
    mass: float | str | None = None,
    add_mass: Mapping[str, float | str] | None = None,
    add_stiffness: Mapping[str, float | str] | None = None,
    start: Model | Oscillator | ForceElement | str | Path | None = None,
    mode: str | float | None = None,
    faults: bool = False,
    every: bool = False,
    progress: Say | None = None,
    **options: Unpack[Reading],
) -> Model:
    """Identify a model from recordings: decays, bursts, sweeps, multisines, hammer blows, in any mixture.

    Args:
        given: recordings of one rig, as ``dashpot.read`` takes them.
        name: of the rig; left out, that of the first recording.
        laws: names of laws of the library to fit beside Eq. 17, docs/laws.md.
        fixed: parameters that keep a value, by name: a number in SI or a text with a unit, {"dry": "0.15 m/s2"}; where
            the mass is known also what the machine has, {"friction": "0.15 N", "stiffness": "1.7 kN/m"}.
        mass: kg, or such as "270 g", where only decays were recorded or it is known.
        add_mass: known mass that was added to a recording, by its name or file, {"loaded.csv": "0.5 kg"}: beside
            recordings of the rig as it is, it tells the mass without a force.
        add_stiffness: the same of a stiffness, {"loaded.csv": "200 N/m"}.
        start: model to start from, with its laws; or a damper or spring measured by itself (``load_element``), whose
            further laws then keep their values, divided by the mass (but for those that ``laws`` names).
        mode: which of several modes, by its number or its frequency in Hz.
        faults: whether to ask what the measuring chain did to a recording, where more than noise is left.
        every: whether cubic, preload and dry stay where the recordings do not tell them from none.
        progress: called with one line a step.
        options: how to read, see ``dashpot.recording.Reading``.

    Returns:
        The model; ``notes`` has what is to be known of it, ``identification`` the fit.

    Raises:
        BadInput: the recordings do not belong together or cannot carry a model; a law or parameter is not known.

    Examples:
        >>> import dashpot
        >>> model = dashpot.identify(dashpot.examples.recordings()["bursts"], part="0:15", name="stand")
        >>> print(f"{model['mass'].value:.3f} kg, {model['natural_frequency'].value:.2f} Hz")
        0.270 kg, 12.67 Hz
    """
    if name is not None:
        text_of(name, "the name of the rig")
    if fixed is not None and not isinstance(fixed, Mapping):
        raise BadInput(f'fixed is such as {{"mass": 0.27}}, not {shown(fixed)}')
    from .identified import identified_of

    say = progress or silent
    added = add_mass or add_stiffness
    asked = partial(identified_with_added, masses=add_mass or {}, stiffnesses=add_stiffness or {})
    found = (asked if added else identified)(
        lambda: read(*given, **options),
        name=name,
        laws=[laws] if isinstance(laws, str) else several_of(laws, "laws"),
        fixed=fixed,
        mass=mass,
        start=None if start is None else identified_of(start),
        mode=mode_text(mode),
        faults=faults,
        every=every,
        notes=say,
        progress=say,
    )
    return Model(found.oscillator, found)


@with_reading
def identify_element(
    *given: Any,
    name: str | None = None,
    laws: Sequence[str] | str = (),
    every: bool = False,
    **options: Unpack[Reading],
) -> ForceElement:
    """Identify a force law by itself from motions that were imposed and the forces that they took.

    Args:
        given: recordings of one specimen, as ``dashpot.read`` takes them.
        name: of the specimen; left out, that of the first recording.
        laws: names of laws of the library to fit beside the members of Eq. 17.
        every: whether members stay that the recordings do not tell from none.
        options: how to read, see ``dashpot.recording.Reading``; ``prescribed`` names the column of the motion.

    Raises:
        BadInput: nobody says which column was prescribed, or the recordings cannot carry a force law.

    Examples:
        >>> import dashpot, numpy
        >>> t = numpy.arange(4000) / 1000.0
        >>> x = 5e-3 * numpy.sin(6 * numpy.pi * t) * numpy.minimum(t, 1.0)
        >>> v = numpy.gradient(x, t)
        >>> noise = numpy.random.default_rng(0).normal(size=t.size)
        >>> data = {"time_s": t, "force_N": 800.0 * v + 12.0 * numpy.sign(v) + 0.2 * noise, "x_m": x}
        >>> damper = dashpot.identify_element(data, prescribed="x_m", name="damper")
        >>> print(f"{damper['viscous'].value:.0f} N s/m, {damper['dry'].value:.1f} N")
        800 N s/m, 12.0 N
    """
    from .element import ForceElement, identified_element

    asked = [laws] if isinstance(laws, str) else several_of(laws, "laws")
    fit = identified_element(lambda: read(*given, **options), name=name, laws=asked, every=every)
    return ForceElement(fit.element, fit)


def load_element(path: str | Path) -> ForceElement:
    """The force law of a file that ``identify --prescribed`` wrote.

    Raises:
        BadInput: the file cannot be read or is none; one line a problem.

    Examples:
        >>> import dashpot
        >>> dashpot.load_element("absent.yaml")
        Traceback (most recent call last):
        dashpot.errors.BadInput: absent.yaml: cannot be read (No such file or directory); check the path
    """
    from .element import load_element as load_it

    return load_it(path)


def simulate(model: Model | Oscillator | str | Path, *recording: Any, **options: Any) -> Simulation:
    """The response of a model to a recorded force, or to one of your own; see ``Model.simulate``.

    Examples:
        >>> import dashpot, numpy
        >>> from dashpot.examples.truth import TRUTH
        >>> force = numpy.sin(2 * numpy.pi * 12.67 * numpy.arange(3000) / 1000.0)
        >>> response = dashpot.simulate(dashpot.Model.from_values(TRUTH), force=force, fs=1000.0).response
        >>> f"{abs(response).max():.4f} m"
        '0.0092 m'
    """
    return Model(oscillator_of(model)).simulate(*recording, **options)


def linearise(
    model: Model | Oscillator | str | Path, amplitude: float | str | None = None, **about: float | str | None
) -> LinearModel:
    """A, B, C, D of the linear model about a motion or a point; see ``Model.linearise``.

    Examples:
        >>> import dashpot
        >>> from dashpot.examples.truth import TRUTH
        >>> linear = dashpot.linearise(dashpot.Model.from_values(TRUTH), amplitude=1e-3)
        >>> linear.discrete(1e-3)[0].shape
        (2, 2)
    """
    return Model(oscillator_of(model)).linearise(amplitude, **about)


def export(model: Model | Oscillator | str | Path, *paths: str | Path, **options: Any) -> tuple[Path, ...]:
    """Write a model as .fmu, .casadi, .c, .py, .m, .mo or .ssp, by the suffix; returns all files. See ``Model.export``.

    Examples:
        >>> import dashpot, pathlib, tempfile
        >>> from dashpot.examples.truth import TRUTH
        >>> folder = pathlib.Path(tempfile.mkdtemp())
        >>> len(dashpot.export(dashpot.Model.from_values(TRUTH), folder / "rig.casadi"))
        8
    """
    return Model(oscillator_of(model)).export(*paths, **options)


@with_reading
def verify(
    fmu: str | Path, *given: Any, limit: float | None = None, progress: Say | None = None, **options: Unpack[Reading]
) -> Verification:
    """Run an FMU with recorded forces and compare response, backbone and parameters; ``passed`` says how it went.

    Args:
        fmu: its file.
        given: recordings, as ``dashpot.read`` takes them.
        limit: longest time, s, without a step that the FMU finished.
        progress: called with one line a recording.
        options: how to read, see ``dashpot.recording.Reading``.

    Raises:
        BadInput: the file is no such FMU, it cannot simulate, or no recording fits it.

    Examples:
        >>> import dashpot, pathlib, tempfile
        >>> decay = dashpot.read(dashpot.examples.recordings()["bursts"], part="1.6:3.4", force="none")
        >>> from dashpot.examples.truth import TRUTH
        >>> fmu = pathlib.Path(tempfile.mkdtemp()) / "rig.fmu"
        >>> _ = dashpot.export(dashpot.Model.from_values(TRUTH), fmu)
        >>> dashpot.verify(fmu, decay).recordings[0].file
        'bursts.csv.gz'
    """
    from ..prescribed.verified import verify as check

    return check(path_of(fmu, "an FMU"), read(*given, **options), limit=limit, progress=progress)


@with_reading
def diagnose(
    model: Model | Oscillator | str | Path,
    *given: Any,
    holdout: Any = (),
    mode: str | float | None = None,
    progress: Callable[[str, float], None] | None = None,
    seconds: float | None = None,
    **options: Unpack[Reading],
) -> Diagnosis:
    """Find the physics that a model lacks and recordings show; takes a minute.

    Args:
        model: gives the family; a Model, or the path of a model file.
        given: recordings to fit to, as ``dashpot.read`` takes them.
        holdout: recordings to judge by, of another level or kind.
        mode: which of several modes.
        progress: called with what is done and how much of all is done, 0 to 1.
        seconds: after which it says the best that it has found, and what it has not tried; None: a minute, or what
            the environment variable DASHPOT_SECONDS says. ``math.inf``: no limit.
        options: how to read, see ``dashpot.recording.Reading``.

    Returns:
        Verdict, effects, location and the mended model; ``save(folder)`` writes what ``dashpot diagnose`` does.

    Raises:
        BadInput: the recordings are not of this rig, or cannot carry a diagnosis.

    Examples:
        >>> import dashpot
        >>> from dashpot.examples.truth import TRUTH
        >>> dashpot.diagnose(dashpot.Model.from_values(TRUTH))
        Traceback (most recent call last):
        dashpot.errors.BadInput: no recording was given; name at least one file with a decay or a driven response
    """
    how = {"holdout": holdout, "mode": mode, "progress": progress, "seconds": seconds}
    return Model(oscillator_of(model)).diagnose(*given, **how, **options)


@with_reading
def hilbert(*given: Any, mode: str | float | None = None, **options: Unpack[Reading]) -> Hilbert:
    """FREEVIB and FORCEVIB: curves over time and amplitude, the laws of Eqs. 1, 6 and 7 fitted to them, with errors.

    Args:
        given: recordings of one rig, as ``dashpot.read`` takes them.
        mode: which of several modes.
        options: how to read, see ``dashpot.recording.Reading``.

    Raises:
        BadInput: none of them holds a decay or a driven stretch that can be evaluated.

    Examples:
        >>> import dashpot
        >>> analysis = dashpot.hilbert(dashpot.examples.recordings()["bursts"], part="0:15")
        >>> round(analysis.freevib.values["omega0"], 1)
        79.6
    """
    from .hilbert import Hilbert

    analysis, alone = analysed(read(*given, **options), mode_text(mode))
    return Hilbert(analysis, tuple(alone))


@with_reading
def look(*given: Any, **options: Unpack[Reading]) -> Look:
    """What would be read of files: channels, units, rate, kind of motion, pieces that a fit takes and leaves, and why.

    It prints in words, and shows itself in a notebook: drag over the recording to enlarge it; two cursors give the
    ``part`` to paste, a click on a mode the ``mode``. Nothing in it asks Python. ``save("look.html")`` writes the page.

    Args:
        given: files, or whatever else ``dashpot.read`` takes.
        options: how to read, see ``dashpot.recording.Reading``.

    Returns:
        A list, one dictionary a record; what is refused of a file has its sentence under ``refused``.

    Raises:
        BadInput: a file is not there, or something is no recording.

    Examples:
        >>> import dashpot
        >>> (record,) = dashpot.look(dashpot.examples.recordings()["bursts"])
        >>> record["recordings"][0]["motion"]
        'bursts'
    """
    from .looked import looked_at

    return looked_at(given, options)


def load_laws(path: str | Path) -> tuple[Law, ...]:
    """Take the laws of a Python file into the library, as ``--law`` does; docs/laws.md. The file is run.

    Raises:
        BadInput: the file cannot be run, or a law in it lacks something.

    Examples:
        >>> import dashpot
        >>> dashpot.load_laws("absent.py")
        Traceback (most recent call last):
        dashpot.errors.BadInput: absent.py: cannot be read (No such file or directory); check the path
    """
    from ..model.user_laws import load_law_file

    return load_law_file(path)


def demo(folder: str | Path = "demo", progress: Say | None = None) -> bool:
    """The whole story on the built-in rig, into a folder; whether its FMU reproduces all recordings."""
    from .demo import run

    return run(path_of(folder, "a folder"), progress or print)


def paper(folder: str | Path = "paper", progress: Say | None = None) -> Path:
    """The paper's figures remade from the built-in rig, as a page in a folder; returns its path."""
    from .paper import run

    return run(path_of(folder, "a folder"), progress or silent)


def doctor() -> Checkup:
    """What of all that dashpot can use is there: compiler, platforms, extras, cache.

    Examples:
        >>> import dashpot
        >>> checkup = dashpot.doctor()
        >>> checkup.python.startswith("3.")
        True
    """
    from .doctor import checkup

    return checkup()
