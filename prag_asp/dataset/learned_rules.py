"""Learned rules: invariants about facts that are proved impossible in the scene of a domain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.scenes import scene_of
from prag_asp.domain.load import LEARNED, with_learned
from prag_asp.physics.proofs.learned_exclusions import prove_exclusions
from prag_asp.physics.proofs.schemas import rules, text_of
from prag_asp.program.sources import Source
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain


@dataclass(frozen=True)
class Learned:
    """The rules ``impossible(F,G)``, the number of `proofs`, the `text` of learned.lp, and the extended `domain`."""

    rules: tuple[str, ...]
    proofs: int
    text: str
    domain: Domain

    def __str__(self) -> str:
        return f"{plural(len(self.rules), 'rule')} from {plural(self.proofs, 'proof')}"


def learn(
    domain: Domain, *, path: Path = Path(LEARNED), progress: Callable[[str], None] = lambda words: None
) -> Learned:
    """Return rules for facts that are proved impossible in the scene and not excluded by the domain.

    An existing learned.lp of the domain is ignored. Messages about the rules refer to the file `path`.

    Raises:
        SceneError: the domain has no scene, or the scene lacks the shape of an entity.
        PhysicsMissingError: PyBullet is not installed.
    """
    learned = rules(prove_exclusions(domain.facts, scene_of(domain), progress), domain.facts)
    text = text_of(learned, domain.label)
    after = with_learned(domain, (Source(path, text),)) if learned else domain
    return Learned(tuple(map(str, learned)), sum(len(rule.proofs) for rule in learned), text, after)
