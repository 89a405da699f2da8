"""A universal Mach-O file against the published layout of fat_header and fat_arch."""

from __future__ import annotations

import struct

import pytest
from dashpot.errors import BadInput
from dashpot.export.universal import universal

X86_64, ARM64 = 0x01000007, 0x0100000C


def thin(cpu, subtype, size):
    return struct.pack("<3I", 0xFEEDFACF, cpu, subtype) + bytes([subtype + 1]) * (size - 12)


@pytest.mark.parametrize("sizes", [(4096, 16384), (5001, 70_003), (12, 12), (40_450, 69_496)])
def test_the_table_says_where_each_file_lies(sizes):
    x86, arm = thin(X86_64, 3, sizes[0]), thin(ARM64, 0, sizes[1])
    whole = universal([arm, x86])
    assert whole == universal([x86, arm])
    assert struct.unpack_from(">2I", whole) == (0xCAFEBABE, 2)
    end = 8 + 2 * 20
    for i, (cpu, subtype, content, align) in enumerate([(X86_64, 3, x86, 12), (ARM64, 0, arm, 14)]):
        found_cpu, found_subtype, offset, size, found_align = struct.unpack_from(">5I", whole, 8 + 20 * i)
        assert (found_cpu, found_subtype, size, found_align) == (cpu, subtype, len(content), align)
        assert offset % 2**align == 0
        assert end <= offset < end + 2**align
        assert whole[end:offset] == bytes(offset - end)  # nothing but zeros between
        assert whole[offset : offset + size] == content
        end = offset + size
    assert len(whole) == end


@pytest.mark.parametrize(
    ("files", "says"),
    [
        ([], "one Mach-O file for each processor"),
        ([thin(ARM64, 0, 20), thin(ARM64, 0, 30)], "each processor once"),
        ([b"\x7fELF" + bytes(60)], "not a 64-bit Mach-O file"),
        ([b"\xcf\xfa"], "not a 64-bit Mach-O file"),
    ],
)
def test_what_makes_no_universal_file_is_refused(files, says):
    with pytest.raises(BadInput, match=says):
        universal(files)
