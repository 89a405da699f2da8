"""A model and a diagnosis as a person holds them: what they say, and what can be done with them, a method each.

They stand together because each makes the other: a model is diagnosed, and a diagnosis has a mended model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Unpack

from ..errors import BadInput
from ..files.arguments import known_options, path_of, several_of, shown, text_of
from ..model import Oscillator, Parameter, Response, oscillator_with
from ..model.limits import checked_value
from ..model.oscillator import QUANTITIES
from ..recording import Reading, recordings_of
from ..recording.units import parse_unit
from .figures import figures_of
from .options import mode_text, with_reading
from .python_words import in_python, speaks_python
from .workflow import Say, diagnosed, exported, page_of_diagnosis, seconds_allowed, write_diagnosis

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis as Result
    from ..diagnose.result import Effect, Location
    from ..identify.identification import Identification
    from ..model.linear import LinearModel
    from ..verify.verification import Verification
    from .backbone import Backbone
    from .simulation import Simulation


@dataclass(frozen=True, eq=False, repr=False)
class Model:
    """An identified oscillator.

    ``model["omega0"]`` is a parameter with ``value``, ``std`` and ``unit``.

    Attributes:
        oscillator: parameters, laws, validity and provenance: what the model file holds.
        identification: how it was found, with the fit and its recordings; None where it was loaded or made of numbers.

    Examples:
        >>> import dashpot
        >>> from dashpot.examples.truth import TRUTH
        >>> model = dashpot.Model.from_values(TRUTH, name="stand")
        >>> print(model["mass"], "|", model.machine["friction"])
        0.27 kg | 0.00405 N
    """

    oscillator: Oscillator
    identification: Identification | None = None

    def __post_init__(self) -> None:
        if self.identification is None:
            from ..model.file import check

            check(self.oscillator)

    @classmethod
    def from_values(
        cls,
        values: Mapping[str, float],
        *,
        name: str = "oscillator",
        quantity: str = "displacement",
        unit: str = "m",
        laws: Sequence[str] = (),
    ) -> Model:
        """A model made of numbers, in SI: mass (kg; left out where unknown), omega0, cubic, preload, viscous, dry.

        Args:
            values: by name; those of further laws as ``law.parameter``.
            name: of the rig.
            quantity: what the response shows: displacement, velocity or acceleration.
            unit: of the response, such as m, m/s2 or rad.
            laws: names of further laws, docs/laws.md.

        Raises:
            BadInput: a parameter is missing, not known, or one that no model file may hold: a mass of zero, a NaN.

        Examples:
            >>> import dashpot
            >>> rig = {"mass": 1.0, "omega0": 50.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.0, "dry": 0.0}
            >>> dashpot.Model.from_values(rig | {"quadratic-drag.coefficient": 2.0}, laws=["quadratic-drag"]).laws
            ('quadratic-drag',)
        """
        if text_of(quantity, "quantity") not in QUANTITIES:
            raise BadInput(f"quantity {quantity[:40]!r} is not known; use one of {', '.join(QUANTITIES)}")
        if not isinstance(unit, str) or not isinstance(name, str) or not isinstance(values, Mapping):
            raise BadInput("name and unit must be texts, and values numbers by name; see docs/python.md")
        response = Response(quantity, _in_si(quantity, unit))
        oscillator = oscillator_with(
            values, [laws] if isinstance(laws, str) else several_of(laws, "laws"), name=name, response=response
        )
        for key, (lower, upper) in oscillator.bounds().items():
            of_law = "." in key  # the file leaves those of Eq. 17 free
            checked_value(key, values[key], *((lower, upper) if of_law else ()))
        return cls(oscillator)

    @property
    def name(self) -> str:
        """Of the rig."""
        return self.oscillator.name

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Every parameter, per unit mass as in Eq. 17, by its name."""
        return self.oscillator.parameters()

    @property
    def machine(self) -> dict[str, Parameter]:
        """The same in kg, N/m, N s/m and N, with natural frequency (Hz) and damping ratio; errors carried over."""
        from ..model.physical import machine

        return machine(self.oscillator)

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws beside Eq. 17."""
        return tuple(term.effect for term in self.oscillator.terms)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know, one sentence each: of the identification where there was one, and of the model."""
        from ..model.show import warnings

        found = () if self.identification is None else (*self.identification.notes, *self.identification.faults)
        return tuple(dict.fromkeys(map(in_python, (*found, *warnings(self.oscillator)))))

    def __contains__(self, name: object) -> bool:
        return name in self.parameters or name in self.machine

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __getitem__(self, name: str) -> Parameter:
        known = self.parameters
        if not isinstance(name, str):
            raise KeyError(f"no parameter {shown(name)}; there are {', '.join([*known, *self.machine])}")
        if name in known:
            return known[name]
        if name in (machine := self.machine):
            return machine[name]
        import difflib

        close = difflib.get_close_matches(name, [*known, *machine], n=3, cutoff=0.4)
        advice = f"did you mean {', '.join(close)}?" if close else f"there are {', '.join([*known, *machine])}"
        raise KeyError(f"no parameter {name!r}; {advice}")

    def __repr__(self) -> str:
        from .words import model_text

        return model_text(self.oscillator, self.notes)

    def _repr_html_(self) -> str:
        from .words import model_html

        return model_html(self.oscillator, self.notes, lambda: self.plot()._repr_svg_())

    def describe(self) -> str:
        """All there is to say of the model, as ``dashpot show`` prints it."""
        from ..model.show import describe

        return describe(self.oscillator)

    def as_json(self) -> dict[str, Any]:
        """The same as plain data, as ``dashpot show --json``."""
        from ..model.show import as_json

        return as_json(self.oscillator)

    @with_reading
    def simulate(
        self,
        *recording: Any,
        initial: tuple[float, float] = (0.0, 0.0),
        seconds: float | None = None,
        **options: Unpack[Reading],
    ) -> Simulation:
        """The response to a recorded force, from the beginning that comes closest; or to a force of one's own.

        Args:
            recording: a recording as ``dashpot.read`` takes it; left out, ``force`` is an array (n,) or a Series in the
                model's unit of force, ``fs`` its sampling frequency or ``time`` its instants (n,) in even steps; or
                there is no force at all for ``seconds``.
            initial: displacement and velocity at the first sample, where there is no recording.
            seconds: length of free motion.
            options: how a recording is read, see ``dashpot.recording.Reading``.

        Raises:
            BadInput: there is more or less than one recording, or it is not of this rig.

        Examples:
            >>> import dashpot
            >>> from dashpot.examples.truth import TRUTH
            >>> free = dashpot.Model.from_values(TRUTH).simulate(initial=(5e-3, 0.0), seconds=1.0, fs=1000.0)
            >>> free.response.shape, bool(abs(free.response[-100:]).max() < 1e-3)
            ((1000,), True)
        """
        from .simulation import simulated

        return simulated(self.oscillator, recording, initial, seconds, options)

    @speaks_python
    def backbone(self, amplitude: Any = None) -> Backbone:
        """Natural frequency and damping ratio over the amplitude.

        Args:
            amplitude: of the displacement (n,), in its unit; left out, over what the recordings covered.

        Examples:
            >>> import dashpot
            >>> from dashpot.examples.truth import TRUTH
            >>> curve = dashpot.Model.from_values(TRUTH).backbone([1e-3, 5e-3])
            >>> [round(float(f), 2) for f in curve.frequency]
            [12.76, 12.7]
        """
        from .backbone import backbone_of

        return backbone_of(self.oscillator, self.identification, amplitude)

    @speaks_python
    def linearise(self, amplitude: float | str | None = None, **about: float | str | None) -> LinearModel:
        """A, B, C, D about a motion (``amplitude``, ``frequency``) or a point (``displacement``, ``force``).

        ``poles``, ``discrete(step)``, ``to_scipy()`` and ``to_control()`` go on from there.

        Examples:
            >>> import dashpot
            >>> from dashpot.examples.truth import TRUTH
            >>> dashpot.Model.from_values(TRUTH).linearise(amplitude=1e-3).A.shape
            (2, 2)
        """
        from ..model.linear import linearise

        known_options(about, ("amplitude", "frequency", "displacement", "force"))
        return linearise(self.oscillator, amplitude=amplitude, **about)

    def plot(self) -> Any:
        """Backbone and damping ratio, with what was measured where the model was identified; a matplotlib Figure."""
        return self.backbone().plot()

    @speaks_python
    def save(self, path: str | Path) -> Path:
        """Write the model file (YAML), or an HTML report where the name ends in .html; returns the path.

        Raises:
            BadInput: the place cannot be written, or a report is asked for of a model that was not identified here.
        """
        from ..export import SUFFIXES
        from ..files.writing import write
        from ..model.file import save

        path = path_of(path, "a file for the model")
        if path.suffix != ".html":
            if path.suffix in SUFFIXES:
                raise BadInput(f"{path}: save writes a model file or a report; use export for this")
            save(self.oscillator, path)
        elif self.identification is None:
            raise BadInput(f"{path}: a report is of an identification, and this model has none; identify it here")
        else:
            from ..report.page import identification_page

            write(path, identification_page(self.identification).html)
        return path

    @speaks_python
    def figures(self, folder: str | Path, kinds: str | Sequence[str] = "svg") -> list[Path]:
        """Draw the charts of the report as files into a folder, in one or several of pdf, png, svg; returns the paths.

        Raises:
            BadInput: a kind is not known, the folder cannot be written, or the model was not identified here.
        """
        found = self.identification
        if found is None:
            raise BadInput("pictures are of an identification, and this model has none; identify it here")
        from ..report.page import identification_page

        return figures_of(lambda: identification_page(found), folder, kinds)

    @speaks_python
    def export(self, *paths: str | Path, **options: Any) -> tuple[Path, ...]:
        """Write .fmu, .casadi, .c, .py, .m, .mo or .ssp files; ``options`` are those of ``dashpot.export.export``.

        Examples:
            >>> import dashpot, pathlib, tempfile
            >>> from dashpot.examples.truth import TRUTH
            >>> model = dashpot.Model.from_values(TRUTH)
            >>> written = model.export(pathlib.Path(tempfile.mkdtemp()) / "rig.c")
            >>> [path.name for path in written]
            ['rig.c', 'rig.h']
        """
        return exported(self.oscillator, [path_of(path, "a file to export to") for path in paths], **options)

    @with_reading
    def verify(
        self, *recordings: Any, limit: float | None = None, progress: Say | None = None, **options: Unpack[Reading]
    ) -> Verification:
        """The model as an FMU, run with each recording and compared; no file is left. See ``dashpot.verify``."""
        from ..verify.verification import verify

        with TemporaryDirectory() as folder:
            (path,) = self.export(Path(folder) / "model.fmu")
            return verify(path, recordings_of(*recordings, **options), limit=limit, progress=progress)

    @with_reading
    def diagnose(
        self,
        *recordings: Any,
        holdout: Any = (),
        mode: str | float | None = None,
        progress: Callable[[str, float], None] | None = None,
        seconds: float | None = None,
        **options: Unpack[Reading],
    ) -> Diagnosis:
        """What physics the model lacks that recordings show; see ``dashpot.diagnose``."""
        training, held = recordings_of(*recordings, **options), recordings_of(holdout, **options)
        said = progress or (lambda _what, _part: None)
        how = {"mode": mode_text(mode), "progress": said, "seconds": seconds_allowed(seconds)}
        return Diagnosis(*diagnosed(self.oscillator, training, held, **how))

    def renamed(self, name: str) -> Model:
        """The same model under another name."""
        return replace(self, oscillator=replace(self.oscillator, name=text_of(name, "the name of a model")))


def _in_si(quantity: str, unit: str) -> str:
    """A unit of such a response; raises BadInput for one with a prefix, of something else, or that is none."""
    known = parse_unit(unit, "unit")
    if known.quantity not in (quantity, "any"):
        raise BadInput(f"unit {unit!r} measures {known.quantity}, and the response is a {quantity}; give one of that")
    if known.si != unit:
        raise BadInput(f"unit {unit!r}: the numbers are in SI; give them and the unit in {known.si}")
    return unit


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """What is missing from a model, where, and the model with it.

    Attributes:
        result: all of it: considered laws, recordings before and after, the latent force, the next experiment.
        fmu: the mended model as an FMU; None where nothing was mended or nothing could be compiled.
    """

    result: Result
    fmu: bytes | None = None

    @property
    def verdict(self) -> str:
        """``consistent``, ``missing-physics`` or ``unexplained``."""
        return self.result.verdict

    @property
    def sentence(self) -> str:
        """The verdict for a person."""
        return self.result.sentence

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What is missing, the most important first."""
        return self.result.effects

    @property
    def location(self) -> Location | None:
        """Where the given model fails; None where it does not."""
        return self.result.location

    @property
    def model(self) -> Model:
        """The mended model; the family's best where nothing was mended."""
        return Model(self.result.model)

    def __repr__(self) -> str:
        from ..report.diagnosis_text import describe

        return describe(self.result).rstrip("\n")

    def _repr_html_(self) -> str:
        from .words import preformatted

        return preformatted(repr(self))

    def as_json(self) -> dict[str, Any]:
        """The diagnosis file, ``dashpot-diagnosis/1``."""
        return self.result.as_json()

    def save(self, folder: str | Path) -> list[Path]:
        """Write what ``dashpot diagnose`` writes into a folder: diagnosis, mended model, FMU, next experiment, report.

        Raises:
            BadInput: the folder cannot be written, or holds such files that no diagnosis made.
        """
        from ..diagnose.files import check_folder

        folder = path_of(folder, "a folder for the diagnosis")
        check_folder(folder)
        return write_diagnosis(folder, self.result, self.fmu)

    @speaks_python
    def figures(self, folder: str | Path, kinds: str | Sequence[str] = "svg") -> list[Path]:
        """Draw the charts of the page as files into a folder, in one or several of pdf, png, svg; returns the paths.

        Raises:
            BadInput: a kind is not known, or the folder cannot be written.
        """
        return figures_of(lambda: page_of_diagnosis(self.result, self.fmu), folder, kinds)

    @speaks_python
    def write_law(self, file: str | Path) -> str:
        """Write the closed form of what was learnt as a law file; returns what was done, in a sentence.

        Raises:
            BadInput: the file's name is none for a law, is taken, or the file is another's.
        """
        from .learnt_law import write_law

        return write_law(path_of(file, "a law file to write"), self.result)


def oscillator_of(model: Model | Oscillator | str | Path) -> Oscillator:
    """The oscillator that is meant: a Model's, one itself, or that of a model file; raises BadInput for others."""
    from ..model.file import check, load

    if isinstance(model, Model):
        return model.oscillator
    if isinstance(model, Oscillator):
        check(model)
        return model
    if isinstance(model, str | Path):
        return load(path_of(model, "a model file"))
    raise BadInput(f"{shown(model)} is no model; give a Model, or the path of a model file")
