"""Why a sequence of actions is no plan of a domain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from prag_asp.atom import Atom
from prag_asp.errors import QueryError
from prag_asp.logic.formula.explain import Explanation
from prag_asp.logic.formula.explain import explain as reasons_against
from prag_asp.logic.model import Model
from prag_asp.space.engines.prefix import parse_prefix

if TYPE_CHECKING:
    from prag_asp.domain.load import Domain


def explain(domain: Domain, actions: Sequence[str | Atom]) -> Explanation | None:
    """Return why a sequence of actions, of any length, is no plan of a domain, or None where it is one.

    Raises:
        QueryError: one is no action of the domain, or only the name of several.
        EngineError: the domain has no counterpart in clauses.
    """
    plan = parse_prefix([str(action) for action in actions], "plan", domain.facts)
    known = {str(action): action for action in domain.facts.actions}
    for action in plan:
        if action not in known:
            example = min(each for each in known if each.startswith(f"{action}("))
            raise QueryError(f"{action} is the name of several actions; give one in full, such as {example}")
    return reasons_against(Model(domain), [known[action] for action in plan])
