"""dashpot: recordings of a vibrating thing in; a model, an FMU and the physics left out, out.

>>> import dashpot
>>> model = dashpot.identify(dashpot.examples.recordings()["bursts"], part="0:15")
>>> round(model["omega0"].value, 1)
79.6

``model.simulate``, ``.backbone``, ``.linearise``, ``.plot``, ``.save``, ``.export``, ``.verify`` and ``.diagnose`` go
on from there; every command has a call of its name. docs/python.md has more.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inspect import Signature

    from . import examples as examples
    from .errors import BadInput, DashpotError, ToolchainMissing
    from .face.backbone import Backbone
    from .face.commands import (
        batch,
        check,
        compare,
        demo,
        diagnose,
        doctor,
        export,
        hilbert,
        identify,
        identify_element,
        linearise,
        load,
        load_element,
        load_laws,
        look,
        paper,
        plan,
        prove_on,
        read,
        simulate,
        verify,
        watch,
    )
    from .face.element import ElementDiagnosis, ForceElement
    from .face.hilbert import Hilbert
    from .face.model import Diagnosis, Model
    from .face.simulation import Simulation
    from .model.linear import LinearModel
    from .recording import Recording
    from .verify.verification import Verification

__version__ = "0.1.0"
__all__ = [
    "Backbone",
    "BadInput",
    "DashpotError",
    "Diagnosis",
    "ElementDiagnosis",
    "ForceElement",
    "Hilbert",
    "LinearModel",
    "Model",
    "Recording",
    "Simulation",
    "ToolchainMissing",
    "Verification",
    "__version__",
    "batch",
    "check",
    "compare",
    "demo",
    "diagnose",
    "doctor",
    "examples",
    "export",
    "hilbert",
    "identify",
    "identify_element",
    "linearise",
    "load",
    "load_element",
    "load_laws",
    "look",
    "paper",
    "plan",
    "prove_on",
    "read",
    "simulate",
    "verify",
    "watch",
]
#: Names that are folders of the package too; all but the built-in rigs can be called, see ``_Package``.
_FOLDERS = ("diagnose", "examples", "export", "identify", "simulate", "verify")
#: Where the classes stand; the functions stand in ``face.commands``.
_CLASSES = {
    "Backbone": "face.backbone",
    "BadInput": "errors",
    "DashpotError": "errors",
    "Diagnosis": "face.model",
    "ElementDiagnosis": "face.element",
    "ForceElement": "face.element",
    "Hilbert": "face.hilbert",
    "LinearModel": "model.linear",
    "Model": "face.model",
    "Recording": "recording",
    "Simulation": "face.simulation",
    "ToolchainMissing": "errors",
    "Verification": "verify.verification",
}


class _Command(ModuleType):
    """A folder of the package that hands a call to the function of its name in ``dashpot.face.commands``."""

    def __call__(self, *given: Any, **options: Any) -> Any:
        """Do what ``dashpot`` offers under the folder's name."""
        return self._function()(*given, **options)

    @property
    def __doc__(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """What ``help`` shows: the call and its arguments, before what is in the folder."""
        from .face.call_text import call_text

        return call_text(self._function())

    def __reduce__(self) -> tuple[Any, ...]:
        """By its name, so that other processes can be handed the call."""
        return _named, (self.__name__.rpartition(".")[2],)

    @property
    def __signature__(self) -> Signature:
        """What ``inspect.signature``, and with it completion in a notebook, shows."""
        from inspect import signature

        return signature(self._function())

    def _function(self) -> Any:
        from .face import commands

        return getattr(commands, self.__name__.rpartition(".")[2])


def _named(name: str) -> Any:
    """What the package has under that name."""
    return getattr(sys.modules[__name__], name)


class _Package(ModuleType):
    """The package: its folders that are commands can be called, ``dashpot.identify(...)``.

    Python looks a name up in one place, so that a function of a folder's name would hide the folder or be hidden by it,
    as it happens to be imported. Whenever the import system binds such a folder here, it gets a class that can be
    called (the data model's "Customizing module attribute access"); no folder knows of it.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _FOLDERS and name != "examples" and type(value) is ModuleType:
            value.__class__ = _Command
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> Any:
    """The names above, loaded when they are first asked for: what stands behind them is slow to import."""
    if name in _FOLDERS:
        return import_module(f".{name}", __name__)
    if name in __all__:
        return getattr(import_module(f".{_CLASSES.get(name, 'face.commands')}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
