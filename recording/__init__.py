"""Reading and checking measured signals."""

from __future__ import annotations

from .checks import Problem, check
from .read import read
from .recording import Recording, from_sep5

__all__ = ["Problem", "Recording", "check", "from_sep5", "read"]
