"""What changed: which parameters moved between models, against their errors and what repeats show, and when."""

from .comparison import Comparison, compare
from .life import Life, Point, watch

__all__ = ["Comparison", "Life", "Point", "compare", "watch"]
