from __future__ import annotations

import zlib
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from prag_asp.array_archive import BadArchive
from prag_asp.errors import QueryError
from prag_asp.physics.demonstration.packed_arrays import Packed, Packer, read_packed, with_packed

KINDS = {"u1": (4, 5, 3), "<f2": (4, 5), "<u2": (1,)}


def packed(chance, kind: str, row: tuple[int, ...], count: int = 3) -> tuple[np.ndarray, Packed]:
    array = np.random.default_rng(chance.seed(1)).integers(0, 200, (count, *row)).astype(kind)
    packer = Packer(count, row, kind)
    for each in array:
        packer.add(each)
    return array, packer.finish()


def archive(**arrays: np.ndarray) -> bytes:
    buffer = BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


@pytest.mark.parametrize(("kind", "row"), KINDS.items())
def test_what_is_packed_is_read_by_numpy_and_by_us_whole_and_row_by_row(chance, kind, row):
    array, one = packed(chance, kind, row)
    file = BytesIO(with_packed(archive(small=np.arange(3)), {"front/rgb": one, "b": one}))
    with np.load(file) as found:
        assert sorted(found.files) == ["b", "front/rgb", "small"]
        assert found["small"].tolist() == [0, 1, 2]
        assert found["front/rgb"].dtype == array.dtype and (found["front/rgb"] == array).all()
    read = read_packed(file, {"front/rgb": (array.shape, kind)})["front/rgb"]
    assert read == one and (read.array() == array).all()
    assert all((one == two).all() for one, two in zip(read.rows(), array, strict=True))


def test_an_archive_of_another_form_is_refused(chance):
    array, one = packed(chance, "u1", (4, 5, 3))
    file = BytesIO(with_packed(archive(small=np.arange(3)), {"film": one}))
    for name, shape, kind in (
        ("other", array.shape, "u1"),
        ("film", (3, 4, 5, 4), "u1"),
        ("film", array.shape, "<f2"),
        ("small", (3,), "u1"),
    ):
        with pytest.raises(BadArchive):
            read_packed(file, {name: (shape, kind)})
    with pytest.raises(BadArchive, match=r"not a \.npz file"):
        read_packed(BytesIO(file.getvalue()[:-30]), {"film": (array.shape, "u1")})


def test_a_changed_stream_is_refused(chance):
    _, one = packed(chance, "u1", (4, 5, 3))
    stream = bytearray(one.stream)
    stream[len(stream) // 2] ^= 1
    longer = zlib.compressobj(1, zlib.DEFLATED, -15)
    content = zlib.decompress(one.stream, -15)
    for wrong in (
        bytes(stream),
        one.stream[:-4],
        b"",
        longer.compress(content + b"more") + longer.flush(),
    ):
        with pytest.raises(QueryError, match="cut off or changed"):
            replace(one, stream=wrong).array()
