"""Read archives written by `numpy.savez`: only the expected arrays, and no more bytes than their headers declare.

An archive of a few kilobytes can hold many gigabytes, and an array can be a pickle, which runs code. Therefore the
sizes in the directory of the archive are checked before anything is unpacked, the header of each array is checked
before the array is read, and no more bytes are unpacked than stated.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from sys import maxunicode
from typing import TYPE_CHECKING, Any, BinaryIO
from zipfile import ZipFile, ZipInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

SUFFIX = ".npy"
LONGEST_HEADER = 10_000
KINDS = frozenset("biufU")
"""NumPy's kind codes of numbers and strings; objects, which are pickles, and structured types are excluded."""


class BadArchive(Exception):
    """An archive does not have the expected content."""


def read_arrays(file: BinaryIO, names: Collection[str], at_most: int) -> dict[str, NDArray[Any]]:
    """Return those of the named arrays that an archive contains; `at_most` limits their total unpacked size in bytes.

    Raises:
        OSError: the file cannot be read.
        BadArchive: the file is not an archive or is truncated, the arrays are too large, or an array holds neither
            numbers nor strings.
    """
    try:
        with ZipFile(file) as archive:
            members = _members(archive, names)
            if sum(member.file_size for member in members.values()) > at_most:
                raise BadArchive(f"its arrays are larger than {at_most / 10**6:,.0f} MB")
            return {name: _array(archive, name, member) for name, member in members.items()}
    except (BadArchive, MemoryError):
        raise
    except OSError as error:
        if error.errno is not None:
            raise
        raise BadArchive("it is not a .npz file, or is truncated") from None
    except Exception as error:  # zipfile and NumPy raise errors of many kinds for damaged files
        raise BadArchive("it is not a .npz file, or is truncated") from error


def _members(archive: ZipFile, names: Collection[str]) -> Mapping[str, ZipInfo]:
    """Return the members of an archive by the names of their arrays.

    Raises:
        BadArchive: two members have the same name.
    """
    wanted = {f"{name}{SUFFIX}": name for name in names}
    found: dict[str, ZipInfo] = {}
    for member in archive.infolist():
        name = wanted.get(member.filename)
        if name in found:
            raise BadArchive(f"it has two arrays called {name}")
        if name is not None:
            found[name] = member
    return found


def _array(archive: ZipFile, name: str, member: ZipInfo) -> NDArray[Any]:
    """Read one array from an archive.

    Raises:
        BadArchive: the array holds neither numbers nor valid strings, or its size differs from its header.
    """
    import numpy as np  # noqa: PLC0415 - not every program reads an archive
    from numpy.lib import format as npy  # noqa: PLC0415

    with archive.open(member) as file:
        read_header = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}[npy.read_magic(file)]
        shape, by_columns, kind = read_header(file, max_header_size=LONGEST_HEADER)
        if kind.kind not in KINDS or kind.hasobject:
            raise BadArchive(f"{name} has to hold numbers or texts")
        count = 1
        for side in shape:
            count *= side
        size = count * kind.itemsize
        if min(shape, default=0) < 0 or size != member.file_size - file.tell():
            raise BadArchive(f"{name} has a size that differs from its header")
        content = bytearray(file.read(size + 1))  # so that the array can be written to, as after `numpy.load`
        if len(content) != size:
            raise BadArchive(f"{name} was cut off")
    array = np.frombuffer(content, kind) if kind.itemsize else np.zeros(count, kind)
    if kind.kind == "U" and kind.itemsize:
        codes = array.view(np.dtype(np.uint32).newbyteorder(kind.byteorder))
        halves = (codes >= 0xD800) & (codes < 0xE000)
        if (halves | (codes > maxunicode)).any():  # NumPy turns these into strings that crash
            raise BadArchive(f"{name} has invalid characters")
    return array.reshape(shape, order="F" if by_columns else "C")
