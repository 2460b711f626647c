"""The pages say nothing that is not so: commands and sessions print what they show, pieces of domains fit."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain, load_scene
from tests.docs.pages import DOCS, FENCE, FRESH, PAGES, ROOT, Block, blocks, prepare, run_page
from tests.sharing import logic_shared
from tests.warm import warm_commands

BLOCKS = [block for page in PAGES for block in blocks(page)]
DISHES = ROOT / "examples" / "dishes"

INSTALL = "python3 -m venv .venv && .venv/bin/pip install"
SETUP = {
    f"{INSTALL} . && .venv/bin/prag-asp sample tabletop --length 5 --count 3 --seed 7",
    f"{INSTALL} -e '.[test]' && .venv/bin/pytest",
    ". .venv/bin/activate",
    ".venv/bin/pip install '.[pictures]'",
    ".venv/bin/pip install '.[meshes]'",
    ".venv/bin/pip install '.[sharp]'",
    ".venv/bin/pip install '.[datasets]'",
    ".venv/bin/pip install '.[formats]'",
    ".venv/bin/pip install '.[ray]'",
    ".venv/bin/pip install '.[rl]'",
    ".venv/bin/pip install 'minari[hdf5]'",
    ".venv/bin/pip install datasets pandas duckdb",
    f"{INSTALL} '.[formats]' datasets pandas",
    ".venv/bin/pip install -e '.[docs]' && .venv/bin/mkdocs build --strict",
    f"{INSTALL} '.[learning]'",
    ".venv/bin/python benchmarks/learning/oracle.py",
    ".venv/bin/python benchmarks/learning/chained.py",
    ".venv/bin/python benchmarks/learning/composition.py",
    ".venv/bin/python benchmarks/learning/plain.py",
    ".venv/bin/python benchmarks/learning/standing.py",
    ".venv/bin/python benchmarks/learning/rates.py",
    ".venv/bin/python benchmarks/learning/beside.py",
    ".venv/bin/python benchmarks/learning/lasting.py",
    ".venv/bin/python benchmarks/learning/curricula.py",
    "python -m tests.fuzz --count 10000 --seed 7",
    "prag-asp report dataset results/act results/oracle -o report.html",
    "prag-asp evaluate act/checkpoints/last/pretrained_model --data data --part test -o act_results",
}
"""Commands that need a fresh machine, in what the tests run already, or hours; tests/rl/test_learning.py shortens."""

SHORTENED = DOCS / "guides" / "train_and_evaluate.md"
"""A page whose commands take minutes or a GPU; tests/rl/test_train_and_evaluate.py runs them, shortened."""

ON_A_GPU = DOCS / "guides" / "other_programs.md"
"""A page whose commands train with another program on a GPU."""


def name_of(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.fixture(scope="module", autouse=True)
def logic() -> Iterator[None]:
    """Compute once what logic says of a domain in the sessions of Python."""
    with logic_shared():
        yield


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return a cache that the pages share, as those of a reader do."""
    return str(tmp_path_factory.mktemp("cache"))


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page) and page not in FRESH], ids=name_of)
def test_the_examples_of_a_page_print_what_it_shows(
    page: Path, tmp_path: Path, cache: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PRAG_ASP_CACHE", cache)
    prepare(tmp_path)
    wrong = [str(example) for example in run_page(page, tmp_path, warm_commands()) if not example.right]
    assert not wrong, "\n\n".join(["write them anew: python -m tests.docs.pages", *wrong])


def test_no_block_escapes_the_tests() -> None:
    known = {"console", "pycon", "prolog", "toml", "sh", "text"}
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert len(re.findall(r"^[ >]*(?:```|~~~)", text, re.MULTILINE)) == 2 * len(FENCE.findall(text)), page
    assert [str(block) for block in BLOCKS if block.language not in known and not block.title] == []
    apart = [block for block in BLOCKS if block.language == "sh" and block.page not in (SHORTENED, ON_A_GPU)]
    assert {line for block in apart for line in block.text.splitlines()} <= SETUP


def test_sessions_and_examples_import_public_names_alone() -> None:
    texts = [block.text for block in BLOCKS if block.language == "pycon"]
    texts += [path.read_text(encoding="utf-8") for path in (ROOT / "examples").rglob("*.py")]
    imported = {module for text in texts for module in re.findall(r"(?:from|import) (prag_asp[\w.]*)", text)}
    assert imported == {
        "prag_asp",
        "prag_asp.analysis",
        "prag_asp.analysis.covering",
        "prag_asp.audit",
        "prag_asp.dataset",
        "prag_asp.evaluation",
        "prag_asp.evaluation.lerobot_view",
        "prag_asp.pddl",
        "prag_asp.physics",
        "prag_asp.report",
        "prag_asp.rl",
        "prag_asp.rl.wrappers",
        "prag_asp.similarity",
    }


def test_a_block_with_the_name_of_a_file_of_the_repository_is_a_piece_of_it() -> None:
    shown = [block for block in BLOCKS if block.title and (ROOT / block.title).exists()]
    assert shown
    for block in shown:
        text = (ROOT / block.title).read_text(encoding="utf-8")
        assert block.text.startswith("--8<-- ") or f"\n{block.text}" in f"\n{text}", block


@pytest.fixture
def dishes(tmp_path: Path) -> Path:
    return Path(shutil.copytree(DISHES, tmp_path / "dishes"))


@pytest.mark.parametrize("piece", [each for each in BLOCKS if each.language == "prolog" and not each.title], ids=str)
def test_a_piece_of_a_program_fits_into_the_example(piece: Block, dishes: Path) -> None:
    with (dishes / "domain.lp").open("a", encoding="utf-8") as text:
        text.write(f"#program base.\n{piece.text}")
    domain = load_domain(dishes)
    by_engine = {engine: TaskSpace(domain, 3, engine=engine) for engine in ("automaton", "clingo")}
    assert set(by_engine["automaton"].enumerate("plan")) == set(by_engine["clingo"].enumerate("plan"))
    assert 0 < by_engine["automaton"].count() == by_engine["clingo"].count()


@pytest.mark.parametrize("piece", [each for each in BLOCKS if each.language == "toml" and not each.title], ids=str)
def test_a_piece_of_a_scene_fits_into_the_example(piece: Block, dishes: Path) -> None:
    with (dishes / "domain.toml").open("a", encoding="utf-8") as text:
        text.write(f"\n{piece.text}")
    assert load_scene(load_domain(dishes)).workspace
