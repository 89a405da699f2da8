"""Built-in stands: recordings with known truth, and the integrator of their own that made them."""

from __future__ import annotations

from pathlib import Path


def recordings(name: str = "paper-stand") -> dict[str, Path]:
    """Give the recordings of a stand, `paper-stand` or `paper-stand-backlash`, by kind, such as "bursts".

    Raises ValueError for another name.
    """
    root = Path(__file__).parent / "recordings"
    files = {path.name.removesuffix(".csv.gz"): path for path in sorted((root / name).glob("*.csv.gz"))}
    if not files:
        names = ", ".join(sorted(path.name for path in root.iterdir()))
        raise ValueError(f"there is no stand named {name!r}; there are {names}")
    return files
