"""dashpot: recordings of a vibrating thing in; a model, an FMU and the physics left out, out."""

__version__ = "0.1.0"
