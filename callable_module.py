"""Modules that can be called: ``dashpot.identify`` is a folder, and ``dashpot.identify(...)`` what a user writes.

Python looks a name up in one place, so that a function of a folder's name would hide the folder or be hidden by it, as
it happens to be imported. The module itself is made to answer the call, which Python allows for a module's class
(the data model's "Customizing module attribute access"); whatever is in the folder is imported as ever.
"""

from __future__ import annotations

import inspect
import sys
from types import ModuleType
from typing import Any


class CallableModule(ModuleType):
    """A module that hands a call to the function of its name in ``dashpot.face.commands``."""

    def __call__(self, *given: Any, **options: Any) -> Any:
        """Do what ``dashpot`` offers under the module's name; see ``help(dashpot.face.commands)``."""
        return self._function()(*given, **options)

    @property
    def __signature__(self) -> inspect.Signature:
        """What ``inspect.signature``, and with it completion in a notebook, shows."""
        return inspect.signature(self._function())

    def _function(self) -> Any:
        from .face import commands

        return getattr(commands, self.__name__.rpartition(".")[2])


def callable_as_its_name(module: str) -> None:
    """Make a module callable; ``module`` is its ``__name__``."""
    sys.modules[module].__class__ = CallableModule
