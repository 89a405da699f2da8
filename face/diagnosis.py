"""A diagnosis as a person holds it: what it says, the mended model, and the folder it can be written to."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .model import Model

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis as Result
    from ..diagnose.result import Effect, Location


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
        from ..diagnose.files import DIAGNOSIS, EXPERIMENT, FMU, MODEL, check_folder, write_folder
        from ..report.diagnosis_page import diagnosis_page

        folder = Path(folder)
        check_folder(folder)
        names = tuple(name for name in (DIAGNOSIS, MODEL, FMU, EXPERIMENT) if self.fmu or name != FMU)
        return write_folder(folder, self.result, diagnosis_page(self.result, files=names), self.fmu)
