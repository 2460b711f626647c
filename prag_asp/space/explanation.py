"""Why a sequence of actions is not a plan of a domain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from prag_asp.atom import Atom
from prag_asp.logic.domain_logic import logic_of
from prag_asp.logic.formula.explanation import Explanation
from prag_asp.logic.formula.explanation import explain as reasons_against
from prag_asp.space.engines.prefix import parse_plan

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain


def explain(domain: Domain, actions: Sequence[str | Atom]) -> Explanation | None:
    """Return why a sequence of actions of any length is not a plan of a domain, or None if it is one.

    Raises:
        QueryError: an item is not an action of the domain, or is only the name of several actions.
        EngineError: the domain cannot be translated to clauses.
    """
    return reasons_against(logic_of(domain).whole, parse_plan(actions, domain.facts))
