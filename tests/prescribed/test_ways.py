"""Strengths that depend on channels: found, with their form and numbers, and not found where nothing does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.prescribed.channels import Span, Way, parsed, spans_of
from dashpot.prescribed.element_fit import diagnose_element, identify_element
from dashpot.prescribed.tell import as_json, next_test, sentence_of
from dashpot.recording import Recording
from dashpot.recording.channel import Channel
from dashpot.simulate.imposed import force_along

FS, SECONDS = 120.0, 10.0
MEMBERS = {"stiffness": 9e3, "viscous": 700.0, "dry": 35.0, "load": 120.0}
HOW = {"noise": 3e-3, "motion_noise": 2e-5}
KINDS = ("sweep", "sines", "random")
N = int(FS * SECONDS)


def with_channel(
    values: list[float | np.ndarray], name: str, unit: str, own: dict[str, object], law: str = "", **numbers: float
) -> list[Recording]:
    """Recordings in which members or a law's numbers are functions of the channel, given as ``own``."""
    made = []
    for i, value in enumerate(values):
        x = motion(KINDS[i % 3], 6e-3 * (1.0 - 0.2 * i), 2.0, FS, SECONDS, i)
        at = {key: f(np.asarray(value, float)) if callable(f) else f for key, f in own.items()}
        members = MEMBERS | {key: v for key, v in at.items() if key in MEMBERS}
        further = numbers | {key: v for key, v in at.items() if key not in MEMBERS}
        one = recorded(Specimen(members, law, further), x, FS, **HOW, seed=i)
        held = float(value) if np.ndim(value) == 0 else np.asarray(value)
        made.append(replace(one, name=f"test {i}", channels=(Channel(name, unit, held),)))
    return made


@pytest.fixture(scope="module")
def warm() -> list[Recording]:
    """Oil that warms up while the machine runs, by a column."""
    t = np.arange(N) / FS
    warms = [25.0 + 30.0 * (1.0 - np.exp(-t / 4.0)), 20.0 + 4.0 * t, 50.0 - 2.0 * t]
    return with_channel(list(warms), "temperature", "degC", {"viscous": lambda c: 700.0 / (1.0 + 0.03 * (c - 20.0))})


@pytest.fixture(scope="module")
def two() -> list[Recording]:
    return with_channel([0.0, 0.5], "current", "A", {"viscous": lambda c: 700.0 + 600.0 * c})


def test_damping_that_falls_as_oil_warms_is_named_with_its_form(warm: list[Recording]) -> None:
    found = diagnose_element(warm[:2], warm[2:])
    assert found.found.named == ()
    (named,) = found.found.dependent
    assert named.way == Way("temperature", "viscous", "inverse")
    assert named.rivals == ()
    assert all(record.over_noise < 1.2 for record in found.best.records)
    element = found.best.element
    (one,) = element.dependences
    reference = 700.0 / (1.0 + 0.03 * (one.reference - 20.0))
    known = element.parameters()
    for name, truth in (("viscous", reference), (one.name, 0.03 * reference / 700.0)):
        assert known[name].std < 0.02 * abs(truth)
        assert abs(known[name].value - truth) < 4.0 * known[name].std
    said = sentence_of(found)
    assert said.startswith("Missing: viscous damping falls with the temperature, as one over a straight line, from ")
    assert "what is left is noise" in said
    (effect,) = as_json(found)["effects"]
    assert (effect["path"], effect["of"], effect["law"]) == ("channel", "viscous", "inverse")
    assert effect["strength"]["at_min"] > effect["strength"]["at_max"]


def test_two_values_of_a_channel_do_not_tell_its_form_and_that_is_said(two: list[Recording]) -> None:
    found = diagnose_element(two)
    (named,) = found.found.dependent
    assert named.way == Way("current", "viscous", "linear")
    assert named.rivals == ("viscous(current, inverse)",)
    assert "(or as one over a straight line: the recordings do not tell which)" in sentence_of(found)
    assert next_test(found).startswith("Record at a further current, such as 0.25 A: 2 values of it do not tell")


def test_a_law_whose_strength_grows_with_the_current_is_found_with_it() -> None:
    numbers = {"limit": 3e-4, "exponent": 1.0, "loading": 0.5}
    own = {"stiffness": lambda c: 2e5 * c / 0.5, "viscous": 300.0}
    made = with_channel([0.05, 0.6, 1.2], "current", "A", {"viscous": 300.0}, "hysteresis", stiffness=0.0, **numbers)
    for i, one in enumerate(made):
        value = one.channels[0].values
        x = motion(KINDS[i], 6e-3 * (1.0 - 0.2 * i), 2.0, FS, SECONDS, i)
        specimen = Specimen(MEMBERS | {"viscous": own["viscous"]}, "hysteresis", numbers | {"stiffness": 4e5 * value})
        made[i] = replace(recorded(specimen, x, FS, **HOW, seed=i), channels=one.channels)
    found = diagnose_element(made[:2], made[2:])
    assert [named.law.name for named in found.found.named] == ["hysteresis"]
    (named,) = found.found.dependent
    assert (named.way.of, named.way.channel) == ("hysteresis.stiffness", "current")
    known = found.best.element.at({"current": 1.2}).parameters()
    assert known["hysteresis.stiffness"].value == pytest.approx(4.8e5, rel=0.05)


@pytest.mark.parametrize("column", [False, True])
def test_a_channel_on_which_nothing_depends_is_not_named(column: bool) -> None:
    t = np.arange(N) / FS
    values = [20.0 + 3.0 * t, 60.0 - t, 40.0 + 10.0 * np.sin(t)] if column else [20.0, 60.0, 45.0]
    found = diagnose_element(with_channel(list(values), "temperature", "degC", {}))
    assert found.found.dependent == ()
    assert found.after is None
    assert found.before.element.dependences == ()


def test_what_depends_is_fitted_where_it_is_asked_for(two: list[Recording]) -> None:
    fit = identify_element(two, laws=["viscous:current", "dry:current:inverse"])
    assert [(d.of, d.how) for d in fit.element.dependences] == [("viscous", "linear"), ("dry", "inverse")]
    known, (one, _) = fit.element.parameters(), fit.element.dependences
    assert known["viscous"].value == pytest.approx(700.0 + 600.0 * one.reference, rel=0.01)
    assert abs(known["viscous.current_slope"].value - 600.0) < 4.0 * known["viscous.current_slope"].std
    assert abs(known["dry.current_rate"].value) < 4.0 * known["dry.current_rate"].std
    assert {"viscous.current_slope", "dry.current_rate"} <= set(fit.element.identified.parameters)
    assert fit.left is None


def test_the_force_along_a_channel_is_that_of_each_of_its_values(warm: list[Recording]) -> None:
    element = identify_element(warm, laws=["viscous:temperature:inverse", "stiffness:temperature"]).element
    x = motion("sines", 6e-3, 2.0, FS, 3.0)
    channel = np.linspace(20.0, 60.0, x.size)
    made = force_along(element, x, 1.0 / FS, channels={"temperature": channel})
    for i in (50, 150, 300):
        expected = force_along(element.at({"temperature": channel[i]}), x, 1.0 / FS)[i]
        assert made[i] == pytest.approx(expected, rel=1e-9)
    same = force_along(element, x, 1.0 / FS)
    assert same == pytest.approx(force_along(element.at({}), x, 1.0 / FS), rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("viscous:pressure", "have no channel 'pressure'; there are current"),
        ("drag:current", "nothing is called 'drag' that may depend on current"),
        ("viscous:current:cubic", "no form of a dependence; there are linear, origin, power, inverse"),
        ("viscous:current:power", "its zero lies within 0 to 0.5 A"),
        ("load:current:origin", "each recording has a load of its own"),
    ],
)
def test_what_cannot_depend_is_said(text: str, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        parsed(text, {"current": Span("current", "A", 0.0, 0.5)}, ["viscous", "dry", "load"])


def test_channels_that_do_not_belong_together_are_refused(two: list[Recording]) -> None:
    one, other = two
    with pytest.raises(BadInput, match="test 1: has no channel current, which others have"):
        spans_of([one, replace(other, channels=())])
    with pytest.raises(BadInput, match="is in V, and in A elsewhere"):
        spans_of([one, replace(other, channels=(Channel("current", "V", 1.0),))])
    with pytest.raises(BadInput, match="the channel current never changes, it is 0 A throughout"):
        identify_element([one, replace(other, channels=one.channels)])
