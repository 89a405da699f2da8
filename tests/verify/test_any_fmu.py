"""FMUs from anywhere: archives and descriptions after accidents are taken or refused, and nothing lands elsewhere."""

from __future__ import annotations

import random
import shutil
import warnings
import zipfile

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.export.fmu import export_fmu
from dashpot.model import Oscillator
from dashpot.simulate.force import straight_lines
from dashpot.verify.fmu_run import FmuRun
from dashpot.verify.slave import described
from dashpot.verify.unpack import unpack
from hypothesis import strategies as st

SEEDS = st.integers(0, 2**32)
NAMES = (
    "../out", "/tmp/out", "a/../../out", "C:\\out", "..\\out", " ", ".", "a\nb", "modelDescription.xml", "x" * 300,
    "é/ü",
)  # fmt: skip
ODD = (
    "", " ", "0", "-1", "1e308", "nan", "inf", "true", "4294967296", "-2147483649", "é", "\ud7ff", "x" * 400,
    "\x1b[31m", "&", "<", ">", '"', "&lt;", "&x;", "]]>", "<!-- ", "<![CDATA[", "</ScalarVariable>", "<Real/>",
    "<?xml?>", "input", "output", "parameter", "fixed", "tunable", "2.0", "3.0", "3.1", "1.0", "F", "x",
    "../../../bin/sh", "/", "a\nb",
)  # fmt: skip
ENTITIES = (
    '<!DOCTYPE a [<!ENTITY x "yyyyyyyyyy"><!ENTITY z "&x;&x;&x;&x;&x;&x;&x;&x;">'
    '<!ENTITY e SYSTEM "file:///etc/hostname">]>'
)


@pytest.fixture(scope="module", params=[2, 3])
def sound(request, tmp_path_factory):
    oscillator = Oscillator.from_values(TRUTH, name="rig")
    return export_fmu(oscillator, tmp_path_factory.mktemp("sound") / "rig.fmu", version=request.param)


def packed(fmu, path, dice):
    """The archive made anew with accidents among its entries, and then among its bytes."""
    with zipfile.ZipFile(fmu) as source:
        entries = [(name, source.read(name)) for name in source.namelist() if not name.startswith("sources")]
    for _ in range(dice.randrange(4)):
        name, content = entries.pop(dice.randrange(len(entries)))
        kind = dice.randrange(4)
        if kind == 0:
            entries += [(name, content), (name, content[: dice.randrange(len(content) + 1)])]
        elif kind == 1:
            entries.append((dice.choice(NAMES), content[:1000]))
        elif kind == 2:
            entries.append((name + dice.choice(["", "/", "/x"]), b""))
        if not entries:
            break
    with warnings.catch_warnings(), zipfile.ZipFile(path, "w", dice.choice([0, 8, 12, 14])) as target:
        warnings.simplefilter("ignore")  # of names that are there twice
        for name, content in entries:
            target.writestr(name, content)
    content = bytearray(path.read_bytes())
    for _ in range(dice.choice([0, 1, 1, 8])):
        end = dice.choice([len(content), len(content), max(1, len(content) // 50)])  # the directory is at the end
        at = len(content) - 1 - dice.randrange(end)
        content[at : at + dice.choice([0, 1, 1, 2])] = bytes(dice.randrange(256) for _ in range(dice.randrange(3)))
    if dice.randrange(6) == 0:
        del content[dice.randrange(len(content)) :]
    path.write_bytes(bytes(content))


def described_oddly(text, dice):
    """The text of a description after accidents to its attributes, tags and lines."""
    pieces = text.split('"')
    for _ in range(dice.randrange(1, 5)):
        at, kind = dice.randrange(len(pieces)), dice.randrange(6)
        if kind < 3:
            pieces[at | 1 if (at | 1) < len(pieces) else at] = dice.choice(ODD)  # what stands between quotes
        elif kind == 3:
            pieces[at] = dice.choice(ODD)
        elif kind == 4 and len(pieces) > 3:
            del pieces[at : at + 2]
        else:
            pieces[at:at] = pieces[at : at + dice.choice([2, 20])]
    text = '"'.join(pieces)
    if dice.randrange(10) == 0:
        text = text.replace("?>", f"?>{ENTITIES}", 1).replace('description="', 'description="&z;&e;', 1)
    return text


def test_any_archive_is_unpacked_or_refused(every, unless_refused, sound, tmp_path):
    fmu, folder = tmp_path / "rig.fmu", tmp_path / "deep" / "unpacked"

    def holds(seed):
        packed(sound, fmu, random.Random(seed))
        folder.mkdir(parents=True)
        unless_refused(unpack, fmu, folder)
        assert sorted(path.name for path in tmp_path.iterdir()) == ["deep", "rig.fmu"]
        assert [path.name for path in folder.parent.iterdir()] == ["unpacked"]
        assert not [path for path in folder.rglob("*") if path.is_symlink()]
        shutil.rmtree(folder.parent)

    every(SEEDS, holds, 25)


def test_any_description_is_read_or_refused(every, unless_refused, sound, tmp_path):
    unpack(sound, tmp_path)
    path = tmp_path / "modelDescription.xml"
    text = path.read_text(encoding="utf-8")

    def holds(seed):
        dice = random.Random(seed)
        encoding = dice.choice(["utf-8", "utf-8", "utf-8", "latin-1", "utf-16"])
        path.write_bytes(described_oddly(text, dice).encode(encoding, "replace"))
        description = unless_refused(described, tmp_path, "rig.fmu")
        if description is not None:
            assert "F" in [variable.name for variable in description.modelVariables]

    every(SEEDS, holds, 40)


def test_any_fmu_runs_or_is_refused(every, unless_refused, sound, tmp_path):
    """The whole way, in the FMU's own process: what is refused before costs little, what runs gives finite numbers."""
    fmu, n, dt = tmp_path / "rig.fmu", 20, 2e-3
    force = straight_lines(np.sin(np.arange(n) * dt), dt)

    def ran():
        with FmuRun(fmu) as run:
            return run.record(force, n, dt, np.array([1e-3, 0.0]))

    def holds(seed):
        dice = random.Random(seed)
        with zipfile.ZipFile(sound) as source, zipfile.ZipFile(fmu, "w") as target:
            for name in source.namelist():
                content = source.read(name)
                if name == "modelDescription.xml":
                    content = described_oddly(content.decode(), dice).encode("utf-8", "replace")
                elif name == "resources/model.yaml" and dice.randrange(3) == 0:
                    content = content.replace(b":", dice.choice([b"", b": [", b"\xff"]), 1)
                if not name.startswith("sources"):
                    target.writestr(name, content)
        response = unless_refused(ran)
        assert response is None or np.isfinite(response).all()

    every(SEEDS, holds, 2)
