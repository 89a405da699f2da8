"""All entries of the gallery, in the order of the page."""

from __future__ import annotations

from .decays import DECAYS
from .driven import DRIVEN, IMPOSED
from .entry import Entry

#: By name.
ENTRIES: dict[str, Entry] = {entry.name: entry for entry in (*DECAYS, *DRIVEN, *IMPOSED)}
#: Those that the blind proof of the diagnosis shows beside its rigs.
PROOF = ("stand", "silverbox", "kvlcc2_roll_21338", "emps", "frid_magmech_decay")
