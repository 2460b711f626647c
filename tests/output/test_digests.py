"""Digests of values and of files."""

from __future__ import annotations

from hashlib import blake2b
from pathlib import Path

import pytest

from prag_asp.output.digests import digest, files_digest


def test_digests_are_blake2b_of_values_and_of_the_contents_and_paths_of_files(tmp_path: Path) -> None:
    assert digest(["a", 1]) == blake2b(b'["a", 1]', digest_size=20).hexdigest() != digest(["a", 2])
    one, two = tmp_path / "one", tmp_path / "sub" / "two"
    two.parent.mkdir()
    one.write_bytes(b"1")
    two.write_bytes(b"2")
    first = files_digest([one, two], tmp_path)
    assert files_digest([two, one], tmp_path) == first
    moved = two.rename(tmp_path / "two")
    assert files_digest([one, moved], tmp_path) != first
    one.write_bytes(b"3")
    content = blake2b(b"3", digest_size=20).hexdigest()
    assert files_digest([one], tmp_path) == digest([("one", content)])
    with pytest.raises(OSError, match="none"):
        files_digest([tmp_path / "none"], tmp_path)
