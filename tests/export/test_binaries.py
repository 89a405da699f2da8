"""The binaries for all platforms: of the right kind, in need of the system alone, with FMI to show, always the same.

What is read of ELF, PE and Mach-O follows their published layouts and shares nothing with any tool chain.
"""

from __future__ import annotations

import hashlib
import struct
import subprocess
import sys
import zipfile
from dataclasses import dataclass, field

import pytest
from dashpot.errors import ToolchainMissing
from dashpot.export.binaries import binaries, can_build, inside, remark
from dashpot.export.facts import Facts
from dashpot.export.fmu import export_fmu, fmu_sources
from dashpot.export.platforms import PLATFORMS, own_platform, parse_platforms
from fmpy import fmi2
from fmpy.validation import validate_fmu

FMI2 = {name for c in (fmi2._FMU2, fmi2.FMU2Slave, fmi2.FMU2Model) for name in vars(c) if name.startswith("fmi2")}
#: What Apple's and zig's linkers give every image.
_OF_THE_LINKER = {"_mh_dylib_header", "__dso_handle"}


@dataclass
class Binary:
    """What a shared library says of itself."""

    kind: str
    needs: set[str] = field(default_factory=set)
    versions: set[tuple[int, ...]] = field(default_factory=set)  # of glibc's symbols, or of the system
    exports: set[str] = field(default_factory=set)
    name: str = ""


def text(data, at):
    return data[at : data.index(b"\0", at)].decode()


def elf(data):
    assert data[:6] == b"\x7fELF\x02\x01"  # 64 bits, little-endian
    kind, machine = struct.unpack_from("<2H", data, 16)
    assert kind == 3  # ET_DYN
    binary = Binary({62: "x86-64", 183: "aarch64"}[machine])
    (table,) = struct.unpack_from("<Q", data, 40)
    _, count = struct.unpack_from("<2H", data, 58)
    sections = [struct.unpack_from("<2I4Q2I2Q", data, table + 64 * i) for i in range(count)]
    for _, kind, _, _, begin, size, link, entries, _, _ in sections:
        names = sections[link][4] if link < count else 0
        if kind == 6:  # SHT_DYNAMIC
            for tag, value in struct.iter_unpack("<2Q", data[begin : begin + size]):
                if tag == 1:
                    binary.needs.add(text(data, names + value))
                assert tag not in (15, 29)  # DT_RPATH, DT_RUNPATH
        elif kind == 11:  # SHT_DYNSYM
            for name, _, _, section, _, _ in struct.iter_unpack("<IBBHQQ", data[begin : begin + size]):
                if section:
                    binary.exports.add(text(data, names + name))
        elif kind == 0x6FFFFFFE:  # SHT_GNU_verneed
            at = begin
            for _ in range(entries):
                _, marks, _, first, onwards = struct.unpack_from("<2H3I", data, at)
                mark = at + first
                for _ in range(marks):
                    _, _, _, name, further = struct.unpack_from("<I2H2I", data, mark)
                    version = text(data, names + name).removeprefix("GLIBC_")
                    binary.versions.add(tuple(int(part) for part in version.split(".")))
                    mark += further
                at += onwards
    return binary


def pe(data):
    (at,) = struct.unpack_from("<I", data, 60)
    assert data[at : at + 4] == b"PE\0\0"
    machine, count, _, _, _, optional, flags = struct.unpack_from("<2H3I2H", data, at + 4)
    assert flags & 0x2000  # IMAGE_FILE_DLL
    binary = Binary({0x8664: "x86-64"}[machine])
    assert struct.unpack_from("<H", data, at + 24) == (0x20B,)  # PE32+
    exported, _, imported, _ = struct.unpack_from("<4I", data, at + 24 + 112)
    sections = [struct.unpack_from("<8s6I", data, at + 24 + optional + 40 * i) for i in range(count)]

    def place(address):
        for _, size, begin, raw, offset, _, _ in sections:
            if begin <= address < begin + max(size, raw):
                return address - begin + offset
        raise AssertionError(f"no section holds {address:#x}")

    *_, name, _, _, names, _, table, _ = struct.unpack_from("<2I2H7I", data, place(exported))
    binary.name = text(data, place(name))
    for (address,) in struct.iter_unpack("<I", data[place(table) : place(table) + 4 * names]):
        binary.exports.add(text(data, place(address)))
    row = place(imported)
    while (name := struct.unpack_from("<5I", data, row)[3]) != 0:
        binary.needs.add(text(data, place(name)).lower())
        row += 20
    return binary


def commands(data):
    """Load commands of a Mach-O file: number, where it begins, its length."""
    at = 32
    for _ in range(struct.unpack_from("<I", data, 16)[0]):
        command, size = struct.unpack_from("<2I", data, at)
        yield command, at, size
        at += size


def macho(data):
    magic, cpu, _, kind = struct.unpack_from("<4I", data)
    assert (magic, kind) == (0xFEEDFACF, 6)  # MH_DYLIB
    binary = Binary({0x01000007: "x86-64", 0x0100000C: "aarch64"}[cpu])
    for command, at, _ in commands(data):
        if command in (0xC, 0xD):  # LC_LOAD_DYLIB, LC_ID_DYLIB
            name = text(data, at + struct.unpack_from("<I", data, at + 8)[0])
            binary.needs |= {name} if command == 0xC else set()
            binary.name = name if command == 0xD else binary.name
        if command in (0x24, 0x32):  # LC_VERSION_MIN_MACOSX, LC_BUILD_VERSION
            (packed,) = struct.unpack_from("<I", data, at + (8 if command == 0x24 else 12))
            binary.versions.add((packed >> 16, packed >> 8 & 255))
        if command == 2:  # LC_SYMTAB
            symbols, count, strings, _ = struct.unpack_from("<4I", data, at + 8)
            for i in range(count):
                name, flags, *_ = struct.unpack_from("<IBBHQ", data, symbols + 16 * i)
                if flags & 1 and flags & 0x0E:  # N_EXT, and defined here
                    binary.exports.add(text(data, strings + name).removeprefix("_"))
    return binary


def thin(data):
    """The files in a universal one."""
    assert struct.unpack_from(">2I", data) == (0xCAFEBABE, 2)
    rows = [struct.unpack_from(">5I", data, 8 + 20 * i) for i in range(2)]
    return [data[offset : offset + size] for _, _, offset, size, _ in rows]


@pytest.fixture(scope="module")
def contents(everywhere):
    with zipfile.ZipFile(everywhere()) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.mark.long
def test_an_fmu_for_all_desktops_is_small_and_sound(everywhere, contents):
    assert {name for name in contents if name.startswith("binaries/")} == {
        "binaries/linux64/stand.so",
        "binaries/aarch64-linux/stand.so",
        "binaries/win64/stand.dll",
        "binaries/darwin64/stand.dylib",
    }
    for version in (2, 3):
        assert everywhere(version).stat().st_size < 300_000
        assert validate_fmu(str(everywhere(version))) == []
    page = contents["documentation/index.html"].decode()
    for words in ("Linux x86-64 (glibc 2.17 or newer)", "Linux arm64", "Windows x64", "macOS x64", "macOS arm64"):
        assert words in page


@pytest.mark.long
@pytest.mark.parametrize(("folder", "kind"), [("linux64", "x86-64"), ("aarch64-linux", "aarch64")])
def test_linux_needs_the_c_library_of_2012(contents, folder, kind):
    binary = elf(contents[f"binaries/{folder}/stand.so"])
    assert binary.kind == kind
    assert binary.needs <= {"libc.so.6", "libm.so.6"}
    assert binary.versions
    assert max(binary.versions) <= (2, 17)
    assert binary.exports == FMI2


@pytest.mark.long
def test_windows_needs_what_is_part_of_it(contents):
    binary = pe(contents["binaries/win64/stand.dll"])
    assert (binary.kind, binary.name) == ("x86-64", "stand.dll")
    assert {name for name in binary.needs if not name.startswith("api-ms-win-crt-")} == set()
    assert binary.exports == FMI2


@pytest.mark.long
def test_macos_has_one_file_for_both_processors(contents):
    both = [macho(part) for part in thin(contents["binaries/darwin64/stand.dylib"])]
    assert [(binary.kind, binary.versions) for binary in both] == [("x86-64", {(10, 13)}), ("aarch64", {(11, 0)})]
    for binary in both:
        assert binary.name == "@rpath/stand.dylib"
        assert binary.needs == {"/usr/lib/libSystem.B.dylib"}
        assert binary.exports - _OF_THE_LINKER == FMI2


@pytest.mark.long
def test_the_signature_that_arm64_asks_for_holds(contents):
    _, arm = thin(contents["binaries/darwin64/stand.dylib"])
    (signature,) = [struct.unpack_from("<2I", arm, at + 8) for command, at, _ in commands(arm) if command == 0x1D]
    blob = arm[signature[0] : sum(signature)]
    assert struct.unpack_from(">I", blob) == (0xFADE0CC0,)  # CSMAGIC_EMBEDDED_SIGNATURE
    entries = [struct.unpack_from(">2I", blob, 12 + 8 * i) for i in range(struct.unpack_from(">I", blob, 8)[0])]
    at = dict(entries)[0]  # CSSLOT_CODEDIRECTORY
    magic, _, _, flags, hashes, _, _, pages, limit = struct.unpack_from(">9I", blob, at)
    size, kind, _, exponent = struct.unpack_from("4B", blob, at + 36)
    assert (magic, flags & 2, kind, size) == (0xFADE0C02, 2, 2, 32)  # ad hoc, SHA-256
    assert limit == signature[0]
    assert pages == -(-limit // 2**exponent)
    for i in range(pages):
        page = arm[i << exponent : min(limit, (i + 1) << exponent)]
        assert blob[at + hashes + 32 * i :][:32] == hashlib.sha256(page).digest()


@pytest.mark.long
def test_fmi_3_has_a_folder_for_each(contents, models):
    sources, _ = fmu_sources(Facts(models["base"]()))
    files = binaries(sources, "all.c", "stand", PLATFORMS, version=3)
    assert set(files) == {f"binaries/{p.fmi3}/stand{p.suffix}" for p in PLATFORMS}
    assert files["binaries/x86_64-linux/stand.so"] == contents["binaries/linux64/stand.so"]
    assert thin(contents["binaries/darwin64/stand.dylib"]) == [
        files["binaries/x86_64-darwin/stand.dylib"],
        files["binaries/aarch64-darwin/stand.dylib"],
    ]
    alone = binaries(sources, "all.c", "stand", parse_platforms("darwin-arm64,linux-arm64"))
    assert alone["binaries/darwin64/stand.dylib"] == files["binaries/aarch64-darwin/stand.dylib"]
    assert alone["binaries/linux64/stand.so"] == alone["binaries/aarch64-linux/stand.so"]


@pytest.mark.long
def test_same_model_same_bytes_and_no_trace_of_where(everywhere, contents, models, tmp_path, monkeypatch):
    again = tmp_path / "rig.fmu"
    with monkeypatch.context() as patch:
        patch.setattr(subprocess, "Popen", None)  # nothing is compiled twice
        export_fmu(models["base"](), again, platforms=PLATFORMS)
    assert again.read_bytes() == everywhere().read_bytes()
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path / "cache"))
    export_fmu(models["base"](), again, platforms=PLATFORMS)
    assert again.read_bytes() == everywhere().read_bytes()
    for name, content in contents.items():
        if name.startswith("binaries/"):
            for trace in (b"dashpot", b"all.c", b"/tmp", b"/home", b"\\Users"):
                assert trace not in content, name


@pytest.mark.long
def test_a_build_that_fails_names_its_platform_and_leaves_nothing(everywhere, models, tmp_path, monkeypatch):
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path / "cache"))
    broken = (sys.executable, "-c", "import sys; sys.exit('the disk is full')")
    monkeypatch.setattr("dashpot.simulate.zig.zig_command", lambda: broken)
    with pytest.raises(ToolchainMissing, match=r"binary for win64: .*the disk is full"):
        export_fmu(models["base"](), tmp_path / "out/rig.fmu", platforms=parse_platforms("win64"))
    assert not (tmp_path / "out").exists()
    assert list((tmp_path / "cache" / "compiled").iterdir()) == []


@pytest.mark.long
def test_what_takes_long_the_first_time_is_said_then_and_only_then(everywhere, models, tmp_path, monkeypatch):
    def fake(compiler, sources, main, name, *, flags, before):
        before()
        (tmp_path / name).touch()
        return tmp_path / name, b""

    monkeypatch.setattr("dashpot.export.binaries.build", fake)
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path))
    said = []
    for _ in range(2):
        files = binaries({}, "all.c", "rig", parse_platforms("win64,linux64"), progress=said.append)
    assert list(files) == ["binaries/linux64/rig.so", "binaries/win64/rig.dll"]
    assert [line.partition(";")[0] for line in said] == ["compiling for Linux x86-64", "compiling for Windows x64"]


def test_what_is_inside_is_said(monkeypatch):
    monkeypatch.setattr("dashpot.simulate.zig.zig_version", lambda: "1")
    assert set(PLATFORMS) <= set(can_build())
    assert remark(PLATFORMS[:3]) == "the FMU runs on Linux x86-64, Linux arm64 and Windows x64"
    assert "Windows x64 (Windows 10 or newer); for others" in inside(PLATFORMS[2:3])
    monkeypatch.setattr("dashpot.simulate.zig.zig_version", lambda: None)
    monkeypatch.setattr("dashpot.simulate.compiler.find_compiler", lambda: "cc")
    assert can_build() == (own_platform(),)
    assert 'pip install "dashpot[platforms]"' in remark(can_build())
    assert "at least as new" in inside(can_build())


@pytest.mark.long
def test_whatever_a_law_can_be_made_of_links_everywhere(everywhere):
    import casadi as ca

    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    unary = "sqrt sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log log1p expm1 erf floor ceil fabs"
    binary = "atan2 fmin fmax fmod copysign hypot remainder"
    values = [getattr(ca, name)(x) for name in (*unary.split(), "log10", "sign")]
    values += [getattr(ca, name)(x, y) for name in binary.split()] + [
        x**y,
        ca.if_else(x < y, x, y),
        ca.constpow(x, 2.5),
    ]
    generator = ca.CodeGenerator("law.c", {"with_header": False})
    generator.add(ca.Function("law", [x, y], [ca.vertcat(*values)]))
    sources = {
        "law.c": generator.dump(),
        # beside it what the engine uses: the kind of a number, text, memory, a frame larger than a page of the stack
        "all.c": """
            #include <math.h>
            #include <stdarg.h>
            #include <stdio.h>
            #include <stdlib.h>
            #include <string.h>
            #ifdef _WIN32
            #define SHOWN __declspec(dllexport)
            #else
            #define SHOWN __attribute__((visibility("default")))
            #endif
            #define CASADI_SYMBOL_EXPORT SHOWN
            #include "law.c"
            SHOWN int say(char *text, size_t size, const char *form, ...) {
                va_list values;
                int length;
                va_start(values, form);
                length = vsnprintf(text, size, form, values);
                va_end(values);
                return length;
            }
            SHOWN int kinds(double x) { return !!isfinite(x) + 2 * !!isnan(x) + 4 * !!signbit(x) + 8 * !!isinf(x); }
            SHOWN double last(const double *from, size_t n) {
                volatile double copy[4096];
                double *kept = malloc(n * sizeof *kept);
                memmove(kept, from, n * sizeof *kept);
                memcpy((void *)copy, kept, n * sizeof *kept);
                free(kept);
                return copy[n - 1];
            }
        """,
    }
    assert len(binaries(sources, "all.c", "law", PLATFORMS)) == 4
