"""What a model file says against what it must say: units, effects, ranges, covariance.

These checks read the file's raw data and look only at what is well-formed, so that a file with a misspelt key still
learns in the same message of its wrong unit.
"""

from __future__ import annotations

from typing import Any

from ..errors import BadInput
from ..files.yaml_loader import Document, Path, shown, suggestion
from . import units
from .law import Law, LawParameter
from .laws import BASE
from .library import find
from .oscillator import MASS_UNIT, QUANTITIES, Response

_EXAMPLE = "{value: 1.0, std: null, unit: m/s2}"

#: Standard errors are written with four digits, and a covariance with all.
_SAME_STD = 2e-3


class Meaning:
    """The checks that need units, laws and numbers together; each looks only at what is well-formed."""

    def __init__(self, raw: dict[str, Any], document: Document) -> None:
        self.raw = raw
        self.report = document.report
        response = raw.get("response", {"quantity": "displacement", "unit": "m"})
        self.quantity, self.unit = _item(response, "quantity"), _item(response, "unit")
        excitation = raw.get("excitation", {})
        self.force = _item({"unit": "N"} | excitation if isinstance(excitation, dict) else excitation, "unit")
        usable = self.quantity in QUANTITIES and _readable(self.unit) and _readable(self.force)
        #: unit of the displacement, or None where the file does not say it rightly
        self.displacement = Response(self.quantity, self.unit).displacement_unit if usable else None

    def check(self) -> None:
        """Report every inconsistency to the document."""
        for path, unit in ((("response", "unit"), self.unit), (("excitation", "unit"), self.force)):
            if isinstance(unit, str) and unit.isprintable() and 0 < len(unit) <= 40 and not _readable(unit):
                self.report(path, f"cannot read {unit!r}; write it like m, rad, V, m/s2 or counts")
        self._parameter(("mass",), MASS_UNIT)
        for law in BASE:
            for p in law.parameters:
                self._parameter((p.name,), p.unit, p)
        self._terms()
        self._ranges()
        self._covariance()

    def expected(self, template: str) -> str | None:
        """The unit that a parameter must have for this response."""
        return None if self.displacement is None else units.compose(template, self.displacement, self.force, self.unit)

    def example(self, path: Path) -> str:
        """What to write at ``path``, for one that is missing or not a mapping."""
        templates = {"mass": MASS_UNIT} | {p.name: p.unit for law in BASE for p in law.parameters}
        key = path[-1] if path else ""
        if len(path) == 1 and key in templates:
            number = f"{key}: {{value: 0.0, std: null, unit: {self.expected(templates[str(key)]) or '...'}}}"
            return "write null where only free decays were recorded" if key == "mass" else f"write {number}"
        known = {
            "name": "name: my-rig",
            "unit": "unit: m/s2, or what it is in",
            "value": "value: 1.0",
            "quantity": "quantity: displacement",
            "effect": "effect: quadratic-drag",
            "file": "file: sweep.csv",
            "min": "min: 0.0",
            "max": "max: 1.0",
            "response": "response: {quantity: displacement, unit: m}",
            "excitation": "excitation: {unit: N}",
        }
        if len(path) == 3 and path[0] == "terms" and key == "parameters":
            law = _law(_item(_item(self.raw["terms"], path[1]), "effect"))
            entries = [f"{p.name}: {self._entry(p)}" for p in law.parameters] if law else [f"...: {_EXAMPLE}"]
            return f"write parameters: {{{', '.join(entries)}}}"
        if len(path) >= 2 and path[-2] == "parameters":
            return f"write {key}: {_EXAMPLE}"
        if path[:1] == ("terms",) and len(path) == 2:
            return "write effect: and parameters: there"
        return f"write {known[key]}" if key in known else "write it or leave the whole entry out"

    def _entry(self, p: LawParameter) -> str:
        return f"{{value: 1.0, std: null, unit: {self.expected(p.unit) or '...'}}}"

    def _parameter(self, path: Path, template: str, law: LawParameter | None = None) -> None:
        raw = self.raw
        for step in path:
            raw = _item(raw, step)
        self._unit(path, raw, self.expected(template))
        value = _item(raw, "value")
        # omega0 must be above zero, which the form sees to
        if law and _number(value) and len(path) > 1 and not law.lower <= value <= law.upper:
            self.report((*path, "value"), f"must lie between {law.lower:g} and {law.upper:g}, but is {value:g}")

    def _unit(self, path: Path, raw: Any, *expected: str | None) -> None:
        unit = _item(raw, "unit")
        wanted = [asked for asked in dict.fromkeys(expected) if asked is not None]
        if not wanted or not isinstance(unit, str) or not unit.isprintable() or not 0 < len(unit) <= 200:
            return
        if _readable(unit) and any(units.same(unit, asked) for asked in wanted):
            return
        why = f"for {'an' if self.quantity == 'acceleration' else 'a'} {self.quantity} in {self.unit}"
        factor = "; convert the value" if wanted != ["rad/s"] or unit != "Hz" else "; multiply the value by 2 pi"
        self.report((*path, "unit"), f"must be {' or '.join(wanted)} {why}, not {unit[:60]!r}{factor}")

    def _terms(self) -> None:
        terms = self.raw.get("terms")
        seen: set[str] = set()
        for i, term in enumerate(terms if isinstance(terms, list) else []):
            effect, given = _item(term, "effect"), _item(term, "parameters")
            law = _law(effect)
            if law is None:
                if isinstance(effect, str) and effect.isprintable() and 0 < len(effect) <= 255:
                    self.report(("terms", i, "effect"), _why_unknown(effect))
                continue
            if law.name in seen:
                self.report(("terms", i, "effect"), f"{effect} is there already; add its parameters to that one")
            seen.add(law.name)
            if not isinstance(given, dict):
                continue
            known = {p.name: p for p in law.parameters}
            for name in given:
                path = ("terms", i, "parameters", name)
                if name in known:
                    self._parameter(path, known[name].unit, known[name])
                else:
                    self.report(path, f"{effect} has no such parameter; {suggestion(name, known)}")
            for name, p in known.items():
                if name not in given:
                    self.report(("terms", i, "parameters", name), f"is missing; write {name}: {self._entry(p)}")

    def _ranges(self) -> None:
        valid = self.raw.get("valid")
        recorded = self.unit if self.displacement else None
        for name, wanted in (("amplitude", (self.displacement, recorded)), ("frequency", ("Hz",))):
            entry = _item(valid, name)
            self._unit(("valid", name), entry, *wanted)
            low, high = _item(entry, "min"), _item(entry, "max")
            if _number(low) and _number(high) and low > high:
                self.report(("valid", name), f"min {low:g} is above max {high:g}; exchange them")

    def _covariance(self) -> None:
        identified = self.raw.get("identified")
        rows, names = _item(identified, "covariance"), _item(identified, "parameters")
        here: Path = ("identified", "parameters")
        known = parameter_names(self.raw)
        for i, name in enumerate(names if isinstance(names, list) else []):
            if isinstance(name, str) and name not in known:
                self.report((*here, i), f"the model has no parameter {shown(name)}; {suggestion(name, known)}")
            elif isinstance(name, str) and name in names[:i]:
                self.report((*here, i), f"{name} is there already; name each row of the covariance once")
        if not isinstance(rows, list) or not all(isinstance(r, list) and all(map(_number, r)) for r in rows):
            return
        order = names if isinstance(names, list) and names else free_names(self.raw)
        text = covariance_problem(rows, [str(name) for name in order])
        if text:
            self.report(("identified", "covariance"), text)
            return
        for i, name in enumerate(order):
            std, own = self._std(str(name)), rows[i][i] ** 0.5
            if std is not None and order.count(name) == 1 and abs(std - own) > _SAME_STD * max(std, own):
                self.report(
                    ("identified", "covariance", i),
                    f"{name} has the standard error {own:.4g} here and std: {std:.4g} where it stands; "
                    "give both the same, or leave the covariance out",
                )

    def _std(self, name: str) -> float | None:
        """The standard error that stands beside a parameter's value; None where there is none."""
        effect, _, own = name.rpartition(".")
        raw: Any = self.raw
        if effect:
            terms = raw.get("terms")
            found = [t for t in terms if _item(t, "effect") == effect] if isinstance(terms, list) else []
            raw = _item(found[0], "parameters") if found else None
        std = _item(_item(raw, own), "std")
        return float(std) if _number(std) else None


def _item(raw: Any, key: str | int) -> Any:
    if isinstance(raw, dict):
        return raw.get(key)
    return raw[key] if isinstance(raw, list) and isinstance(key, int) and key < len(raw) else None


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= 1.8e308


def _readable(unit: Any) -> bool:
    if not isinstance(unit, str) or not unit.isprintable() or not 0 < len(unit) <= 200:
        return False
    try:
        units.factors(unit)
    except BadInput:
        return False
    return True


def _law(effect: Any) -> Law | None:
    try:
        return find(effect) if isinstance(effect, str) else None
    except BadInput:
        return None


def _why_unknown(effect: str) -> str:
    try:
        return f"{find(effect).name} is known"
    except BadInput as error:
        return str(error)


def parameter_names(raw: dict[str, Any]) -> list[str]:
    """Names of the parameters in the file's data, in the order of ``Oscillator.parameters()``."""
    names = [] if raw.get("mass") is None else ["mass"]
    names += [p.name for law in BASE for p in law.parameters]
    terms = raw.get("terms")
    for term in terms if isinstance(terms, list) else []:
        law = _law(_item(term, "effect"))
        names += [f"{law.name}.{p.name}" for p in law.parameters] if law else []
    return names


def free_names(raw: dict[str, Any]) -> list[str]:
    """Names of the parameters that were identified: those with a standard error, or all where none has one."""
    names = parameter_names(raw)
    entries = {name: _item(raw, name) for name in names}
    terms = raw.get("terms")
    for term in terms if isinstance(terms, list) else []:
        given = _item(term, "parameters")
        for name in given if isinstance(given, dict) else ():
            entries[f"{_item(term, 'effect')}.{name}"] = given[name]
    return [name for name in names if _item(entries[name], "std") is not None] or names


def covariance_problem(rows: list[list[float]], names: list[str]) -> str | None:
    """What keeps ``rows`` from being the covariance of ``names``, as a sentence; None where nothing does."""
    import numpy as np

    size = len(names)
    if len(rows) != size or any(len(row) != size for row in rows):
        shape = f"{len(rows)} rows of {'/'.join(str(n) for n in sorted({len(row) for row in rows})) or 0} numbers"
        return f"must be {size} by {size} for {', '.join(names)}, not {shape}; name its rows in identified.parameters"
    matrix = np.array(rows, dtype=float)
    variance = np.diag(matrix)
    if np.any(variance < 0):
        return f"the variance of {names[int(np.argmin(variance))]} is negative; a variance is a square"
    std = np.sqrt(variance)
    with np.errstate(all="ignore"):
        scaled = matrix / np.where(std > 0, std, 1.0)[:, None] / np.where(std > 0, std, 1.0)[None, :]
    if not np.all(np.isfinite(scaled)) or np.max(np.abs(scaled), initial=0.0) > 1 + 1e-6:
        return "a covariance is larger than the two variances allow (correlation above 1); check the numbers"
    if np.max(np.abs(scaled - scaled.T), initial=0.0) > 1e-6:
        row, column = np.unravel_index(int(np.argmax(np.abs(scaled - scaled.T))), scaled.shape)
        return f"is not symmetric: {names[row]} with {names[column]} differs from the other way round"
    if size and np.linalg.eigvalsh(scaled)[0] < -1e-6 * size:
        return "is not positive semidefinite, so no set of measurements has it; check the numbers"
    return None
