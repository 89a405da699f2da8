"""What an oscillator is: force laws, parameters, units, the model file."""

from .oscillator import Oscillator, Provenance, Range, Response, Term
from .parameter import Parameter

__all__ = ["Oscillator", "Parameter", "Provenance", "Range", "Response", "Term"]
