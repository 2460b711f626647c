"""Archives of arrays: the expected ones, of plain kinds, and never more than is stated."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np
import pytest

from prag_asp.array_archive import BadArchive, read_arrays

LARGEST = 10_000


def saved(**arrays: Any) -> io.BytesIO:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer


def member(kind: str, shape: tuple[int, ...], content: bytes) -> bytes:
    buffer = io.BytesIO()
    np.lib.format.write_array_header_1_0(buffer, {"descr": kind, "fortran_order": False, "shape": shape})
    return buffer.getvalue() + content


def archive(*members: tuple[str, bytes]) -> io.BytesIO:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as new:
        for name, content in members:
            new.writestr(name, content)
    return buffer


def test_what_numpy_saves_is_read_back() -> None:
    arrays = {
        "floats": np.arange(12, dtype=np.float32).reshape(3, 4),
        "columns": np.asfortranarray(np.arange(6).reshape(2, 3)),
        "none": np.zeros((0, 3)),
        "single": np.array(2),
        "texts": np.array(["a", "bc"]),
        "empty": np.array(["", ""]),
        "flags": np.array([True, False]),
    }
    found = read_arrays(saved(**arrays), arrays, LARGEST)
    for name, array in arrays.items():
        assert found[name].dtype == array.dtype and np.array_equal(found[name], array)


def test_an_array_that_is_not_expected_is_not_even_unpacked() -> None:
    content = saved(a=np.arange(3), b=np.array([{"x": 1}], dtype=object), c=np.zeros(10**6))
    assert list(read_arrays(content, ["a", "missing"], LARGEST)) == ["a"]


@pytest.mark.parametrize("odd", [np.array([print], dtype=object), np.zeros(2, [("a", "f4")]), np.zeros(2, "M8[s]")])
def test_neither_a_pickle_nor_fields_nor_dates_are_read(odd: Any) -> None:
    with pytest.raises(BadArchive, match="a has to hold numbers or texts"):
        read_arrays(saved(a=odd), ["a"], LARGEST)


def test_an_archive_that_grows_past_the_size_is_refused_before_it_is_unpacked() -> None:
    with pytest.raises(BadArchive, match="larger than 0 MB"):
        read_arrays(saved(a=np.zeros(10**6)), ["a"], LARGEST)


@pytest.mark.parametrize(
    "content",
    [member("<f8", (10**12,), b""), member("<f8", (2, -1), bytes(16)), member("<f8", (1,), bytes(16)),
     member("<f8", (2**40, 2**40), bytes(16)), member("<f8", (3,), bytes(16))],
)  # fmt: skip
def test_a_header_that_promises_another_size_is_refused(content: bytes) -> None:
    with pytest.raises(BadArchive, match="a has a size that differs from its header"):
        read_arrays(archive(("a.npy", content)), ["a"], LARGEST)


@pytest.mark.parametrize("kind", ["<U1", ">U1"])
@pytest.mark.parametrize(
    ("code", "is_one"), [(0x10FFFF, True), (0x110000, False), (0x72000000, False), (0xD800, False)]
)
def test_a_character_that_there_is_not_is_refused(kind: str, code: int, is_one: bool) -> None:
    content = archive(("a.npy", member(kind, (1,), code.to_bytes(4, "little" if kind[0] == "<" else "big"))))
    if is_one:
        assert read_arrays(content, ["a"], LARGEST)["a"].tolist() == [chr(code)]
    else:
        with pytest.raises(BadArchive, match="a has invalid characters"):
            read_arrays(content, ["a"], LARGEST)


def test_a_directory_that_promises_less_than_there_is_does_not_get_more_unpacked() -> None:
    content = archive(("a.npy", member("<f8", (10**5,), bytes(8 * 10**5)))).getvalue()
    true, said = (len(member("<f8", (10**5,), b"")) + size for size in (8 * 10**5, 8))
    lying = content.replace(true.to_bytes(4, "little"), said.to_bytes(4, "little"))
    assert lying != content
    with pytest.raises(BadArchive):
        read_arrays(io.BytesIO(lying), ["a"], LARGEST)


def test_two_arrays_of_one_name_are_refused() -> None:
    content = member("<f8", (2,), bytes(16))
    with pytest.warns(UserWarning, match="Duplicate"):
        twice = archive(("a.npy", content), ("a.npy", content))
    with pytest.raises(BadArchive, match="two arrays called a"):
        read_arrays(twice, ["a"], LARGEST)


def test_every_cut_is_noticed() -> None:
    content = saved(a=np.arange(3), b=np.array(["x"])).getvalue()
    for end in range(len(content)):
        with pytest.raises(BadArchive):
            read_arrays(io.BytesIO(content[:end]), ["a", "b"], LARGEST)
