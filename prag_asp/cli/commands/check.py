"""``prag-asp check``: errors and warnings of a domain, and a summary of its declarations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options
from prag_asp.cli.domain_options import DOMAIN, DomainOptions, domain_options
from prag_asp.cli.terminal import say, tell_line
from prag_asp.errors import DomainError
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain
    from prag_asp.program.problem import Problem


@click.command()
@domain_options(*DOMAIN, options.trust)
@click.option("--symmetries", is_flag=True, help="Also print which entities are interchangeable, alone or in groups.")
def check(*, request: DomainOptions, symmetries: bool) -> None:
    """Check a domain, and summarize its declarations.

    Errors mean that the domain is invalid, or that a count could be wrong. Warnings, on stderr, point out valid but
    suspicious statements; the comment `% lint: allow NAME` on the line silences a warning.
    """
    from prag_asp.program.problem import first_of_each, raise_problems
    from prag_asp.reduction.reduction import is_large

    domain = request.domain(tell=False)
    if "own" in domain.settings.scene:
        from prag_asp.dataset.scenes import scene_of

        scene_of(domain)
    _check_learned(domain)
    warnings = [*domain.warnings, *_scene_warnings(domain)]
    if request.strict:
        raise_problems(each.as_error() for each in first_of_each(warnings))
    for warning in first_of_each(warnings):
        tell_line(str(warning))
    if domain.irreducible and is_large(domain.facts):
        tell_line(f"all entities are grounded, although many are alike: {domain.irreducible}")
    reduction = domain.reduction
    for group, bound in zip(reduction.groups, reduction.bounds, strict=True) if reduction else ():
        needed = f"{bound.action} N + {bound.invariant} of them, at least {bound.least}"
        tell_line(f"{group[0]}, ... {group[-1]}: {len(group):,} entities are alike; counts at length N need {needed}")
    say(f"{domain.label}: ok; {', '.join(_parts(domain))}")
    if domain.settings.scene:
        from prag_asp.cli.body_summary import body_lines
        from prag_asp.dataset.scenes import scene_of

        for line in body_lines(scene_of(domain)):
            say(line)
    if symmetries:
        from prag_asp.space.task_space import TaskSpace

        alike = TaskSpace(domain, 0).symmetries
        for group in alike.groups:
            say(f"interchangeable: {', '.join(map(str, group))}")
        for units in alike.joint:
            texts = ("(" + ", ".join(map(str, unit)) + ")" for unit in units)
            say(f"interchangeable together: {', '.join(texts)}")


def _parts(domain: Domain) -> list[str]:
    """Return the phrases that summarize a domain, such as the number of declarations of each kind."""
    reduction = domain.reduction
    facts, total = (reduction.facts_with_all_entities, reduction.total) if reduction else (domain.facts, len)
    possible = f"{total(facts.tried)} of " if len(facts.tried) < len(facts.declared_actions) else ""
    world = "closed" if facts.closed else "open"
    scene = "with a scene" if domain.settings.scene else "no scene"
    return [
        f"{world} world",
        plural(len(facts.entities), "entity", "entities"),
        plural(total(facts.fluents), "fluent"),
        f"{possible}{plural(total(facts.declared_actions), 'action')}",
        *([plural(len(facts.composites), "composite")] if facts.composites else []),
        *([plural(len(domain.learned), "learned invariant")] if domain.learned else []),
        scene,
    ]


def _check_learned(domain: Domain) -> None:
    """Check that the scene still proves the learned invariants of a domain.

    Raises:
        DomainError: an invariant is not proved, because the scene has changed or the file was written by hand.
    """
    if not domain.learned or domain.folder is None:
        return
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.domain.load import LEARNED
    from prag_asp.physics.proofs.learned_exclusions import unproved_exclusions

    for fluents in islice(unproved_exclusions(domain, scene_of(domain)), 1):
        claim = (
            f"{fluents[0]} never holds" if len(fluents) == 1 else f"{fluents[0]} and {fluents[1]} exclude each other"
        )
        raise DomainError(
            f"{domain.folder / LEARNED}:1: the scene does not prove that {claim}; "
            f"write the file again with prag-asp learn {domain.folder} --length N --write"
        )


def _scene_warnings(domain: Domain) -> Iterable[Problem]:
    """Return warnings about the bodies of a scene, and about grasps and placements that are impossible in the scene."""
    if not domain.settings.scene:
        return ()
    if domain.reduction:
        domain = replace(domain, facts=domain.reduction.facts_with_all_entities)
    from prag_asp.cli.body_summary import solid_containers, tilted
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.domain.load import shown_warnings
    from prag_asp.physics.proofs.grips import never_gripped
    from prag_asp.physics.proofs.reaching import out_of_reach

    scene = scene_of(domain)
    checks = (never_gripped, out_of_reach, tilted, solid_containers)
    return shown_warnings([problem for check in checks for problem in check(domain, scene)], domain.settings)
