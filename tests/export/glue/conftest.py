"""C programs around the sources of an FMU, built with and without sanitizers."""

from __future__ import annotations

import subprocess
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
from dashpot.simulate.compiler import find_compiler

HERE = Path(__file__).parent
FLAGS = ("-std=c11", "-g", "-Wall", "-Wextra", "-Wno-unused-function", "-Wno-maybe-uninitialized")
#: A program that is told nothing wrong ends with 0; the sanitizers end it with another number.
SANITIZED = {
    "plain": ("-O2",),
    "memory": ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
    "threads": ("-O1", "-fsanitize=thread"),
}


@dataclass(frozen=True)
class Program:
    """A built program and what it must be told of the FMU before its own arguments."""

    path: Path
    about: tuple[str, ...]

    def run(self, *arguments: object) -> subprocess.CompletedProcess[str]:
        """Run it to its end."""
        command = [str(self.path), *self.about, *(str(argument) for argument in arguments)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)


@pytest.fixture(scope="session")
def compiler(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., None]:
    """Compiles one file; skips where there is no compiler, or it lacks the sanitizer."""
    path = find_compiler()
    probe = tmp_path_factory.mktemp("probe")
    (probe / "probe.c").write_text("int main(void) { return 0; }\n")
    works: dict[str, bool] = {}

    def make(source: Path, out: Path, sanitizer: str, *flags: str) -> None:
        if path is None:
            pytest.skip("there is no C compiler")
        extra = SANITIZED[sanitizer]
        if sanitizer not in works:
            command = [path, *extra, "-pthread", "-o", str(probe / sanitizer), str(probe / "probe.c")]
            built = subprocess.run(command, capture_output=True, check=False).returncode == 0
            works[sanitizer] = built and subprocess.run([probe / sanitizer], capture_output=True).returncode == 0
        if not works[sanitizer]:
            pytest.skip(f"the compiler has no sanitizer of {sanitizer} that runs here")
        command = [path, *FLAGS, *extra, *flags, "-pthread", "-o", str(out), str(source), "-lm"]
        built = subprocess.run(command, capture_output=True, text=True, check=False)
        assert built.returncode == 0, built.stderr
        assert not [line for line in built.stderr.splitlines() if "warning:" in line and "/glue/" in line]

    return make


@pytest.fixture(scope="session")
def program(
    fmu_of: Callable[..., Path], compiler: Callable[..., None], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., Program]:
    """``program("fuzz", 2)``: built around the FMU of a model; ``changed`` replaces words of its sources."""
    from fmpy import read_model_description

    built: dict[object, Program] = {}

    def make(
        name: str,
        version: int = 2,
        sanitizer: str = "memory",
        *,
        fmu: Path | None = None,
        interface: str = "CoSimulation",
        changed: Mapping[str, str] | None = None,
    ) -> Program:
        fmu = fmu or fmu_of(version)
        key = (name, version, sanitizer, fmu, str(changed))
        if key in built:
            return built[key]
        folder = tmp_path_factory.mktemp("glue")
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        for old, new in (changed or {}).items():
            files = [path for path in (folder / "sources").glob("*.c") if old in path.read_text()]
            assert files, f"no source says {old!r}"
            for path in files:
                path.write_text(path.read_text().replace(old, new))
        flags = (f"-DFMI_VERSION={version}", f"-I{folder / 'sources'}")
        compiler(HERE / f"{name}.c", folder / name, sanitizer, *flags)
        description = read_model_description(str(fmu))
        reference = {v.name: v.valueReference for v in description.modelVariables}
        about = (
            description.guid if version == 2 else description.instantiationToken,
            len({*reference.values()}),
            reference["F"],
            reference["x"],
            description.numberOfContinuousStates,
            description.numberOfEventIndicators,
        )
        built[key] = Program(folder / name, tuple(str(value) for value in about))
        return built[key]

    return make
