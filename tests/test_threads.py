"""Whatever the number of threads, the answers of identify and diagnose are the same, bit for bit."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.model import Oscillator
from dashpot.simulate.threads import pool

#: Modules that keep threads of their own for laws.
OWN = ("identify.start.measured_motion", "diagnose.search.score_test", "diagnose.search.by_prediction")


@pytest.fixture
def threads(monkeypatch):
    """``threads(n)``: from then on so many threads simulate, and so many ask laws."""

    def use(count: int) -> None:
        monkeypatch.setattr(os, "cpu_count", lambda: count)
        for module in OWN:
            monkeypatch.setattr(
                f"dashpot.{module}.ThreadPoolExecutor", lambda max_workers: ThreadPoolExecutor(min(max_workers, count))
            )
        pool.cache_clear()

    yield use
    pool.cache_clear()


def decays():
    begins = (9e-3, 6e-3)
    return [recording_of(begin=(x, 0.0), seconds=2.0, noise=2e-6, name=f"{x} m", seed=i) for i, x in enumerate(begins)]


def numbers(model: Oscillator) -> list[float]:
    return [value for p in model.parameters().values() for value in (p.value, -1.0 if p.std is None else p.std)]


def test_identify_gives_the_same_whatever_the_number_of_threads(threads):
    found = []
    for count in (1, 2):
        threads(count)
        answer = identify(decays())
        found.append((numbers(answer.oscillator), answer.fit.covariance.tolist(), answer.work.simulated))
    assert found[0] == found[1]


def test_diagnose_gives_the_same_whatever_the_number_of_threads(threads):
    model, found = identify(decays()).oscillator, []
    for count in (1, 2):
        threads(count)
        told = diagnose(model, decays())
        found.append(
            (numbers(told.model), told.verdict, [(c.effect, c.delta_bic) for c in told.considered], told.work.simulated)
        )
    assert found[0] == found[1]
    assert np.all(np.isfinite(found[0][0]))
