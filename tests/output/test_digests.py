"""Digests of values and of files."""

from __future__ import annotations

from hashlib import blake2b
from pathlib import Path

import pytest

from prag_asp.output.digests import digest, file_digest, files_digest


def test_a_digest_is_blake2b_of_the_json_of_a_value() -> None:
    assert digest(["a", 1]) == blake2b(b'["a", 1]', digest_size=20).hexdigest() != digest(["a", 2])


def test_a_digest_of_files_covers_their_contents_and_places_whatever_their_order(tmp_path: Path) -> None:
    one, two = tmp_path / "one", tmp_path / "sub" / "two"
    two.parent.mkdir()
    one.write_bytes(b"1")
    two.write_bytes(b"2")
    first = files_digest([one, two], tmp_path)
    assert files_digest([two, one], tmp_path) == first
    moved = two.rename(tmp_path / "two")
    assert files_digest([one, moved], tmp_path) != first
    one.write_bytes(b"3")
    assert file_digest(one) == blake2b(b"3", digest_size=20).hexdigest()


def test_a_file_that_is_not_there_has_no_digest(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="none"):
        file_digest(tmp_path / "none")
