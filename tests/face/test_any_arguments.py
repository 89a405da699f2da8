"""Whatever a call is handed, there is a result or a sentence: BadInput, KeyError of a name, TypeError of an option."""

from __future__ import annotations

import itertools
from pathlib import Path

import dashpot
import numpy as np
import pytest
from dashpot.errors import LONGEST, BadInput, DashpotError
from dashpot.examples.truth import TRUTH

T = np.arange(600) / 500.0
X = 5e-3 * np.exp(-2.5 * T) * np.cos(79.6 * T)


def _nested(times: int) -> list:
    made: list = []
    for _ in range(times):
        made = [made]
    return made


_LOOP: list = []
_LOOP.append(_LOOP)
_VIEW = np.broadcast_to(np.float64(1.0), (10**12,))
#: Of a kind that no argument has, or that only some have.
THINGS = [
    None, b"x", bytearray(b"xy"), "x", "", "\0", "1.0", 5, -1, 0, np.nan, np.inf, 10**400, True, 1j, [], {}, (),
    [1], ["a"], {1: 2}, {"a": 1}, {b"a": 1}, [None, None], [b"x"], [10**400, 1], {1, 2}, object(), type, lambda: 1,
    range(10**12), _VIEW, [_VIEW], {"x_m": _VIEW}, np.lib.stride_tricks.as_strided(np.zeros(9), (10**5, 10**5), (0,
    0)), _nested(3000), _LOOP, np.array(None), np.array(["a"]), np.array([1j]), np.zeros((2, 2, 2)), np.zeros(0),
    np.float64(3), np.datetime64("NaT"), Path("absent.yaml"), Path("/"), "é" * 5000, {"data": X, "name": None, "fs":
    b"1"}, {"data": None, "name": "x", "fs": 1}, {"x_m": X, "fs": "a"}, {"x_m": [1, [2]]},
]  # fmt: skip


@pytest.fixture(scope="module")
def model() -> dashpot.Model:
    return dashpot.Model.from_values(TRUTH)


@pytest.fixture(scope="module")
def calls(model, tmp_path_factory):
    """Each call with one argument open, the others right."""
    (decay,) = dashpot.read(X, fs=500.0)
    arrays = {"time_s": T, "x_m": X, "force_N": X}
    made = {
        "read": dashpot.read,
        "load": dashpot.load,
        "load_laws": dashpot.load_laws,
        "look": dashpot.look,
        "values": dashpot.Model.from_values,
        "mass": lambda it: dashpot.Model.from_values({**TRUTH, "mass": it}),
        "identify fixed": lambda it: dashpot.identify(fixed=it),
        "identify laws": lambda it: dashpot.identify(laws=it),
        "identify name": lambda it: dashpot.identify(name=it),
        "identify mode": lambda it: dashpot.identify(mode=it),
        "hilbert mode": lambda it: dashpot.hilbert(mode=it),
        "simulate": lambda it: model.simulate(it),
        "backbone": model.backbone,
        "save": model.save,
        "export": model.export,
        "renamed": lambda it: model.renamed(it),
        "getitem": lambda it: model[it],
        "discrete": model.linearise(displacement=0.0).discrete,
        "verify": lambda it: dashpot.verify(it, decay),
        "diagnose": lambda it: dashpot.diagnose(it, decay),
        "holdout": lambda it: dashpot.diagnose(model, holdout=it),
        "check": lambda it: dashpot.check(it),
        "check fixed": lambda it: dashpot.check(decay, fixed=it),
        "check mass": lambda it: dashpot.check(decay, mass=it),
        "plan": lambda it: dashpot.plan(it, "cubic 1%"),
        "plan want": lambda it: dashpot.plan(model, it, noise="1 um", most_amplitude="1 mm", tests="stepped", tries=0),
        "plan noise": lambda it: dashpot.plan(model, "absent 1%", noise=it, most_amplitude="1 mm"),
        "plan like": lambda it: dashpot.plan(model, "absent 1%", like=it, most_amplitude="1 mm"),
        "plan limits": lambda it: dashpot.plan(
            model, "absent 1%", noise=1.0, most_amplitude=it, most_force=it, most_seconds=it, tests=it
        ),
        "plan counts": lambda it: dashpot.plan(model, "absent 1%", noise=1.0, most_amplitude=1.0, tries=it, seed=it),
        "prove_on": lambda it: dashpot.prove_on(it, noise=1e-6),
        "prove_on hide": lambda it: dashpot.prove_on(
            model, noise=1e-6, most_amplitude=1e-3, hide="none" if it is None else it
        ),
        "prove_on counts": lambda it: dashpot.prove_on(
            model, noise=1e-6, most_amplitude=1e-3, hide="none", runs=it, seed=it
        ),
        "compare": lambda it: dashpot.compare(it, model),
        "compare repeats": lambda it: dashpot.compare(model, model, it),
        "watch": dashpot.watch,
        "watch repeats": lambda it: dashpot.watch([model, model], repeats=it),
        "batch": lambda it: dashpot.batch(it, tmp_path_factory.mktemp("out")),
        "Recording": lambda it: dashpot.Recording("r", 1.0, it),
        "Recording fs": lambda it: dashpot.Recording("r", it, X),
        "Recording name": lambda it: dashpot.Recording(it, 1.0, X),
        "Recording unit": lambda it: dashpot.Recording("r", 1.0, X, unit=it),
        "Recording start": lambda it: dashpot.Recording("r", 1.0, X, start=it),
    }
    for name in ("time", "force", "response", "quantity", "unit", "force_unit", "calibration", "fs", "part", "hold"):
        made |= {
            f"read {name}": lambda it, name=name: dashpot.read(arrays, **{name: it}),
            f"read array {name}": lambda it, name=name: dashpot.read(X, **({"fs": 500.0} | {name: it})),
        }
    for name in ("quantity", "unit", "laws", "name"):
        made[f"values {name}"] = lambda it, name=name: dashpot.Model.from_values(TRUTH, **{name: it})
    for name in ("amplitude", "frequency", "displacement", "force"):
        made[f"linearise {name}"] = lambda it, name=name: model.linearise(**{name: it})
    for name in ("force", "fs", "initial", "seconds", "hold"):
        fixed = {"fs": 500.0, "seconds": 0.1} if name in ("seconds", "initial") else {"force": X, "fs": 500.0}
        made[f"simulate {name}"] = lambda it, name=name, fixed=fixed: model.simulate(**(fixed | {name: it}))
    return made


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.long)])
def test_any_argument_gives_a_result_or_a_sentence(calls, tmp_path, monkeypatch, step):
    """BadInput wherever the documentation says so; of a name in brackets, KeyError."""
    monkeypatch.chdir(tmp_path)
    raw, long = [], []
    for (name, call), (place, thing) in itertools.islice(
        itertools.product(calls.items(), enumerate(THINGS)), 0, None, step
    ):
        try:
            call(thing)
        except DashpotError as problem:
            if len(max(str(problem).splitlines(), key=len)) > LONGEST:
                long.append((name, place))
        except Exception as error:
            if not (name == "getitem" and isinstance(error, KeyError)):
                raw.append((name, place, repr(error)[:90]))
    assert raw == []
    assert long == []


@pytest.mark.parametrize(
    ("call", "options", "says"),
    [
        (dashpot.identify, {"fix": {}}, "there is no option 'fix', which is one of the command line; here it is fixed"),
        (dashpot.identify, {"with": "stribeck"}, "here it is laws"),
        (dashpot.identify, {"from_": "a.yaml"}, "here it is start"),
        (dashpot.identify, {"law": "a.py"}, "here it is dashpot.load_laws"),
        (dashpot.identify, {"max_left": "5%"}, "max_left', which is one of the command line; here it is nrmse and"),
        (dashpot.diagnose, {"write_law": "a.py"}, r"here it is write_law\(file\) of what is returned"),
        (dashpot.hilbert, {"figures": "svg"}, r"here it is figures\(folder\) of what is returned"),
        (dashpot.look, {"page": "a.html"}, r"here it is save\('page.html'\) of what is returned"),
        (dashpot.identify, {"verbose": True}, "here it is logging"),
        (dashpot.identify, {"quiet": True}, "here it is progress"),
        (dashpot.identify, {"nmae": "a"}, "did you mean name"),
        (dashpot.verify, {"time_limit": 3.0}, "here it is limit"),
        (dashpot.diagnose, {"hold_out": []}, "did you mean holdout"),
        (dashpot.hilbert, {"untis": "m"}, "did you mean unit"),
    ],
)
def test_an_option_of_the_command_line_is_known_to_the_message(call, options, says):
    with pytest.raises(TypeError, match=says):
        call("absent", **options)


def test_a_model_is_known_by_the_name_it_was_given(model):
    with pytest.raises(BadInput, match="the name of a model must be a text, not 5"):
        model.renamed(5)
    with pytest.raises(KeyError, match="no parameter None; there are mass, omega0"):
        model[None]


def test_a_mass_that_is_given_twice_is_one_mass():
    with pytest.raises(BadInput, match=r"the mass is fixed at .* kg; give it one value"):
        dashpot.identify(X, fs=500.0, fixed={"mass": 0.27}, mass=0.3)
    with pytest.raises(BadInput, match=r"the mass is fixed at 0\.27 kg and given as 0\.3"):
        dashpot.identify(X, fs=500.0, fixed={"mass": "0.27 kg"}, mass=0.3)
    with pytest.raises(BadInput, match="the fixed mass is 'heavy'; give a number"):
        dashpot.identify(X, fs=500.0, fixed={"mass": "heavy"})
    assert dashpot.identify(X, fs=500.0, fixed={"mass": "270 g"}, mass=0.27)["mass"].value == pytest.approx(0.27)


def test_a_force_that_is_nothing_is_refused_in_a_sentence():
    response = np.sin(2 * np.pi * (6 + T) * T)
    with pytest.raises(BadInput, match="check signs and units of force and response"):
        dashpot.identify(dashpot.Recording("r", 500.0, response, 1e-200 * response))


@pytest.mark.parametrize("channel", ["response", "force"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("call", [dashpot.identify, dashpot.hilbert], ids=["identify", "hilbert"])
def test_a_recording_made_by_hand_is_all_numbers(call, channel, value):
    signals = {"response": X, "force": np.cos(60 * T)}
    spoilt = np.where(np.arange(X.size) == 7, value, signals[channel])
    with pytest.raises(BadInput, match=f"the {channel} has 1 value.s. that are not a number, the first at 0.014 s"):
        call(dashpot.Recording("r", 500.0, **(signals | {channel: spoilt})))


@pytest.mark.parametrize("call", [dashpot.identify, dashpot.hilbert], ids=["identify", "hilbert"])
def test_a_recording_made_by_hand_is_of_sizes_that_a_sensor_gives(call):
    with pytest.raises(BadInput, match=r"the response is .* which no sensor gives"):
        call(dashpot.Recording("r", 500.0, 1e200 * X))


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"laws": ["stribeck", "quadratic-drag", "stribeck"]}, "the law 'stribeck' is named twice"),
        ({"name": "n" * 300}, "is longer than 255 characters"),
        ({"name": "a\nb: 1"}, "holds a line break"),
    ],
    ids=["laws", "long", "two lines"],
)
def test_what_could_not_be_written_is_refused_before_the_recordings_are_read(options, says):
    with pytest.raises(BadInput, match=says):
        dashpot.identify("nowhere.csv", **options)
