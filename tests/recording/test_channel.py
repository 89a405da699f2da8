"""Channels: numbers and columns beside a recording, said on the command line and in Python."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, recordings_of
from dashpot.recording.channel import Channel, stated_channels

N, FS = 400, 100.0
HOW = {"prescribed": "stroke_mm", "force": "force_N"}


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    made = []
    for i, name in enumerate(("one.csv", "two.csv")):
        t = np.arange(N) / FS
        x, force = 4.0 * np.sin(2 * np.pi * t), 30.0 * np.cos(2 * np.pi * t + 0.1 * i)
        columns = [t, force, x, 20.0 + t, 1.5 + 0.1 * t, np.where(t > 2.0, np.nan, t)]
        header = "time_s,force_N,stroke_mm,oil_degC,load_kN,gappy_A"
        np.savetxt(tmp_path / name, np.column_stack(columns), "%.9g", ",", header=header, comments="")
        made.append(str(tmp_path / name))
    return made


def values_of(recording: Recording, name: str) -> float | np.ndarray:
    return next(channel.values for channel in recording.channels if channel.name == name)


@pytest.mark.parametrize(
    ("given", "numbers"),
    [
        (("current=0.5A",), [0.5, 0.5]),
        (("current=0A,500 mA",), [0.0, 0.5]),
        (("current_mA=200,300",), [0.2, 0.3]),
        (("current=one.csv:1A", "current=two.csv:2A"), [1.0, 2.0]),
        (("current=*one*:1A,*two*:2A",), [1.0, 2.0]),
        ({"current": "0.5 A"}, [0.5, 0.5]),
        ({"current_A": [0.1, 0.2]}, [0.1, 0.2]),
        ({"current": {"one.csv": "1 A", "two.csv": "2 A"}}, [1.0, 2.0]),
    ],
)
def test_numbers_are_those_of_their_files_in_si(given: object, numbers: list[float], files: list[str]) -> None:
    made = recordings_of(files, channels=given, **HOW)
    assert [values_of(one, "current") for one in made] == pytest.approx(numbers)
    assert {channel.unit for one in made for channel in one.channels} == {"A"}


@pytest.mark.parametrize(
    ("text", "number", "unit"),
    [
        ("temperature=300K", 26.85, "degC"),
        ("temperature=50degF", 10.0, "degC"),
        ("pressure=7bar", 7e5, "Pa"),
        ("speed=60rpm", 2.0 * np.pi, "rad/s"),
        ("gap=2mm", 2e-3, "m"),
        ("share=25%", 0.25, "1"),
        ("turns=3", 3.0, "1"),
    ],
)
def test_units_of_channels_are_brought_to_si(text: str, number: float, unit: str, files: list[str]) -> None:
    (made,) = recordings_of(files[0], channels=(text,), **HOW)
    (channel,) = made.channels
    assert (channel.values, channel.unit) == (pytest.approx(number), unit)


def test_a_column_is_a_channel_and_no_response_or_force(files: list[str]) -> None:
    made = recordings_of(files, channels=("oil_degC", "load_kN", "T2=oil_degC"), prescribed="stroke_mm")
    assert [channel.name for channel in made[0].channels] == ["oil", "load", "T2"]
    assert values_of(made[0], "oil") == pytest.approx(20.0 + np.arange(N) / FS)
    assert values_of(made[1], "load") == pytest.approx(1500.0 + np.arange(N))
    assert recordings_of(files[0], channels=("5",), **HOW)[0].channels[0].name == "load"  # by its number
    cut = made[0].slice(100, 200)
    assert values_of(cut, "oil") == pytest.approx(21.0 + np.arange(100) / FS)
    assert recordings_of(files[0], channels=("oil_degC",), part="1:2", **HOW)[0].channels[0].over(0).size == 100


def test_arrays_and_recordings_take_channels_too() -> None:
    t = np.arange(N) / FS
    data = {"time_s": t, "force_N": np.cos(t), "x_m": np.sin(t)}
    (made,) = recordings_of(data, prescribed="x_m", channels={"temperature_degC": 20.0 + t})
    assert values_of(made, "temperature") == pytest.approx(20.0 + t)
    again = recordings_of(made, channels={"current": "2 A"})[0]
    assert {channel.name for channel in again.channels} == {"temperature", "current"}
    with pytest.raises(BadInput, match="has 5 samples"):
        Recording("short", FS, np.sin(t), channels=(Channel("current", "A", np.zeros(5)),))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("oil_degF",), "has no column 'oil_degF' .--channel.; did you mean 'oil_degC'"),
        (("current=0A,1A,2A",), "has 3 values, and 2 recordings were given"),
        (("current=3 furlongs",), "the unit 'furlongs' of the channel current is not known"),
        (("temperature=3A",), "a temperature is measured in degC"),
        (("gappy_A",), "has 199 sample.s. that are no number"),
        (("current=one.csv:1A",), "nobody says the channel current of it"),
        (("current=1A", "current=2A"), "is said twice"),
        (("=2A",), "does not say which channel"),
        (("current=",), "neither numbers nor a column"),
        (("current=force_N",), "a current is measured in A"),
        (("current=2",), "nobody says the unit of the channel current"),
        ({"current_A": float("nan")}, "is nan"),
        ({"a b": 1.0}, "no name of a channel"),
    ],
)
def test_what_is_no_channel_is_said(given: object, words: str, files: list[str]) -> None:
    with pytest.raises(BadInput, match=words):
        recordings_of(files, channels=given, **HOW)


def test_a_channel_is_understood_before_a_file_is_opened() -> None:
    (one,) = stated_channels(["current=0A,1A"])
    assert one.of(1, "two.csv").values == ("1A",)
    with pytest.raises(BadInput, match="none for it"):
        one.of(2, "three.csv")
