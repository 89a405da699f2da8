"""Whatever an importer does, how often and from where: a status and a message, never damage, growth or a race."""

from __future__ import annotations

import re

import pytest
from dashpot.export.fmu import export_fmu

INTERFACES = ["CoSimulation", "ModelExchange"]
CALLS = 150_000
#: What a run of the fuzzer must have had done as well as refused, or it has tried nothing.
BOTH = {
    2: {
        "CoSimulation": ("SetupExperiment", "GetReal", "SetReal", "DoStep", "SetRealInputDerivatives"),
        "ModelExchange": (
            "SetReal",
            "GetDerivatives",
            "NewDiscreteStates",
            "SetContinuousStates",
            "GetEventIndicators",
        ),
    },
    3: {
        "CoSimulation": ("EnterInitializationMode", "GetFloat64", "SetFloat64", "DoStep"),
        "ModelExchange": ("SetFloat64", "GetContinuousStateDerivatives", "UpdateDiscreteStates", "SetContinuousStates"),
    },
}
STATES = {
    2: ("GetFMUstate", "SetFMUstate", "SerializeFMUstate", "DeSerializeFMUstate"),
    3: ("GetFMUState", "SetFMUState", "SerializeFMUState", "DeserializeFMUState"),
}


def counts(output: str) -> dict[str, tuple[int, ...]]:
    """Function to how often it was carried out, discarded and refused."""
    rows = [line.split() for line in output.splitlines()]
    return {name: tuple(int(number) for number in numbers) for name, *numbers in rows}


#: In the fast lane each version and each interface once, each by one sequence of calls.
FUZZED = [
    pytest.param(version, interface, seed, marks=() if seed == 1 and matched else pytest.mark.long)
    for version in (2, 3)
    for interface in INTERFACES
    for matched in [(version == 2) == (interface == "CoSimulation")]
    for seed in (1, 2)
]


@pytest.mark.parametrize(("version", "interface", "seed"), FUZZED)
def test_no_call_does_damage(program, version, interface, seed):
    done = program("fuzz", version, interface=interface).run(int(interface == "ModelExchange"), seed, CALLS)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stderr == ""
    tallies = counts(done.stdout)
    assert all(sum(numbers) > 0 for numbers in tallies.values())
    for name in (*BOTH[version][interface], *STATES[version]):
        assert tallies[name][0] > 0, f"{name} was never carried out"
        assert tallies[name][2] > 0, f"{name} was never refused"


def test_no_call_does_damage_to_a_model_with_memory(program, with_law, tmp_path):
    fmu = export_fmu(with_law("hysteresis", "actuator-lag", "two-sided-stop"), tmp_path / "memory.fmu")
    done = program("fuzz", fmu=fmu).run(0, 3, CALLS)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.long
@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"vr[i] >= DP_NV": "vr[i] > DP_NV"}, "out of bounds|buffer-overflow"),
        ({"free(c->name);": ""}, "LeakSanitizer"),
        ({"!isfinite(dt) || dt <= 0.0": "dt != dt"}, "a step that cannot be was done"),
        ({"if (!isfinite(value[i]))": "if (0)"}, "is no number"),
        ({"no variable has the value reference": "%"}, "per cent"),
    ],
    ids=["reference", "leak", "step", "value", "message"],
)
def test_the_fuzzer_finds_damage(program, changed, words):
    done = program("fuzz", changed=changed).run(0, 1, CALLS)
    assert done.returncode != 0
    assert re.search(words, done.stderr)


@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.long), 3])
def test_a_hundred_thousand_instances_leave_nothing(program, version):
    done = program("rounds", version, "plain").run(100_000)
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) < 64  # kB: a byte a round would be 90
    done = program("rounds", version).run(2_000)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.long
def test_growth_shows(program):
    done = program("rounds", 2, "plain", changed={"free(c->name);": ""}).run(100_000)
    assert int(done.stdout) > 1000


@pytest.mark.parametrize("sanitizer", [pytest.param("plain", marks=pytest.mark.long), "threads"])
@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.long), 3])
def test_instances_in_threads_give_what_they_give_alone(program, version, sanitizer):
    done = program("threads", version, sanitizer).run(20_000 if sanitizer == "plain" else 2_000)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.long
def test_a_shared_variable_shows(program):
    line = "static void dp_instance_set(dp_instance *m, unsigned reference, double value) {"
    changed = {line: f"static double dp_shared;\n{line}\n    dp_shared += value, value += 1e-9 * dp_shared;"}
    done = program("threads", 2, "threads", changed=changed).run(200)
    assert done.returncode != 0
    assert "data race" in done.stderr
