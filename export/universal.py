"""One Mach-O file for several processors: the thin ones behind a table of where each begins.

The layout is that of ``fat_header`` and ``fat_arch`` in Apple's <mach-o/fat.h>: big-endian whatever the machine.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from ..errors import BadInput

_FAT_MAGIC = 0xCAFEBABE
_THIN_MAGIC = 0xFEEDFACF  # MH_MAGIC_64, little-endian as on all processors of a Mac since PowerPC
_ARM64 = 0x0100000C  # CPU_TYPE_ARM | CPU_ARCH_ABI64
_HEADER = struct.Struct(">2I")  # magic, nfat_arch
_ENTRY = struct.Struct(">5I")  # cputype, cpusubtype, offset, size, align
_THIN = struct.Struct("<3I")  # magic, cputype, cpusubtype


@dataclass(frozen=True)
class _Slice:
    cpu: int
    subtype: int
    content: bytes

    @property
    def alignment(self) -> int:
        """Exponent of two: a slice is mapped page by page, and pages are 16 KiB on arm64, 4 KiB on x86-64."""
        return 14 if self.cpu == _ARM64 else 12


def universal(thin: Sequence[bytes]) -> bytes:
    """A universal file of 64-bit Mach-O files; their bytes stay as they are, so signatures hold.

    Args:
        thin: one file for each processor; their order does not matter.

    Raises:
        BadInput: where one is no such file, or two are for the same processor.
    """
    slices = [_slice(content) for content in thin]
    if not slices or len({s.cpu for s in slices}) < len(slices):
        raise BadInput("a universal binary holds one Mach-O file for each processor; give each processor once")
    slices.sort(key=lambda s: (s.alignment, s.cpu))
    table, body = [], b""
    end = _HEADER.size + _ENTRY.size * len(slices)
    for s in slices:
        begin = -(-end // 2**s.alignment) * 2**s.alignment
        table.append(_ENTRY.pack(s.cpu, s.subtype, begin, len(s.content), s.alignment))
        body += bytes(begin - end) + s.content
        end = begin + len(s.content)
    return _HEADER.pack(_FAT_MAGIC, len(slices)) + b"".join(table) + body


def _slice(content: bytes) -> _Slice:
    if len(content) >= _THIN.size:
        magic, cpu, subtype = _THIN.unpack_from(content)
        if magic == _THIN_MAGIC:
            return _Slice(cpu, subtype, content)
    raise BadInput("not a 64-bit Mach-O file; a universal binary is made of nothing else")
