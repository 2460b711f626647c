"""Lines of the joined program lead back to the files; includes stay within the domain and the encodings."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp.errors import DomainError
from prag_asp.program.sources import Program, Source, read_sources
from prag_asp.program.tokens import blanked, open_comment


def write(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / f"{name}.lp").write_text(text, encoding="utf-8")
    return folder / "domain.lp"


def test_every_line_of_the_program_is_located_in_its_file() -> None:
    sources = (
        Source(Path("one.lp"), "a.\nb.\n"),
        Source(Path("two.lp"), ""),
        Source(Path("three.lp"), "c.\n\nd."),
    )
    program = Program(sources)
    for source in sources:
        for number, words in enumerate(source.text.split("\n"), 1):
            if words:
                line = program.text.split("\n").index(words) + 1
                assert program.locate(line) == (source.path, number)


def test_included_files_come_first_and_once(tmp_path: Path) -> None:
    path = write(tmp_path, domain='#include "a.lp".\n#include "b.lp".\nc.', a='#include "b.lp".\na.', b="b.")
    assert [source.path.name for source in read_sources(path, tmp_path)] == ["b.lp", "a.lp", "domain.lp"]
    path = write(tmp_path, domain='x. #include\n "a.lp".\ny.', a="a.")
    assert read_sources(path, tmp_path)[-1].text.split("\n")[2] == "y.", "lines keep their numbers"


def test_an_include_in_a_comment_or_a_string_is_none(tmp_path: Path) -> None:
    text = 'a("#include"). % #include "no.lp".\n%* #include "no.lp". %* nested *% #include "no.lp". *%\n'
    assert len(read_sources(write(tmp_path, domain=text), tmp_path)) == 1


@pytest.mark.parametrize("include", ['#include %* *% "a.lp".', "#include <a>.", "#include a.", '#include "a.lp"'])
def test_an_include_that_cannot_be_checked_is_refused(tmp_path: Path, include: str) -> None:
    path = write(tmp_path, domain=f"x.\n{include}\n", a="a.")
    with pytest.raises(DomainError, match=r'domain\.lp:2: unreadable #include; write it as #include "file\.lp"\.'):
        read_sources(path, tmp_path)


def test_an_include_may_not_leave_the_folder_by_a_link(tmp_path: Path) -> None:
    folder = tmp_path / "domain"
    folder.mkdir()
    (tmp_path / "secret.lp").write_text("a.", encoding="utf-8")
    (folder / "link.lp").symlink_to(tmp_path / "secret.lp")
    with pytest.raises(DomainError, match=r"domain\.lp:1: cannot include 'link\.lp'"):
        read_sources(write(folder, domain='#include "link.lp".'), tmp_path / "encodings")


def test_a_byte_order_mark_is_skipped(tmp_path: Path) -> None:
    (tmp_path / "domain.lp").write_bytes(b"\xef\xbb\xbfa.")
    assert read_sources(tmp_path / "domain.lp", tmp_path)[0].text == "a."


def test_comments_and_strings_are_blanked_out_in_place_and_an_open_comment_is_found() -> None:
    text = 'a("x%y\\"z"). % b "\nc. %* d %* e *% " *% f("g).'
    code = blanked(text)
    assert len(code) == len(text)
    assert code.split() == ["a(", ").", "c.", 'f("g).']
    assert code.index("c.") == text.index("c.")
    assert open_comment("a. %* b %* c *%") == 3
    assert open_comment("a. %* b *% % %*") is None
