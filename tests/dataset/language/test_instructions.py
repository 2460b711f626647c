"""An instruction means its task, by the text alone, in every shipped domain and language."""

from __future__ import annotations

import doctest
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

import prag_asp.dataset.language
from prag_asp import QueryError, Task, TaskSpace, load_domain, parse_atom, shipped_domains
from prag_asp.dataset.language import Instructions, InstructionWriter, context_of, instruction_writer_of
from prag_asp.dataset.language.instruction_writer import is_stated
from prag_asp.grammar.reader import GrammarReader, PlainSentence
from prag_asp.task import FrozenDict
from tests.chance import Chance
from tests.dataset.language.twins import shipped, space_of, task_of, twins, writer

SPOKEN = [*((name, "en") for name in shipped_domains()), *((name, "de") for name in ("prag", "tabletop", "household"))]


def space_at(folder: str, length: int) -> TaskSpace:
    return TaskSpace(load_domain(folder), length)


def tasks_of(name: str, number: int, seed: int) -> list[Task]:
    return list(space_of(name, 6 if name == "two_arms" else 4).sample(number, seed=seed))


def assert_read_back(reader: InstructionWriter, task: Task, words: Instructions) -> None:
    assert reader.read(task, words.default).actions == task.actions
    exact = reader.read(task, words.exact)
    assert exact.actions == task.actions
    for aims, subgoal in zip(exact.aims, task.subgoals, strict=True):
        assert aims.items() <= subgoal.items()
    goal = reader.read(task, words.vague)
    assert goal.goal == reader.goal(task) and not goal.actions
    for number, (action, text) in enumerate(zip(task.actions, words.subgoals, strict=True)):
        assert reader.read(context_of(task, number), text).actions == (action,)


@pytest.mark.parametrize(("name", "language"), SPOKEN)
def test_every_instruction_is_read_back_to_its_task(name: str, language: str, chance: Chance) -> None:
    other = instruction_writer_of(shipped(name), language)  # the text alone goes from one to the other
    for number, task in enumerate(tasks_of(name, chance.examples(12), chance.seed(4))):
        assert_read_back(other, task, writer(name, language).instructions(task, seed=number))


def test_what_little_tells_apart_is_read_back_too(chance: Chance) -> None:
    writer = instruction_writer_of(twins().domain)
    for number, task in enumerate(twins().sample(chance.examples(30), seed=chance.seed(5))):
        assert_read_back(writer, task, writer.instructions(task, seed=number))


STACKED = ("pick(panda,can_1,table_1)", "insert(panda,can_1,bin_1)", "pick(panda,cube_1,table_1)")


def test_the_levels_say_what_they_are_for() -> None:
    words = writer("tabletop").instructions(task_of("tabletop", *STACKED), seed=0)
    assert words == Instructions(
        vague="See to it that the gripper is holding the red cube and that the can is in the bin.",
        default="Take the can from the table. After that, put it into the bin. Then grab the red cube from the table.",
        exact="First, pick up the can from the table. "
        "Second, place the can in the bin. "
        "Third, pick up the red cube from the table.",
        subgoals=("Pick up the can from the table.", "Put the can into the bin.", "Take the red cube from the table."),
    )


def test_an_action_that_restores_a_state_is_described_so() -> None:
    task = task_of("tabletop", "pick(panda,can_1,table_1)", "insert(panda,can_1,bin_1)", "pick(panda,can_1,bin_1)")
    put = task_of("tabletop", *map(str, task.actions), "insert(panda,can_1,bin_1)")
    words = [writer("tabletop").instructions(put, seed=seed) for seed in range(6)]
    assert all(each.default.count("back") == 1 and "back in" in each.subgoals[3] for each in words)
    again = task_of("kitchen", *["open(panda,drawer_1)", "close(panda,drawer_1)"] * 2)
    text = writer("kitchen").instructions(again).default
    assert text.count("again") == 3 and not text.casefold().startswith("open the drawer again")
    assert writer("kitchen").read(again, text).actions == again.actions
    assert writer("tabletop").read(put, words[0].default).actions == put.actions


def test_an_action_whose_facts_already_hold_is_described_as_a_repetition() -> None:
    carried = "transform(panda,can_1,crate_1)", "move(panda,can_1,crate_1)"
    task = task_of("prag", *carried, "rotate(panda,can_1,straight)")
    assert writer("prag").instructions(task).default.count("again") == 1
    turned = task_of("prag", *["rotate(panda,can_1,straight)"] * 2)
    assert writer("prag").instructions(turned).default.count("to the 0-degree position again") == 1
    assert writer("prag").read(turned, writer("prag").instructions(turned).default).actions == turned.actions


def test_facts_of_one_thing_are_merged_and_several_are_listed() -> None:
    task = task_of("tabletop", "pick(panda,can_1,table_1)", "place(panda,can_1,left_of,bin_1)", *STACKED[2:])
    words = writer("tabletop").instructions(task)
    assert "on the table to the left of the bin" in words.exact
    assert_read_back(writer("tabletop"), task, words)
    three = task_of("tabletop", *STACKED[:2], "pick(panda,brick_1,table_1)", "stack(panda,brick_1,brick_2)", STACKED[2])
    assert ", and " in writer("tabletop").instructions(three).vague


def test_a_phrase_that_names_the_source_of_an_action_replaces_it() -> None:
    space = TaskSpace(load_domain("examples/dishes"), 2)
    task = space[space.index(["pick(panda,cup_1,sink_1)", "put(panda,cup_1,table_1)"])]
    state = {**task.initial, parse_atom("inside(cup_2,sink_1)"): False, parse_atom("on_top(cup_2,table_1)"): True}
    known = replace(task, initial=FrozenDict(state))
    words = instruction_writer_of(space.domain).instructions(known)
    assert words.subgoals[0] == "Pick up the cup in the sink." and "from" not in words.default
    assert instruction_writer_of(space.domain).read(known, words.default).actions == task.actions


def test_an_aim_that_the_sentence_of_the_action_states_is_not_repeated() -> None:
    turned = task_of("prag", "rotate(panda,can_1,straight)", "move(panda,can_1,crate_1)", "drop(panda,can_1)")
    for seed in range(6):
        assert "so that" not in writer("prag").instructions(turned, seed=seed).exact
    plan = "pick(left,bar_1,left_side) move(left,middle) move(right,middle) give(left,right,bar_1) move(left,left_side)"
    given = task_of("two_arms", *plan.split(), "move(right,right_side)", "place(right,bar_1,right_side)")
    exact = writer("two_arms").instructions(given).exact
    assert exact.count("so that") == 1 and "so that the right arm is holding it. Fifth" in exact
    washed = space_at("examples/dishes", 1)
    exact = instruction_writer_of(washed.domain).instructions(washed[washed.index(["wash(panda,cup_1)"])]).exact
    assert exact == "Wash cup 1."
    assert is_stated("it is closed", {"close", "the", "drawer"}, frozenset(["it", "is"]))
    assert not is_stated("it is not open", {"open", "the", "drawer"}, frozenset(["it", "is"]))
    assert is_stated("sie geöffnet ist", {"öffne", "die", "schublade"}, frozenset(["sie", "ist"]))
    assert is_stated("sie entfernt ist", {"entferne", "die", "dose"}, frozenset(["sie", "ist"]))
    assert not is_stated("sie entfernt ist", {"entlade", "die", "dose"}, frozenset(["sie", "ist"]))


def test_a_phrase_that_is_no_longer_true_says_so() -> None:
    space = space_at("examples/dishes", 2)
    task = space[space.index(["pick(panda,cup_1,table_1)", "put(panda,cup_1,sink_1)"])]
    state = {**task.initial, parse_atom("inside(cup_2,sink_1)"): True, parse_atom("on_top(cup_2,table_1)"): False}
    known = replace(task, initial=FrozenDict(state))
    writer = instruction_writer_of(space.domain)
    words = writer.instructions(known)
    assert words.exact.startswith("First, pick up the cup on the table")
    assert "Second, put the cup that was originally on the table" in words.exact
    assert "the cup that was originally on the table is in the sink" in words.vague
    assert_read_back(writer, known, words)


def test_facts_of_one_thing_share_their_subject_where_the_verb_comes_last() -> None:
    task = task_of("tabletop", "pick(panda,can_1,table_1)", "place(panda,can_1,behind,bin_1)")
    text = "Achte darauf, dass die Dose auf dem Tisch ist und hinter der Kiste ist."
    goal = writer("tabletop", "de").read(task, text).goal
    assert set(map(str, goal)) == {"behind(can_1,bin_1)", "on_top(can_1,table_1)"}
    on_table, on_cube = parse_atom("on_top(can_1,table_1)"), parse_atom("on_top(can_1,cube_1)")
    moved = replace(task, initial=FrozenDict({**task.initial, on_table: False, on_cube: True}))
    assert text.split("dass")[1] in writer("tabletop", "de").instructions(moved).vague


def test_some_sentences_are_only_for_arguments_of_one_class() -> None:
    task = task_of("tabletop", "pick(panda,can_1,bin_1)", "insert(panda,can_1,tray_1)")
    words = [writer("tabletop", "de").instructions(task, seed=seed) for seed in range(4)]
    assert all("aus der Kiste" in each.default and "Tablett" in each.default for each in words)
    assert all("auf das Tablett" in each.default or "auf dem Tablett" in each.default for each in words)
    plan = "open(panda,drawer_1) approach(panda,apple_1,drawer_1) grasp(panda,apple_1) move(panda,apple_1,table_1)"
    fetch = task_of("kitchen", *plan.split(), "drop(panda,apple_1)", "withdraw(panda,apple_1)", "close(panda,drawer_1)")
    assert "has been brought to the table" in writer("kitchen").instructions(fetch).vague


def test_names_of_several_words_are_spelled_as_words() -> None:
    text = """
    class((robot; redCube; shelfBoard)). entity(arm1, robot). entity((redCube1; redCube12), redCube).
    entity((shelfBoard1; left_shelfBoard), shelfBoard).
    fluent(lies(O,P)) :- is_a(O,redCube), is_a(P,shelfBoard).
    action(pickUp(R,O,P)) :- is_a(R,robot), fluent(lies(O,P)).
    action(put(R,O,P)) :- is_a(R,robot), fluent(lies(O,P)).
    postcondition(pickUp(R,O,P), lies(O,P), false) :- action(pickUp(R,O,P)).
    postcondition(put(R,O,P), lies(O,P), true) :- action(put(R,O,P)).
    """
    space = TaskSpace(load_domain(text=text), 2)
    writer = instruction_writer_of(space.domain)
    task = space[space.index(["pickUp(arm1,redCube1,shelfBoard1)", "put(arm1,redCube1,left_shelfBoard)"])]
    words = writer.instructions(task)
    assert words.subgoals == (
        "Pick up red cube 1 from the left shelf board.",
        "Bring red cube 1 to shelf board 1.",
    )
    assert words.vague.endswith("red cube 1 lies at shelf board 1.")
    for task in space:
        assert_read_back(writer, task, writer.instructions(task))


def test_the_example_in_pddl_has_sentences() -> None:
    folder = Path("examples/pddl")
    space = TaskSpace(load_domain(folder / "domain.pddl", folder / "problem.pddl"), 8)
    writer = instruction_writer_of(space.domain)
    task = next(iter(space))
    words = writer.instructions(task)
    assert words.subgoals[0] == "Go from room hall to room store."
    assert "with hand left. Third" in words.exact, "pick up says already what the hand is holding"
    assert "pick up parcel p1 from room store" in words.default.casefold() and "up it" not in words.default
    assert "lies at room office" in words.vague
    assert_read_back(writer, task, words)


def test_an_object_is_brought_to_a_place_of_an_unknown_kind() -> None:
    text = """
    class((robot; food; spot)). entity(panda, robot). entity(cake, food). entity((left; right), spot).
    fluent(stored(O,P)) :- is_a(O,food), is_a(P,spot).
    action((put(R,O,P); pick(R,O,P))) :- is_a(R,robot), fluent(stored(O,P)).
    postcondition(put(R,O,P), stored(O,P), true) :- action(put(R,O,P)).
    postcondition(pick(R,O,P), stored(O,P), false) :- action(pick(R,O,P)).
    """
    space = TaskSpace(load_domain(text=text), 3)
    plan = [f"{name}(panda,cake,left)" for name in ("put", "pick", "put")]
    words = instruction_writer_of(space.domain).instructions(space[space.index(plan)])
    assert words.subgoals[0] == "Bring the food to spot left."


def test_an_arm_is_a_pronoun_only_where_no_other_phrase_precedes() -> None:
    given = "move(left,middle) move(right,middle) give(left,right,bar_1) move(left,left_side) move(right,right_side)"
    task = task_of("two_arms", *given.split(), "move(right,middle)")
    for seed in range(6):
        words = writer("two_arms").instructions(task, seed=seed)
        assert "from the left arm to the right arm" in words.default
        assert "the right arm is over the middle zone and holding the red bar" in words.vague
        assert_read_back(writer("two_arms"), task, words)


def test_german_has_its_genders_and_cases() -> None:
    words = writer("tabletop", "de").instructions(task_of("tabletop", *STACKED), seed=1)
    assert "die Dose" in words.default and "den roten Würfel" in words.default and "sie in die Kiste" in words.default
    assert "und die Dose in der Kiste ist" in words.vague and words.exact.startswith("Erstens: ")


def test_a_thing_goes_by_what_tells_it_from_the_others() -> None:
    words = writer("prag").instructions(task_of("prag", "grasp(panda,apple_1)", "drop(panda,apple_1)"))
    assert all("the red apple" in text for text in (words.default, words.exact, *words.subgoals))
    words = writer("prag").instructions(task_of("prag", "grasp(panda,box_1)", "drop(panda,box_1)"))
    assert all("the box" in text for text in (words.default, words.exact, *words.subgoals))


def test_seeds_draw_several_phrasings_and_each_always_the_same() -> None:
    task, again = task_of("tabletop", *STACKED), instruction_writer_of(shipped("tabletop"))
    words = [writer("tabletop").instructions(task, seed=seed) for seed in range(12)]
    assert words == [again.instructions(task, seed=seed) for seed in reversed(range(12))][::-1]
    assert len({each.default for each in words}) > 6 and len({each.vague for each in words}) > 2
    assert max(Counter(each.subgoals[0] for each in words).values()) < 10


def test_states_need_not_be_those_of_the_space_nor_in_its_order() -> None:
    task = task_of("tabletop", *STACKED)
    initial = dict(reversed(task.initial.items()))
    same = replace(task, initial=initial, states=tuple(map(dict, task.states)), entities=dict(task.entities))
    assert writer("tabletop").instructions(same, seed=3) == writer("tabletop").instructions(task, seed=3)


def test_a_task_without_actions_is_told_in_no_words() -> None:
    (task,) = space_of("tabletop", 0)
    assert writer("tabletop").instructions(task) == Instructions("", "", "", ())
    assert writer("tabletop").read(task, "").actions == ()


@pytest.mark.parametrize(
    ("name", "language", "words"),
    [
        ("tabletop", "fr", "tabletop has no sentences in 'fr'; it has those in de, en"),
        ("hanoi", "de", "hanoi has no sentences in 'de'; write its sentences under .language.de.actions., or use en"),
    ],
)
def test_a_language_that_a_domain_has_no_sentences_in_is_refused(name: str, language: str, words: str) -> None:
    with pytest.raises(QueryError, match=words):
        instruction_writer_of(shipped(name), language)


def test_any_domain_has_english_sentences_by_the_names_that_it_has() -> None:
    text = """
    #include "rules/closed_world.lp".
    class(lamp).   entity((hall; attic), lamp).
    fluent(lit(L)) :- entity(L,lamp).   fluent(wired(L,M)) :- entity(L,lamp), entity(M,lamp), L < M.   fluent(dark).
    action(switch_on(L)) :- entity(L,lamp).   action(wire(L,M)) :- fluent(wired(L,M)).   action(wait).
    postcondition(switch_on(L), lit(L), true) :- action(switch_on(L)).
    postcondition(wire(L,M), wired(L,M), true) :- action(wire(L,M)).
    postcondition(wait, dark, true).
    """
    domain = load_domain(text=text)
    writer = instruction_writer_of(domain)
    for task in TaskSpace(domain, 2):
        assert_read_back(writer, task, writer.instructions(task))
    space = TaskSpace(domain, 3)
    task = space[space.index(["switch_on(attic)", "wire(attic,hall)", "wait"])]
    words = writer.instructions(task)
    assert words.subgoals == ("Switch on lamp attic.", "Wire lamp attic.", "Wait.")
    assert "wired holds of lamp attic and lamp hall" in words.vague and words.named == ("attic", "hall")


def spelled(sentences: Sequence[PlainSentence]) -> str:
    """Return the first of some default sentences with the numbers of its arguments."""
    template = sentences[0].template
    return template.fill([f"<{slot.argument}>" for slot in template.slots])


def test_what_an_action_brings_about_leads_from_and_to_in_the_sentences_that_any_domain_has() -> None:
    said = {}
    for name in ("hanoi", "blocks", "tabletop", "two_arms"):
        domain = shipped(name)
        for (action, _), sentences in GrammarReader(domain.settings, domain.facts, "en").plain().items():
            said[name, action] = spelled(sentences)
    assert said["hanoi", "move"] == "move <0> from <1> onto <2>" and said["blocks", "unstack"] == "unstack <0> from <1>"
    assert said["tabletop", "pick"] == "take <1> out of <2>" and said["tabletop", "insert"] == "insert <1> into <2>"
    assert said["tabletop", "place"].startswith("place <1> ") and said["tabletop", "place"].endswith("<3>")
    assert said["two_arms", "give"] == "give <0>, <1> and <2>"
    assert said["two_arms", "pick"] == "take <1> from <2> with <0>"


def test_what_is_moved_is_named_even_if_it_is_the_only_one_of_its_kind() -> None:
    text = """
    class((robot; food; spot)). entity(panda, robot). entity(cake, food). entity((table; shelf), spot).
    fluent(lies(O,P)) :- is_a(O,food), is_a(P,spot).   fluent(held(R,O)) :- is_a(R,robot), is_a(O,food).
    action((pick(R,O,P); put(R,O,P))) :- fluent(held(R,O)), fluent(lies(O,P)).
    postcondition(pick(R,O,P), held(R,O), true) :- action(pick(R,O,P)).
    postcondition(pick(R,O,P), lies(O,P), false) :- action(pick(R,O,P)).
    postcondition(put(R,O,P), held(R,O), false) :- action(put(R,O,P)).
    postcondition(put(R,O,P), lies(O,P), true) :- action(put(R,O,P)).
    """
    domain = load_domain(text=text)
    plain = GrammarReader(domain.settings, domain.facts, "en").plain()
    said = {name: spelled(each) for (name, _), each in plain.items()}
    assert said == {"pick": "take <1> from <2>", "put": "bring <1> to <2>"}
    writer = instruction_writer_of(domain)
    for task in TaskSpace(domain, 2):
        assert_read_back(writer, task, writer.instructions(task))


def test_a_robot_that_moves_itself_goes_from_a_place_to_another() -> None:
    text = """
    class((room; robot)). entity((hall; kitchen), room). entity(rob, robot). entity(lamp, room).
    fluent((at(R,X); lit(X))) :- is_a(R,robot), is_a(X,room).
    action(go(R,X,Y)) :- fluent(at(R,X)), fluent(at(R,Y)), X != Y.
    precondition(go(R,X,Y), at(R,X), true) :- action(go(R,X,Y)).
    postcondition(go(R,X,Y), at(R,X), false; go(R,X,Y), at(R,Y), true) :- action(go(R,X,Y)).
    action(light(rob,lamp)). postcondition(light(rob,lamp), lit(lamp), true).
    """
    domain = load_domain(text=text)
    plain = GrammarReader(domain.settings, domain.facts, "en").plain()
    said = {name: spelled(each) for (name, _), each in plain.items()}
    assert said == {"go": "go from <1> to <2>", "light": "light <1>"}
    writer = instruction_writer_of(domain)
    for task in TaskSpace(domain, 2):
        assert_read_back(writer, task, writer.instructions(task))


def test_a_relation_among_the_arguments_is_said_once_in_default_sentences() -> None:
    domain = shipped("tabletop")
    sentences = GrammarReader(domain.settings, domain.facts, "en").plain()["place", 4]
    said = {spelled([each]) for each in sentences}
    beside = {f"place <1> to the {side} of <3>" for side in ("left", "right")}
    assert said >= {*beside, "place <1> in front of <3>", "place <1> behind <3>"}
    assert not any("<2>" in each for each in said)


def test_a_pronoun_does_not_say_where_an_object_is() -> None:
    plan = "open(panda,drawer_1) approach(panda,apple_1,drawer_1) grasp(panda,apple_1) move(panda,apple_1,table_1)"
    task = task_of("kitchen", *plan.split(), "drop(panda,apple_1)", "withdraw(panda,apple_1)", "close(panda,drawer_1)")
    words = [writer("kitchen").instructions(task, seed=seed) for seed in range(6)]
    assert all("the red apple in it" in each.default and "at it" not in each.default for each in words)


def test_where_there_is_one_robot_nobody_says_which() -> None:
    space = space_of("kitchen", 7)
    fetch = "open(panda,drawer_1) approach(panda,apple_1,drawer_1) grasp(panda,apple_1) move(panda,apple_1,table_1)"
    task = space[
        space.index([*fetch.split(), "drop(panda,apple_1)", "withdraw(panda,apple_1)", "close(panda,drawer_1)"])
    ]
    for seed in range(6):
        assert "the robot" not in writer("kitchen").instructions(task, seed=seed).exact
    space = space_of("two_arms", 6)
    assert all("arm" in text for text in writer("two_arms").instructions(space[0]).subgoals)


def test_pictures_have_captions_in_the_same_words() -> None:
    captions = writer("tabletop").captions(task_of("tabletop", *STACKED))
    assert captions == [
        ("start", "the can is on the table, the red cube is on the table"),
        ("1. pick up the can from the table", "the gripper is holding the can"),
        ("2. put the can into the bin", "the can is in the bin"),
        ("3. pick up the red cube from the table", "the gripper is holding the red cube"),
    ]


def test_the_example_of_the_room_is_right() -> None:
    assert doctest.testmod(prag_asp.dataset.language) == (0, 4)


def test_a_task_of_another_domain_is_told_in_one_line() -> None:
    task = task_of("tabletop", *STACKED)
    with pytest.raises(QueryError, match=r"^prag has no entity .*; did you mean .*\?$"):
        writer("prag").instructions(task)
    other = replace(task, actions=(parse_atom("fly(panda,can_1)"), *task.actions[1:]))
    with pytest.raises(
        QueryError, match=r"^fly\(panda,can_1\) is not an action of tabletop; give tasks of that domain$"
    ):
        writer("tabletop").instructions(other)
    assert writer("tabletop").captions(other)[1][0] == "1. fly panda can 1"


def test_a_single_action_has_no_number_and_furniture_and_arms_become_pronouns() -> None:
    kitchen, arms = TaskSpace(shipped("kitchen"), 2), TaskSpace(shipped("two_arms"), 2)
    (opened,) = (task for task in TaskSpace(shipped("kitchen"), 1) if task.actions[0].arguments[1] == "drawer_1")
    exact = writer("kitchen", "en").instructions(opened, 1).exact
    assert exact == "Open the drawer."
    stated = writer("kitchen", "en").read(opened, "Open the drawer, so that it is open.")
    assert stated.aims == ({parse_atom("open(drawer_1)"): True},)
    plan = "open(panda,drawer_1) close(panda,drawer_1)"
    again = next(task for task in kitchen if str(task) == plan)
    assert "close it again" in writer("kitchen", "en").instructions(again, 0).default
    moved = next(task for task in arms if str(task) == "move(left,middle) move(left,left_side)")
    assert "it back to the left zone" in writer("two_arms", "en").instructions(moved, 0).default


def test_facts_about_different_things_are_clauses_with_a_comma_or_share_their_predicate() -> None:
    kitchen = task_of("kitchen", "open(panda,drawer_1)", "open(panda,cupboard_1)")
    for seed in range(4):
        words = writer("kitchen").instructions(kitchen, seed)
        assert "that both the cupboard and the drawer are open." in words.vague
        assert_read_back(writer("kitchen"), kitchen, words)
    held = writer("tabletop").instructions(task_of("tabletop", *STACKED))
    assert "is holding the red cube and that the can is in" in held.vague
    plan = "pick(panda,can_1,table_1) insert(panda,can_1,bin_1) pick(panda,cube_1,table_1) insert(panda,cube_1,bin_1)"
    both = task_of("tabletop", *plan.split())
    german = writer("tabletop", "de").instructions(both)
    assert "dass sowohl die Dose als auch der rote Würfel in der Kiste sind." in german.vague
    assert_read_back(writer("tabletop", "de"), both, german)


def test_a_predicate_of_both_things_is_read_only_where_it_is_one_of_each() -> None:
    task = task_of("kitchen", "open(panda,drawer_1)", "open(panda,cupboard_1)")
    with pytest.raises(QueryError, match="is not a sentence of kitchen"):
        writer("kitchen").read(task, "Make sure that both the cupboard and the drawer are red.")


def test_an_object_is_put_into_or_on_a_place_not_brought_to_it() -> None:
    for folder, plan in (
        ("examples/desk", "take(panda,box_1,desk_1) put(panda,box_1,tray_1)"),
        ("examples/dishes", "pick(panda,cup_1,rack_1) put(panda,cup_1,sink_1)"),
        ("examples/warehouse", "pick(panda,rod_1,shelf_1) put(panda,rod_1,table_1)"),
    ):
        space = space_at(folder, 2)
        put = instruction_writer_of(space.domain).instructions(space[space.index(plan.split())]).subgoals[1]
        assert "put" in put.casefold() and ("into the" in put or "on the" in put) and "onto" not in put


def test_an_object_comes_off_another_and_a_particle_precedes_all_but_pronouns() -> None:
    plan = "pick(panda,can_1,brick_1) stack(panda,can_1,brick_2) pick(panda,can_1,brick_2)"
    for seed in range(6):
        words = writer("tabletop").instructions(task_of("tabletop", *plan.split()), seed)
        assert "off the" in words.subgoals[0] or words.subgoals[0].startswith("Remove the can from")
        assert "take the can from" not in words.default.casefold()
    stacked = task_of("blocks", "pick_up(a)", "put_down(a)", "pick_up(a)")
    texts = [writer("blocks").instructions(stacked, seed) for seed in range(8)]
    assert any("Pick up block A" in each.default for each in texts)
    assert any("pick it up" in each.default for each in texts)
    assert not any("up it" in each.default or "block A up" in each.exact + each.default for each in texts)
    assert writer("blocks").read(stacked, "Pick block A up.").actions == stacked.actions[:1], "both orders are read"


def test_an_exact_instruction_does_not_say_that_what_is_taken_is_held() -> None:
    for name, language, verb in (
        ("tabletop", "en", "holding"),
        ("tabletop", "de", "hält"),
        ("blocks", "en", "holding"),
    ):
        for task in tasks_of(name, 6, 1):
            assert verb not in writer(name, language).instructions(task).exact


def test_it_in_an_aim_is_not_one_of_several_things_of_the_action(tmp_path: Path) -> None:
    text = """
    class((food; spice; arm)). entity(cake, food). entity(mint, spice). entity(rob, arm).
    fluent((sweet(O); cut(O))) :- is_a(O,food).
    action((dress(O,S); slice(O))) :- is_a(O,food), is_a(S,spice).
    postcondition(dress(O,S), sweet(O), true) :- action(dress(O,S)).
    postcondition(slice(O), cut(O), true) :- action(slice(O)).
    """
    tables = tmp_path / "domain.toml"
    tables.write_text('[language]\ndress = "dress {0} with {1}"\nslice = "slice {0}"\n')
    space = TaskSpace(load_domain(text=text, settings=tables), 2)
    exact = (
        instruction_writer_of(space.domain).instructions(space[space.index(["dress(cake,mint)", "slice(cake)"])]).exact
    )
    assert "dress the food with the spice, so that the food is sweet." in exact
    assert "slice the food, so that it is cut." in exact


def test_what_stands_on_the_table_is_put_down_there() -> None:
    space = TaskSpace(load_domain("examples/own_predicates"), 2)
    plan = ["pick(panda,camera_1,table_1)", "set(panda,camera_1,brick_1,cup_2)"]
    words = instruction_writer_of(space.domain).instructions(space[space.index(plan)])
    assert "on the table between the brick and the blue cup." in words.exact and "so that" not in words.exact


def test_the_motions_of_prag_have_verbs_and_angles_of_their_own() -> None:
    carried = "transform(panda,can_1,bowl_1)", "follow(panda,can_1,crate_1)"
    task = task_of("prag", *carried, "rotate(panda,can_1,quarter_turn)", "move(panda,can_1,bowl_1)")
    for seed in range(4):
        first, second, third, fourth = writer("prag").instructions(task, seed).subgoals
        assert "along the preset path" in first and "along the guide" in second and "to the 90-degree position" in third
        assert "along" not in fourth
        assert "the can has been brought to the bowl" in writer("prag").instructions(task, seed).vague


def test_an_arm_is_moved_and_used() -> None:
    plan = "pick(left,bar_1,middle) move(left,left_side) place(left,bar_1,left_side)"
    task = task_of("two_arms", *plan.split())
    for seed in range(6):
        words = writer("two_arms").instructions(task, seed)
        assert all(each.startswith("Use the left arm to ") for each in (words.subgoals[0], words.subgoals[2]))
        assert "use it to" in words.default.casefold() and "bring" not in words.default
        assert_read_back(writer("two_arms"), task, words)


def test_a_place_precedes_another_predicate_of_the_same_thing() -> None:
    space = TaskSpace(load_domain("examples/own_predicates"), 2)
    task = space[space.index(["pick(panda,camera_1,tray_1)", "aim(panda,camera_1,cup_2)"])]
    words = instruction_writer_of(space.domain).instructions(task)
    assert "the camera is on the table and aimed at the blue cup" in words.vague
    assert_read_back(instruction_writer_of(space.domain), task, words)
