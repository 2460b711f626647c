"""Compress arrays row by row, and write them into a .npz archive without decompressing them.

An uncompressed video is large, so each image is compressed when it is taken. The format of the archive's parts follows
PKWARE's APPNOTE (6.3.10, 4.3.7, 4.3.12 and 4.3.16).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from itertools import repeat
from typing import Any, BinaryIO
from zipfile import BadZipFile, ZipFile

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from prag_asp.array_archive import SUFFIX, BadArchive
from prag_asp.errors import QueryError

LEVEL = 1
"""The compression level: level 6 makes images a fifth smaller, but takes four times as long."""

RAW = -15
"""The window size that selects a raw zlib stream without a header, as used in archives."""

LOCAL, CENTRAL, END = struct.Struct("<4s5H3L2H"), struct.Struct("<4s6H3L5H2L"), struct.Struct("<4s4H2LH")
VERSION, UTF8, DEFLATED, FIRST_DAY = 20, 1 << 11, 8, 33
LARGEST = 2**32 - 1
PIECE = 1 << 16
BROKEN = "the pictures of an episode were cut off or changed; record it anew"


@dataclass(frozen=True)
class Packed:
    """An array of N rows as a compressed .npy stream, with its checksum and uncompressed size."""

    count: int
    row: tuple[int, ...]
    dtype: str
    stream: bytes = field(repr=False)
    checksum: int
    size: int

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the whole array."""
        return (self.count, *self.row)

    def rows(self) -> Iterator[NDArray[Any]]:
        """Yield the rows, unpacking one at a time.

        Raises:
            QueryError: the stream was cut off or changed.
        """
        kind = np.dtype(self.dtype)
        length = int(np.prod(self.row, dtype=np.int64)) * kind.itemsize
        unpacked = _unpacked(self, len(_head(self.shape, kind)), length)
        next(unpacked)
        for content in unpacked:
            yield np.frombuffer(content, kind).reshape(self.row)

    def array(self) -> NDArray[Any]:
        """Return the whole array.

        Raises:
            QueryError: the stream was cut off or changed.
        """
        result = np.empty(self.shape, self.dtype)
        for i, row in enumerate(self.rows()):
            result[i] = row
        return result


class Packer:
    """A compressor of an array with a known number of rows, row by row."""

    def __init__(self, count: int, row: tuple[int, ...], dtype: str):
        self._shape, self._kind = (count, *row), np.dtype(dtype)
        self._compressor = zlib.compressobj(LEVEL, zlib.DEFLATED, RAW)
        self._pieces: list[bytes] = []
        self._checksum, self._size = 0, 0
        self._take(_head(self._shape, self._kind))

    def add(self, row: NDArray[Any]) -> None:
        """Add the next row."""
        assert row.shape == self._shape[1:] and row.dtype == self._kind
        self._take(np.ascontiguousarray(row).tobytes())

    def finish(self) -> Packed:
        """Return the array, once all rows have been added."""
        self._pieces.append(self._compressor.flush())
        count, *row = self._shape
        return Packed(count, tuple(row), self._kind.str, b"".join(self._pieces), self._checksum, self._size)

    def _take(self, content: bytes) -> None:
        self._pieces.append(self._compressor.compress(content))
        self._checksum, self._size = zlib.crc32(content, self._checksum), self._size + len(content)


def with_packed(archive: bytes, arrays: Mapping[str, Packed]) -> bytes:
    """Return an archive with further arrays, given by name, added to it.

    Raises:
        ValueError: the archive would exceed 4 GB, the limit of the format.
    """
    signature, disc, first, _, entries, size, begin, _ = END.unpack(archive[-END.size :])
    head, directory = archive[:begin], archive[begin : begin + size]
    pieces, at = [head], len(head)
    for name, packed in arrays.items():
        file = f"{name}{SUFFIX}".encode()
        fields = (VERSION, UTF8, DEFLATED, 0, FIRST_DAY, packed.checksum, len(packed.stream), packed.size, len(file), 0)
        if max(at, packed.size) + len(packed.stream) > LARGEST:
            raise ValueError("it is larger than 4 GB; record fewer, smaller or rarer images")
        local = LOCAL.pack(b"PK\3\4", *fields) + file
        directory += CENTRAL.pack(b"PK\1\2", VERSION, *fields, 0, 0, 0, 0, at) + file
        pieces += [local, packed.stream]
        at += len(local) + len(packed.stream)
    entries += len(arrays)
    return b"".join([*pieces, directory, END.pack(signature, disc, first, entries, entries, len(directory), at, 0)])


def read_packed(file: BinaryIO, names: Mapping[str, tuple[tuple[int, ...], str]]) -> dict[str, Packed]:
    """Return arrays from an archive without unpacking them; `names` gives their required shapes and types.

    Raises:
        OSError: the file cannot be read.
        BadArchive: an array is missing, truncated, or has a wrong shape or type.
    """
    try:
        with ZipFile(file) as archive:
            members = {info.filename: info for info in archive.infolist()}
            result = {}
            for name, (shape, dtype) in names.items():
                member, kind = members.get(f"{name}{SUFFIX}"), np.dtype(dtype)
                if member is None:
                    raise BadArchive(f"it has no {name}")
                head = _head(shape, kind)
                size = len(head) + int(np.prod(shape, dtype=np.int64)) * kind.itemsize
                with archive.open(member) as content:
                    begin = content.read(len(head))
                if begin != head or member.file_size != size or member.compress_type != DEFLATED:
                    raise BadArchive(f"{name} is not an array of {kind.name} of the shape {shape}")
                file.seek(member.header_offset)
                local = LOCAL.unpack(file.read(LOCAL.size))
                file.seek(local[-2] + local[-1], 1)
                stream = file.read(member.compress_size)
                if len(stream) != member.compress_size:
                    raise BadArchive(f"{name} was cut off")
                result[name] = Packed(shape[0], shape[1:], kind.str, stream, member.CRC, size)
            return result
    except (BadZipFile, struct.error, zlib.error, NotImplementedError, RuntimeError) as error:
        raise BadArchive("it is not a .npz file, or is truncated") from error


def _head(shape: tuple[int, ...], kind: np.dtype[Any]) -> bytes:
    """Return the header of the .npy file of an array."""
    buffer = BytesIO()
    npy.write_array_header_1_0(
        buffer, {"descr": npy.dtype_to_descr(kind), "fortran_order": False, "shape": tuple(shape)}
    )
    return buffer.getvalue()


def _unpacked(packed: Packed, head: int, length: int) -> Iterator[bytes]:
    """Yield the header of an array's stream, then the rows of the array, each of which has a given length in bytes.

    Raises:
        QueryError: the stream is truncated or has changed.
    """
    decompressor, rest, at, rows = zlib.decompressobj(RAW), b"", 0, 0
    try:
        for needed in (head, *repeat(length, packed.count)):
            content = bytearray()
            while len(content) < needed:
                if not rest:
                    rest = packed.stream[at : at + PIECE]
                    at += PIECE
                piece = decompressor.decompress(rest, needed - len(content))
                if not piece and not rest:
                    raise QueryError(BROKEN)
                rest = decompressor.unconsumed_tail
                content += piece
            rows = zlib.crc32(content, rows)
            yield bytes(content)
        beyond = decompressor.decompress(rest + packed.stream[at:], 1)
    except zlib.error as error:
        raise QueryError(BROKEN) from error
    if beyond or not decompressor.eof or rows != packed.checksum:
        raise QueryError(BROKEN)
