"""Whatever an export writes, it measures each fact of the model once."""

from __future__ import annotations

from collections import Counter

import pytest
from dashpot.export import export
from dashpot.export.facts import Facts
from dashpot.export.platforms import own_platform
from dashpot.model import Oscillator
from dashpot.model.equations import equations_of

FILES = ["rig.fmu", "rig.ssp", "rig.c", "rig.casadi"]


@pytest.fixture
def asked(monkeypatch) -> Counter[str]:
    """How often each fact was measured."""
    count: Counter[str] = Counter()
    places = {
        "internal_step": ["facts"],
        "sample_motion": ["facts"],
        "motion_size": ["facts"],
        "HarmonicMotion": ["facts"],
        "describe_fmu": ["fmu", "plain_c"],
    }
    for name, modules in places.items():
        for module in modules:
            real = getattr(__import__(f"dashpot.export.{module}", fromlist=[name]), name)

            def counted(*given, _real=real, _name=name, **named):
                count[_name] += 1
                return _real(*given, **named)

            monkeypatch.setattr(f"dashpot.export.{module}.{name}", counted)
    return count


@pytest.mark.parametrize("file", FILES)
def test_each_fact_is_measured_once(with_law, tmp_path, asked, file):
    how = {"platforms": (own_platform(),)} if file.endswith(("fmu", "ssp")) else {}
    export(with_law("hysteresis", "two-sided-stop"), tmp_path / file, **how)
    assert asked["internal_step"] == asked["sample_motion"] == 1
    assert max(asked.values()) == 1


@pytest.mark.parametrize("file", FILES)
def test_the_equations_are_written_once_for_the_whole_and_for_each_part(with_law, tmp_path, file):
    how = {"platforms": (own_platform(),)} if file.endswith(("fmu", "ssp")) else {}
    equations_of.cache_clear()
    export(with_law("hysteresis", "two-sided-stop", "sensor-lag"), tmp_path / file, **how)
    # the parts: laws with a memory, and those without; and the whole with a payload
    assert equations_of.cache_info().misses == (4 if "platforms" in how else 1)


def test_a_model_without_motion_has_a_step_all_the_same():
    still = dict.fromkeys(["omega0", "cubic", "preload", "viscous", "dry"], 0.0)
    assert Facts(Oscillator.from_values({"mass": 1.0, **still})).max_step == 1e-3
    moving = Facts(Oscillator.from_values({"mass": 1.0, **still, "omega0": 10.0}))
    assert moving.max_step == moving.longest == pytest.approx(0.628 / 75, rel=1e-3)
