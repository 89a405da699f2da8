"""A model turned into a compiled core and run."""

from ..callable_module import callable_as_its_name

callable_as_its_name(__name__)  # dashpot.simulate(...)
