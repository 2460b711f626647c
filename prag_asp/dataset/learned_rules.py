"""What physics proves impossible in the scene of a domain, as invariants of it."""

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
    """Rules ``impossible(F,G)``, the `text` of a file that states them, and the `domain` with them."""

    rules: tuple[str, ...]
    proofs: int
    text: str
    domain: Domain

    def __str__(self) -> str:
        states = "states" if len(self.rules) == 1 else "state"
        return f"{plural(len(self.rules), 'rule')} {states} {plural(self.proofs, 'proof')}"


def learn(
    domain: Domain, *, path: Path = Path(LEARNED), progress: Callable[[str], None] = lambda words: None
) -> Learned:
    """Return what physics proves impossible in the scene of a domain and the domain does not exclude itself.

    What a learned.lp of the domain states is learned anew. `path` is the file that messages about the rules name.

    Raises:
        SceneError: the domain has no scene, or one that lacks the shape of an entity.
        PhysicsMissingError: PyBullet is not installed.
    """
    found = rules(prove_exclusions(domain.facts, scene_of(domain), progress), domain.facts)
    text = text_of(found, domain.label)
    after = with_learned(domain, (Source(path, text),)) if found else domain
    return Learned(tuple(map(str, found)), sum(len(rule.proofs) for rule in found), text, after)
