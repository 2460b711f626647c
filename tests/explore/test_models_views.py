"""The page of a program shows what clingo enumerates, and each of its views is a link."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from prag_asp import LimitReached, Limits, QueryError, answer_sets
from prag_asp.explore.programs.explored_program import ExploredProgram, Watch
from prag_asp.explore.programs.models_state import ModelsState, parse_models_query
from prag_asp.explore.programs.models_view import models_conflict_view, models_view
from prag_asp.explore.programs.program_pages import program_views
from prag_asp.stop_reason import StopKind, StopReason
from tests.chance import Chance
from tests.commands import ok, run
from tests.models.programs import answer_sets_by_clingo

MENU = """{ starter(soup; salad) } 1.
{ main(fish; beef; pasta) } = 1.
wine(white) :- main(fish).
wine(red) :- main(beef).
bread. { napkin }.
:- starter(soup), main(pasta).
#show starter/1. #show main/1. #show bread/0. #show drink(X) : wine(X).
"""


def explored(text: str = MENU, *, name: str = "text", limits: Limits | None = None, **how: bool) -> ExploredProgram:
    watch = Watch() if limits is None else Watch(limits)
    answers = answer_sets(text=text, progress=watch.look, **how)
    return ExploredProgram(name, answers, (name,), (), f"answer_sets({name!r})", watch)


def facets(some: Sequence[tuple[str, ...]], symbols: set[str]) -> set[str]:
    return {each for each in symbols if 0 < sum(each in shown for shown in some) < len(some)}


@pytest.mark.parametrize("project", [False, True])
def test_a_random_walk_shows_the_numbers_of_clingo(chance: Chance, project: bool) -> None:
    random, program = chance.generator(1), explored(project=project)
    expected = list(answer_sets_by_clingo(MENU, project=project).elements())
    for _ in range(chance.examples(2)):
        state, left = ModelsState(sort=random.choice(["name", "share", "significance"])), expected
        while True:
            view = models_view(program, state)
            assert parse_models_query(view.query) == state
            assert (view.total, view.count) == (str(len(expected)), str(len(left)))
            symbols = {symbol for shown in left for symbol in shown}
            assert {each.atom for each in view.facets} == facets(left, symbols)
            assert set(view.certain.atoms) == {each for each in symbols if all(each in shown for shown in left)}
            for facet in view.facets:
                having = [shown for shown in left if facet.atom in shown]
                lacking = [shown for shown in left if facet.atom not in shown]
                assert (facet.count, facet.excluded) == (str(len(having)), str(len(lacking)))
                before = len(view.facets)
                for each, some in ((facet.significance, having), (facet.significance_of_excluding, lacking)):
                    assert each is not None
                    assert Fraction(each.exact) == Fraction(before - len(facets(some, symbols)), before)
            if not view.facets:
                break
            facet = random.choice(view.facets)
            chosen = random.random() < 0.5
            state = parse_models_query(facet.choose if chosen else facet.exclude)
            left = [shown for shown in left if (facet.atom in shown) == chosen]
        assert [each.count for each in view.decisions][-1:] == ([view.count] if state.where else [])
        assert models_view(program, parse_models_query(view.undo)).query == replace(state, where=state.where[:-1]).query


def test_samples_are_those_of_the_command(tmp_path: Path) -> None:
    path = tmp_path / "menu.lp"
    path.write_text(MENU)
    program = replace(explored(name=str(path)), answers=answer_sets(path))
    view = models_view(program, ModelsState(("main(beef)",), seed=5))
    assert view.sample is not None and "main(beef)" in view.sample.atoms
    printed = [ok(*shlex.split(same.shell)[1:]) for same in view.same]
    assert printed[0].strip() == view.count
    assert printed[1].splitlines()[0].startswith("atom")
    assert tuple(printed[2].split()) == view.sample.atoms
    scope: dict[str, object] = {}
    exec(f"{view.same[0].python.rpartition(chr(10))[0]}\nnumber = found.count()", scope)
    assert str(scope["number"]) == view.count


def test_samples_are_uniform_among_what_is_left() -> None:
    program = explored()
    seen = Counter(
        view.sample.atoms
        for seed in range(300)
        if (view := models_view(program, ModelsState(("starter(soup)",), seed=seed))).sample
    )
    assert len(seen) == 2  # fish or beef, each with and without the napkin
    assert min(seen.values()) > 100


def test_where_nothing_is_left_the_lines_are_those_of_explain() -> None:
    program, state = explored(), ModelsState(("starter(soup)", "main(pasta)"))
    view = models_view(program, state)
    assert (view.count, view.facets, view.sample) == ("0", (), None)
    assert models_conflict_view(program, state).lines == (
        "<text>:6: :- starter(soup), main(pasta).", "<where>:1: starter(soup)", "<where>:2: main(pasta)",
    )  # fmt: skip
    with pytest.raises(QueryError, match="may be left"):
        models_conflict_view(program, ModelsState())


def test_a_program_without_answer_sets_is_explained() -> None:
    program = explored("{ a }. :- a. :- not a.")
    view = models_view(program, ModelsState(seed=1))
    assert (view.total, view.count, view.open) == ("0", "0", 0)
    assert len(models_conflict_view(program, ModelsState()).lines) == 2


def test_choices_do_not_change_the_optimum() -> None:
    program = explored("1 { a; b; c }. #minimize { 1,a : a; 1,b : b; 3,c : c }.", optimal=True)
    view = models_view(program, ModelsState())
    assert view.count == "2" and "the best value is 1" in view.notes[0]
    assert view.impossible.atoms == ("c",)
    assert models_conflict_view(program, ModelsState(("c",))).optimal


def test_facets_are_filtered_and_cut() -> None:
    program = explored("{ a(1..300); b(1..5) }.")
    view = models_view(program, ModelsState(("a(1)",)))
    assert (view.open, view.matching, len(view.facets), view.count) == (304, 304, 200, str(2**304))
    view = models_view(program, ModelsState(find="b("))
    assert (view.open, view.matching, [each.atom for each in view.facets]) == (305, 5, [f"b({k})" for k in range(1, 6)])


def test_facets_of_enumerated_programs_are_shown() -> None:
    program = explored("a | b :- c. a :- b. b :- a. { c; d }.")
    assert not program.answers.compile()
    assert models_view(program, ModelsState()).count == str(
        answer_sets(program.answers.given.program.sources[0]).count()
    )


def test_a_limit_is_told_in_the_page_and_choices_can_be_made() -> None:
    program = explored(limits=Limits(seconds=1e-9))
    view = models_view(program, ModelsState(("main(beef)",), find="soup"))
    assert (view.count, view.total, view.share) == ("", "", "")
    assert "the time limit of 1e-09 s was reached" in view.problem
    assert [(each.atom, each.count) for each in view.facets] == [("starter(soup)", "")]


def test_a_newer_request_ends_a_view() -> None:
    program = explored(limits=Limits(stop=lambda: StopReason(StopKind.CANCEL)))
    with pytest.raises(LimitReached):
        models_view(program, ModelsState())


@pytest.mark.parametrize(
    ("query", "problem"),
    [("where=fish", "no shown atom"), ("where=", "not a literal"), ("color=red", "no field of a link"),
     ("seed=-1", "seed"), ("sort=size", "no order of facets"), ("seed=1&seed=2", "at most once"),
     ("&".join(["find=a"] * 600), "500 fields")],
)  # fmt: skip
def test_wrong_links_get_one_line(query: str, problem: str) -> None:
    with pytest.raises(QueryError, match=problem) as error:
        program_views(explored())["models"]({"state": query})
    assert len(error.value.lines) == 1


def test_the_command_refuses_what_does_not_fit(tmp_path: Path) -> None:
    path = tmp_path / "menu.lp"
    path.write_text(MENU)
    for words, problem in (
        ((str(path), "--where", "main(beef"), "not a literal"),
        ((str(path), "--by", "plan"), "leave it out with --models"),
        ((str(path), "--engine", "ganak"), "choose auto, diagram, clingo"),
        ((str(path), "--optimal"), "optimises nothing"),
        (("-",), "standard input"),
    ):
        done = run("explore", "--models", *words)
        assert (done.returncode, done.stdout) == (2, "")
        assert problem in done.stderr and len(done.stderr.splitlines()) == 1
    assert "add --models" in run("explore", "blocks", "--length", "2", "--project").stderr
    assert "Missing option" in run("explore", "blocks").stderr
