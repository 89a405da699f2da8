"""What an oscillator is: force laws, parameters, units, the model file."""

from .law import Law, LawParameter
from .library import oscillator_with  # the library also tells Python how laws are pickled
from .oscillator import Oscillator, Provenance, Range, Response, Term
from .parameter import Parameter

__all__ = [
    "Law",
    "LawParameter",
    "Oscillator",
    "Parameter",
    "Provenance",
    "Range",
    "Response",
    "Term",
    "oscillator_with",
]
