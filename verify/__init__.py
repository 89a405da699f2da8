"""The artefact run with the recordings: the proof that what was exported reproduces what was measured."""

from ..callable_module import callable_as_its_name

callable_as_its_name(__name__)  # dashpot.verify(...)
