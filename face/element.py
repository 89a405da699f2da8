"""The work of commands on a prescribed motion, and the Python object of an element."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..errors import BadInput
from ..files.arguments import path_of
from ..model.element import Element
from ..model.fit_state import left_over, state_of_fit
from ..recording import Reading, Recording, recordings_of
from .figures import FIGURES, beside, figures_of, write_figures
from .python_words import in_python, speaks_python
from .workflow import Say, rig_of, seconds_allowed, silent

if TYPE_CHECKING:
    from ..model.parameter import Parameter
    from ..prescribed.element_fit import ElementFit, ElementFound
    from ..verify.verification import Verification


def is_element_file(path: Path) -> bool:
    """Whether a file says that it holds an element; no for one that cannot be read, which its reader will say."""
    from ..model.element_file import is_element
    from ..model.file import text_at

    try:
        return is_element(text_at(path))
    except BadInput:
        return False


def load_element(path: str | Path) -> ForceElement:
    """The element of a file; raises BadInput."""
    from ..model.element_file import load_element as load

    return ForceElement(load(path_of(path, "the file of an element")))


def write_element(fit: ElementFit, model: Path, report: Path | None = None, figures: Sequence[str] = ()) -> list[Path]:
    """Write the file of an element, the page and the pictures where asked for, or none; returns the pictures' paths."""
    from ..files.writing import together, write
    from ..model.element_file import save_element

    drawn: list[Path] = []
    with together():
        if report is not None or figures:
            from ..report.element_page import element_page

            page = element_page(fit, files=(model.name,))
            if report is not None:
                write(report, page.html)
            drawn = write_figures(page, beside(model), figures)
        save_element(fit.element, model)
    return drawn


def fmu_of(element: Element) -> bytes | None:
    """Its FMU; None where no compiler is, for all else is worth having."""
    from ..diagnose.files import FMU
    from ..errors import ToolchainMissing
    from ..export import export_element

    with TemporaryDirectory() as scratch, suppress(ToolchainMissing, BadInput):
        return export_element(element, Path(scratch) / FMU)[0].read_bytes()
    return None


def write_element_diagnosis(
    folder: Path, found: ElementFound, made: bytes | None, figures: Sequence[str] = ()
) -> list[Path]:
    """Write a diagnosis, its page and the mended element into a folder, all or none; returns the paths.

    ``made`` is the FMU of the best element, see ``fmu_of``.
    """
    from ..diagnose.files import DIAGNOSIS, EXPERIMENT, FMU, MODEL, REPORT
    from ..files.writing import remove, together, write
    from ..model.element_file import dumps
    from ..prescribed.tell import as_json
    from ..report.element_page import element_diagnosis_page

    page = element_diagnosis_page(found, files=(DIAGNOSIS, MODEL, *([FMU] if made else [])))
    texts: dict[str, str | bytes | None] = {
        DIAGNOSIS: json.dumps(as_json(found), indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        MODEL: dumps(found.best.element),
        FMU: made,
        EXPERIMENT: None,
        REPORT: page.html,
    }
    with together():
        for name, text in texts.items():
            if text is None:
                remove(folder / name)  # that of an earlier diagnosis would not belong to this one
            else:
                write(folder / name, text)
        written = [folder / name for name, text in texts.items() if text is not None]
        return [*written, *write_figures(page, folder / FIGURES, figures)]


class ForceElement:
    """A force law by itself: what resists a motion that is given.

    ``element["viscous"]`` is a parameter with value, standard error and unit; ``fit`` the identification, where it was
    made by one, and ``notes`` what is to be known of it.
    """

    def __init__(self, element: Element, fit: ElementFit | None = None) -> None:
        self.element = element
        self.fit = fit

    def __repr__(self) -> str:
        return repr(self.element)

    @property
    def name(self) -> str:
        """Of the specimen."""
        return self.element.name

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Every parameter by its name."""
        return self.element.parameters()

    def __contains__(self, name: object) -> bool:
        return name in self.parameters

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __getitem__(self, name: str) -> Parameter:
        known = self.element.parameters()
        if name not in known:
            raise KeyError(f"{name!r} is no parameter of {self.name}; it has {', '.join(known)}")
        return known[name]

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be known of the identification: what it leaves, then what was met on the way."""
        return tuple(map(in_python, [*left_over(self.element), *(() if self.fit is None else self.fit.notes)]))

    @speaks_python
    def force(
        self, displacement: Sequence[float] | np.ndarray, fs: float, **channels: float | np.ndarray
    ) -> np.ndarray:
        """(n,) force along a displacement (n,) sampled at ``fs`` Hz, in the element's units.

        Args:
            displacement: (n,) of its samples.
            fs: sampling frequency, Hz.
            channels: what it depends on, each a number or (n,) in the unit of the file; one that is left out has the
                value at which the parameters are stated.

        Raises:
            BadInput: fewer than four samples, values that are no numbers, or a channel that it does not depend on.

        Warns:
            UserWarning: the motion, its speed or a channel goes beyond what the element was identified in.
        """
        from .element_force import under_a_motion

        force, beyond = under_a_motion(self.element, displacement, fs, channels)
        if beyond:
            warnings.warn(in_python("; ".join(beyond)), stacklevel=3)  # past what translates errors
        return force

    @speaks_python
    def diagnose(
        self,
        *given: Any,
        holdout: Any = (),
        progress: Callable[[str, float], None] | None = None,
        seconds: float | None = None,
        **options: Unpack[Reading],
    ) -> ElementDiagnosis:
        """Find the laws that the members of Eq. 17 lack; takes some seconds.

        Args:
            given: recordings to fit to, as ``dashpot.read`` takes them.
            holdout: recordings to judge by; where none are given, the last third of each.
            progress: called with what is done and how much of all is done, 0 to 1.
            seconds: after which the best that was found is taken; None: a minute, or what DASHPOT_SECONDS says.
            options: how to read, see ``dashpot.recording.Reading``; ``prescribed`` names the column of the motion.

        Raises:
            BadInput: nobody says which column was prescribed, or the recordings do not belong together.
        """
        training = recordings_of(*given, **options)
        held = recordings_of(*(holdout if isinstance(holdout, list | tuple) else [holdout]), **options)
        quietly = progress or (lambda _what, _part: None)
        how = {"name": self.name, "progress": quietly, "seconds": seconds_allowed(seconds)}
        return diagnosed_element(training, held, **how)

    @speaks_python
    def export(self, *paths: str | Path, fmi: int = 2, progress: Say | None = None) -> tuple[Path, ...]:
        """Write it as .fmu, .casadi or .c, by the suffix, all or none; returns all files written.

        ``fmi`` is the version of FMI of an FMU, 2 or 3. Raises BadInput.
        """
        outputs = [path_of(path, "a file to export") for path in paths]
        return exported_element(self.element, outputs, version=fmi, progress=progress)

    @speaks_python
    def verify(
        self,
        *recordings: Any,
        limit: float | None = None,
        progress: Callable[[str], None] | None = None,
        **options: Unpack[Reading],
    ) -> Verification:
        """The element as an FMU, run along each prescribed motion and compared; no file is left.

        See ``dashpot.verify`` for arguments and errors.
        """
        from ..export import export_element
        from ..prescribed.verified import verify

        with TemporaryDirectory() as folder:
            (path,) = export_element(self.element, Path(folder) / f"{self.name}.fmu")
            return verify(path, recordings_of(*recordings, **options), limit=limit, progress=progress)

    def save(self, path: str | Path) -> Path:
        """Write the file of the element; returns its path. Raises BadInput."""
        from ..model.element_file import save_element

        target = Path(path_of(path, "the file of an element"))
        save_element(self.element, target)
        return target

    def figures(self, folder: str | Path, kinds: str | Sequence[str] = "svg") -> list[Path]:
        """Draw the charts of the page as files into a folder, in one or several of pdf, png, svg; returns the paths.

        Raises BadInput where the element was not identified here, or as ``Model.figures``.
        """
        fit = self.fit
        if fit is None:
            raise BadInput("pictures are of an identification, and this element was loaded; identify it here")
        from ..report.element_page import element_page

        return figures_of(lambda: element_page(fit), folder, kinds)


def described(element: Element) -> str:
    """The element as text: equation, parameters with errors, what it is valid for, where it comes from."""
    from ..model.show import columns_text, origin_lines, percent, span_words, value_and_error

    words, cells = element.descriptions(), []
    for name, p in element.parameters().items():
        if p.std is None and not p.value:
            continue
        value, error = value_and_error(p)
        share = percent(p)
        part = "" if share is None else f"({share:.2g} %)" if share < 99.5 else f"({share:.0f} %)"
        cells.append((name, value, f"± {error}" if error else "", part, p.unit, words[name]))
    lines = [f"{element.name}: motion in, force out", "", *(f"  {part}" for part in element.equation().split("; "))]
    lines += ["", "Parameters (those that are not listed are zero)", *columns_text(cells)] if cells else []
    for term in element.terms:
        lines += ["", f"{term.effect} ({term.law.path})", f"  {term.law.sentence}"]
    ranges = [(n, r) for n, r in (("amplitude", element.amplitude), ("speed", element.speed)) if r is not None]
    covered = [f"  {name:<10} {span_words(element, r)}" for name, r in ranges]
    for name, one in element.channels.items():
        stated = f"what depends on it is stated at {one.reference:.4g} {one.unit}"
        covered.append(f"  {name:<10} {one.low:.4g} to {one.high:.4g} {one.unit} ({stated})")
    lines += ["", "Valid for (what the recordings covered)", *covered] if covered else []
    lines += ["", "Identified from", *origin_lines(element)] if element.identified.recordings else []
    noted = left_over(element)
    lines += ["", "Take note", *(f"  - {sentence}." for sentence in noted)] if noted else []
    return "\n".join(lines) + "\n"


def as_json(element: Element) -> dict[str, Any]:
    """The same as plain data."""
    from ..model.show import finite, identified_as_json, percent, valid_as_json

    words = element.descriptions()
    return {
        "format": "dashpot-show/1",
        "name": element.name,
        "equation": element.equation(),
        "parameters": {
            name: {
                "value": p.value,
                "std": finite(p.std),
                "percent": percent(p),
                "unit": p.unit,
                "description": words[name],
            }
            for name, p in element.parameters().items()
        },
        "terms": [{"effect": t.effect, "path": t.law.path, "sentence": t.law.sentence} for t in element.terms],
        "channels": [
            {"channel": d.channel, "unit": d.unit, "of": d.of, "how": d.how, "at": d.reference}
            | {"parameter": d.name or None, "min": d.low, "max": d.high}
            for d in element.dependences
        ],
        "motion": {"unit": element.unit, "origin": element.origin},
        "force": {"unit": element.force_unit},
        "valid": valid_as_json(amplitude=element.amplitude, speed=element.speed),
        "identified": identified_as_json(element.identified),
        "state_of_fit": state_of_fit(element),
    }


def identified_element(
    read: Callable[[], Sequence[Recording]],
    *,
    name: str | None,
    laws: Sequence[str],
    every: bool,
    notes: Say = silent,
    otherwise: str = "",
) -> ElementFit:
    """Identify an element, called ``otherwise`` where nobody says how.

    For arguments and errors see ``prescribed.element_fit.identify_element``.
    """
    from ..model.file import check_name
    from ..prescribed.element_fit import identify_element

    if name is not None:
        check_name(name)
    recordings = read()
    notes("least squares along the motion")
    stem = Path(recordings[0].name.partition("#")[0]).name.partition(".")[0] or "element"
    return identify_element(recordings, name=name or rig_of(recordings) or otherwise or stem, laws=laws, every=every)


@dataclass(frozen=True, eq=False)
class ElementDiagnosis:
    """What was found along prescribed motions: ``verdict``, ``sentence``, ``as_json`` and ``text`` say it.

    ``element`` is the mended element, or the members of Eq. 17 where nothing is missing.
    """

    found: ElementFound

    @property
    def verdict(self) -> str:
        """``consistent``, ``missing-physics`` or ``unexplained``."""
        from ..prescribed.tell import verdict_of

        return verdict_of(self.found)

    @property
    def sentence(self) -> str:
        """The verdict for a person."""
        from ..prescribed.tell import sentence_of

        return sentence_of(self.found)

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the laws that are missing, then what depends on channels: ``viscous(current, linear)``."""
        found = self.found.found
        return (*(named.law.name for named in found.named), *(str(named.way) for named in found.dependent))

    @property
    def element(self) -> ForceElement:
        """With the laws that were found."""
        return ForceElement(self.found.best.element, self.found.best)

    @property
    def as_json(self) -> dict[str, Any]:
        """As ``diagnosis.json`` has it."""
        from ..prescribed.tell import as_json as data

        return data(self.found)

    @property
    def text(self) -> str:
        """As the terminal shows it."""
        from ..prescribed.tell import next_test

        return f"{self.sentence}\n\n{described(self.found.best.element)}\nNext test\n  {next_test(self.found)}\n"

    def save(self, folder: str | Path) -> list[Path]:
        """Write what ``dashpot diagnose`` does into a folder; returns the paths. Raises BadInput."""
        from ..diagnose.files import check_folder

        target = path_of(folder, "a folder")
        check_folder(target)
        return write_element_diagnosis(target, self.found, fmu_of(self.found.best.element))

    def figures(self, folder: str | Path, kinds: str | Sequence[str] = "svg") -> list[Path]:
        """Draw the charts of the page as files, as ``ForceElement.figures``."""
        from ..report.element_page import element_diagnosis_page

        return figures_of(lambda: element_diagnosis_page(self.found), folder, kinds)


def diagnosed_element(
    training: Sequence[Recording],
    held: Sequence[Recording],
    *,
    name: str,
    progress: Callable[[str, float], None],
    seconds: float,
) -> ElementDiagnosis:
    """Ask which laws an element lacks; for arguments and errors see ``prescribed.element_fit.diagnose_element``."""
    from ..prescribed.element_fit import diagnose_element

    return ElementDiagnosis(diagnose_element(training, held, name=name, progress=progress, seconds=seconds))


def exported_element(
    element: Element,
    outputs: Sequence[Path],
    *,
    version: int = 2,
    platforms: Any = None,
    progress: Say | None = None,
) -> tuple[Path, ...]:
    """Write an element in the form of each output's suffix, all or none; returns all files written. Raises BadInput."""
    from ..export import export_element
    from ..files.writing import together

    written: list[Path] = []
    with together():
        for output in outputs:
            written += export_element(element, output, version=version, platforms=platforms, progress=progress)
    return tuple(written)


def verified(fmu: Path, recordings: Sequence[Recording], **how: Any) -> Verification:
    """An FMU, of an oscillator or an element, held against recordings; see ``prescribed.verified.verify``."""
    from ..prescribed.verified import verify

    return verify(fmu, recordings, **how)
