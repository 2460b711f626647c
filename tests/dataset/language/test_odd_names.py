"""Domains whose names are words of the language itself: what they say is read back all the same."""

from __future__ import annotations

import random

from prag_asp import DomainError, TaskSpace, load_domain
from prag_asp.dataset.language import context_of, instruction_writer_of
from tests.chance import Chance

NAMES = (
    "then", "and_then", "from", "a", "the", "is", "make_sure_that", "first", "put", "pick_up", "it", "and", "to",
    "second", "please", "not", "is_not", "holds_of", "your_task", "that", "so_that", "on", "inside",
)  # fmt: skip
ENTITIES = (
    "a", "the", "it", "and", "cube_1", "cube_2", "cube", "big_1", "one", "then", "red_cube", "f(1)", "f(2)", "from",
)  # fmt: skip
CLASSES = ("cube", "it", "big", "red", "the", "thing")
ARGUMENTS = ("", "(X)", "(X,Y)")
BODIES = ("", " :- entity(X,_)", " :- entity(X,_), entity(Y,_), X != Y")


def odd_domain(chance: random.Random) -> str:
    """Return a closed domain with three fluents and three actions of odd names."""
    classes = chance.sample(CLASSES, 2)
    lines = ['#include "rules/closed_world.lp".', *(f"class({name})." for name in classes)]
    lines += [f"entity({name}, {classes[i % 2]})." for i, name in enumerate(chance.sample(ENTITIES, 4))]
    fluents = [f"{name}{ARGUMENTS[i]}" for i, name in enumerate(chance.sample(NAMES, 3))]
    lines += [f"fluent({fluent}){body}." for fluent, body in zip(fluents, BODIES, strict=True)]
    for name in chance.sample(NAMES, 3):
        arity = chance.randrange(3)
        action, value = f"{name}{ARGUMENTS[arity]}", chance.choice(["true", "false"])
        lines.append(f"action({action}){BODIES[arity]}.")
        lines.append(f"postcondition({action}, {fluents[chance.randrange(arity + 1)]}, {value}) :- action({action}).")
    return "\n".join(lines)


def test_words_of_the_language_as_names_are_no_obstacle(chance: Chance) -> None:
    drawn, told = chance.generator(11), 0
    for _ in range(chance.examples(16)):
        try:
            domain = load_domain(text=odd_domain(drawn))
        except DomainError:
            continue  # what the linter refuses
        writer = instruction_writer_of(domain)
        for task in TaskSpace(domain, 3).sample(2, seed=drawn.randrange(1000)):
            words = writer.instructions(task)
            assert writer.read(task, words.default).actions == writer.read(task, words.exact).actions == task.actions
            assert writer.read(task, words.vague).goal == writer.goal(task)
            for number, text in enumerate(words.subgoals):
                assert writer.read(context_of(task, number), text).actions == (task.actions[number],)
            told += 1
    assert told > 10
