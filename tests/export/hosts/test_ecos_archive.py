"""Two rigs in an SSP archive under Ecos, that of docs/hosts/ecos.md: the first one's decay drives the second."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
from dashpot.examples.oscillator import integrate_pieces

ROOT = Path(__file__).resolve().parents[3]
DT, N = 1e-3, 800


def test_the_archive_of_the_docs_runs(play, fmu_of, models, tmp_path):
    page = (ROOT / "docs/hosts/ecos.md").read_text("utf-8")
    (structure,) = re.findall(r"```xml\n(.*?)```", page, re.DOTALL)
    archive = tmp_path / "two.ssp"
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("SystemStructure.ssd", structure)
        file.write(fmu_of(2), "resources/rig.fmu")
    outputs = ["first::x", "second::x"]
    first, second = play(
        "ecospy_simulation", archive, np.zeros(N), DT, {}, "zero", function="archive", outputs=outputs, values="start"
    )
    values = models["base"]().values()
    alone = integrate_pieces(values, np.zeros((N - 1, 1)), DT, 5e-3, 0.0)[0]
    np.testing.assert_allclose(first, alone, atol=1e-6 * 5e-3)
    driven = integrate_pieces(values, 400.0 * first[:-1, None], DT, 0.0, 0.0)[0]  # held from step to step
    assert np.max(np.abs(second - driven)) < 1e-6 * np.max(np.abs(driven))
