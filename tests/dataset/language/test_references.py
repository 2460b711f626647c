"""No phrase fits two things that a picture shows: judged here by the facts and the colours themselves."""

from __future__ import annotations

import pytest

from prag_asp import Domain, QueryError, Scene, load_scene
from prag_asp.dataset.language import context_of, instruction_writer_of
from prag_asp.dataset.language.appearance import color_terms
from prag_asp.dataset.language.descriptions import Description
from prag_asp.scene.read.scene_reader import PALETTE
from prag_asp.task import State
from tests.chance import Chance
from tests.dataset.language.twins import SETTINGS, shipped, space_of, task_of, twins


def may_fit(what: Description, thing: str, domain: Domain, scene: Scene, state: State) -> bool:
    """Tell whether somebody could take a description for a thing, by what is not known to be otherwise."""
    if what.name:
        return what.name == thing
    kind = domain.facts.entity_names[thing]
    words = {kind.replace("_", " ")} | ({"cube"} if kind == "big" else set())
    if what.noun not in words:
        return False
    if what.color and thing in scene.colors and what.color not in color_terms(scene.colors[thing]):
        return False
    if what.size and (what.size == "large") != (kind == "big"):
        return False
    if what.place and (what.place == "left") != (scene.fixed[thing][1] < 0):
        return False
    return what.relation is None or state.get(what.relation.about(thing)) is not False


@pytest.mark.parametrize("name", ["twins", "tabletop", "kitchen"])
def test_a_description_fits_its_thing_and_no_other(name: str, chance: Chance) -> None:
    space = twins() if name == "twins" else space_of(name, 4)
    domain = space.domain
    lexicon, scene = instruction_writer_of(domain).lexicon, load_scene(domain)
    kinds = set[str]()
    for task in space.sample(chance.examples(20), seed=chance.seed(8)):
        for number in range(4):
            start = context_of(task, number)
            view = lexicon.view(start)
            for thing in view.context.entities:
                what = view.describe(thing)
                fitting = [each for each in view.context.entities if may_fit(what, each, domain, scene, start.state)]
                assert fitting == [thing], (what, str(task))
                kinds |= {key for key, value in what._asdict().items() if value}
    if name == "twins":
        assert kinds == {"noun", "color", "size", "place", "relation", "name"}


def test_a_shorter_description_is_taken_before_a_longer_one() -> None:
    space = twins()
    plan = ["pick(panda,cube_1,tray_1)", "put(panda,cube_1,tray_1)", "pick(panda,cube_2,tray_2)"]
    task = space[space.index([*plan, "put(panda,cube_2,tray_2)"])]
    told = instruction_writer_of(space.domain).instructions(task)
    assert "the small cube in the right tray" in told.default and "red" not in told.default
    assert "the cube held by the gripper" in told.subgoals[1] and "small" not in told.subgoals[1] and told.named == ()


def test_what_is_kept_of_other_states_is_said_only_where_it_means_the_same(chance: Chance) -> None:
    domain = twins().domain
    often = instruction_writer_of(domain)
    tasks = list(twins().sample(chance.examples(25), seed=chance.seed(9)))
    for task in tasks:
        often.instructions(task)
    told = [often.instructions(task) for task in reversed(tasks)]
    assert any("gripper" in subgoal for each in told for subgoal in each.subgoals)
    assert told == [instruction_writer_of(domain).instructions(task) for task in reversed(tasks)]


def test_things_that_nothing_visible_distinguishes_go_by_their_names() -> None:
    """Colours that pass for each other do not distinguish them either."""
    assert color_terms("#e8e2d6")["beige"] and color_terms("#e8e2d6")["white"] is False
    alike = SETTINGS.replace('ball_1 = "#d7263d"', 'ball_1 = "#e8e2d6"').replace("#2e86ab", "#e6dfd0")
    for settings, thing in ((SETTINGS, "cube_1"), (alike, "ball_1")):
        space = twins(settings).at(1)
        words = instruction_writer_of(space.domain).instructions(space[space.index([f"pick(panda,{thing},tray_1)"])])
        assert words.named == (thing,) and thing.replace("_", " ") in words.default


def test_the_colours_of_a_scene_that_gives_none_have_different_names() -> None:
    terms = [next(term for term, sure in color_terms(color).items() if sure) for color in PALETTE]
    assert terms == ["red", "blue", "yellow", "green", "purple", "pink", "turquoise", "brown"]


@pytest.mark.parametrize(
    ("color", "term"),
    [("#ff0000", "red"), ("#ffa500", "orange"), ("#ffd700", "yellow"), ("#808000", "green"), ("#87ceeb", "blue"),
     ("#ee82ee", "purple"), ("#ffc0cb", "pink"), ("#d2b48c", "beige"), ("#c0c0c0", "grey"), ("#000000", "black")],
)  # fmt: skip
def test_colours_are_called_what_people_call_them(color: str, term: str) -> None:
    assert color_terms(color)[term]


def test_things_go_by_the_colours_that_a_picture_shows_them_in() -> None:
    plan = "pick(panda,cube_1,table_1) insert(panda,cube_1,bin_1) pick(panda,cube_1,bin_1) insert(panda,cube_1,bin_1)"
    task = task_of("tabletop", *plan.split())
    painted = instruction_writer_of(shipped("tabletop"), colors={"cube_1": "#20a040"})
    assert "the green cube" in painted.instructions(task).default
    alike = instruction_writer_of(shipped("tabletop"), colors={"cube_1": "#2e86ab"})
    assert alike.instructions(task).named == ("cube_1",)
    with pytest.raises(QueryError, match="cube_9 = '#20a040' is not a colour of an entity; write one of tabletop"):
        instruction_writer_of(shipped("tabletop"), colors={"cube_9": "#20a040"})
