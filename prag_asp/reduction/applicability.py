"""The check of the syntactic premises of the small-model reduction.

The author's statements must treat alike all entities that they do not name, and no rule may depend on an entity that
its atoms do not name. The allowed fragment is narrow, and the proof, in docs/explanations/small_model_reduction.md,
uses each restriction: rules occur only in the base part and are plain and stratified; they contain no predicates of the
encodings outside the contract; and they do not compare terms by their order, except to state only one of two mirror
images of an invariant.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from clingo.ast import AST, ASTType, ComparisonOperator, Sign, UnaryOperator

from prag_asp.program.syntax import VARIABLE, AtomNode, Signature, Statement, below, spelled, variables

READ = frozenset([
    ("class", 1), ("class", 2), ("entity", 2), ("is_a", 2), ("fluent", 1), ("action", 1), ("precondition", 3),
    ("postcondition", 3), ("initially", 2), ("goal", 2), ("at_most", 2), ("ever", 1),
])  # fmt: skip
"""The predicates of the contract that an author's rules may read.

Invariants are excluded, because only one of two mirror images may have been stated.
"""

MIRRORED = frozenset([("exclusive", 2), ("impossible", 2)])
"""The symmetric invariants: swapping their two fluents does not change their meaning."""

STATED = (READ - {("is_a", 2)}) | MIRRORED | {("implies", 2)}
"""The predicates of the contract that an author's rules may derive."""

RULES = frozenset(["closed_world.lp", "at_most.lp", "ever.lp"])
"""The optional rules that depend on no entity except those that an action names."""

FOLDERS = ("rules", "conditions")
"""The folders of optional encodings."""

PASSED_OVER = frozenset([
    ASTType.Program, ASTType.Definition, ASTType.Defined, ASTType.ShowSignature, ASTType.ShowTerm, ASTType.Comment,
])  # fmt: skip
"""Statements that do not change the plans."""

PLAIN = frozenset([ASTType.SymbolicAtom, ASTType.BooleanConstant, ASTType.Comparison])
"""The kinds of atoms that a literal may have."""

ORDERED = frozenset([
    ComparisonOperator.LessThan, ComparisonOperator.LessEqual,
    ComparisonOperator.GreaterThan, ComparisonOperator.GreaterEqual,
])  # fmt: skip
COMPUTED = frozenset([ASTType.BinaryOperation, ASTType.Interval])
"""The kinds of terms whose value is a number or undefined."""
Node = tuple[Signature, str]
"""A predicate, with a value if it is ``initially/2``, whose values are stratified separately."""

VALUES = ("true", "false")

MOST_VARIABLES = 8
"""The largest number of variables for which mirror images of a rule are searched for; the search is exponential in it.
"""


def objection(statements: Sequence[Statement]) -> str | None:
    """Return the first reason, with file and line, why the small-model reduction does not apply."""
    own = [each for each in statements if each.own]
    for statement in statements:
        if not statement.own and statement.path.parent.name in FOLDERS and statement.path.name not in RULES:
            return f"{statement.path.name} may depend on every entity"
    reserved = {atom.signature for each in statements if not each.own for atom in (*each.heads, *each.body)} - STATED
    reserved |= {(each.node.name, each.node.arity) for each in statements
                 if not each.own and each.kind == ASTType.Defined} - STATED  # fmt: skip
    for statement in own:
        reason = None
        if not statement.is_rule and statement.kind not in PASSED_OVER:
            reason = "this statement may depend on every entity"
        elif statement.is_rule and statement.part != "base":
            reason = "a rule of a step may depend on every entity"
        elif statement.is_rule:
            reason = _objection_to_form(statement) or _objection_to_atoms(statement, reserved)
        if reason:
            return f"{statement.path}:{statement.line}: {reason}"
    unstratified = _through_negation([each for each in statements if each.is_rule and _in_base(each)])
    if unstratified:
        return f"{unstratified.path}:{unstratified.line}: this rule depends on itself through `not`"
    return None


def deriving_rules(statements: Iterable[Statement]) -> list[Statement]:
    """Return the rules of the base part that have a body."""
    return [each for each in statements if each.is_rule and _in_base(each) and each.literals]


def is_stated(statement: Statement) -> bool:
    """Return whether a statement is a fact of the author in the base part."""
    plain = statement.own and statement.is_rule and not statement.timed and not statement.literals
    return plain and (statement.is_plain_fact or statement.node.head.ast_type == ASTType.Literal)


def _in_base(statement: Statement) -> bool:
    return statement.part == "base" and (statement.own or statement.path.name in {*RULES, "classes.lp"})


def _objection_to_form(statement: Statement) -> str | None:
    """Return an objection to a rule unless it derives a plain atom from plain literals."""
    head = statement.node.head
    if head.ast_type != ASTType.Literal or head.atom.ast_type not in PLAIN or head.sign != Sign.NoSign:
        return "a choice or an aggregate in a head may depend on every entity"
    for literal, _ in statement.literals:
        plain = literal.ast_type == ASTType.Literal and literal.atom.ast_type in PLAIN
        if not plain or literal.sign == Sign.DoubleNegation:
            return "an aggregate or a condition may depend on every entity"
    if statement.scripts:
        return "a function of a script may depend on every entity"
    # The minus of a strongly negated atom does not make a different name.
    computed = (
        node
        for literal in (head, *(literal for literal, _ in statement.literals))
        for part in ([literal.atom.symbol] if literal.atom.ast_type == ASTType.SymbolicAtom else [literal.atom])
        for node in below(part)
        if node.ast_type == ASTType.UnaryOperation and node is not part
    )
    if statement.literals and any(map(_turns_around, computed)):
        return "a minus sign turns names into other names"
    return None


def _turns_around(term: AST) -> bool:
    """Return whether a unary minus may be applied to a name."""
    return term.operator_type == UnaryOperator.Minus and not _is_number(term.argument)


def _objection_to_atoms(statement: Statement, reserved: AbstractSet[Signature]) -> str | None:
    """Return an objection if a rule contains a forbidden predicate, or distinguishes entities by their order."""
    for atom in statement.heads:
        if atom.name.startswith("-") or atom.signature in reserved:
            return f"{spelled(atom.signature)} is not stated by plain facts"
    for atom in statement.body:
        if atom.name.startswith("-") or atom.signature in reserved - READ or atom.signature in MIRRORED:
            return f"{spelled(atom.signature)} may depend on every entity"
    compared = []  # literals that compare terms by their order, none of which is certain to be a number
    for literal, _ in statement.literals:
        guards = literal.atom.guards if literal.atom.ast_type == ASTType.Comparison else ()
        sides = [literal.atom.term, *(guard.term for guard in guards)] if guards else []
        if any(guard.comparison in ORDERED for guard in guards) and (len(sides) > 2 or not any(map(_is_number, sides))):
            compared.append(literal)
    if compared and (len(compared) > 1 or not _is_mirrored(statement, compared[0])):
        return "entities may be distinguished by the order of their names"
    return None


def _is_number(term: AST) -> bool:
    """Return whether a term is certainly a number; a name with a minus sign is still a name."""
    if term.ast_type == ASTType.UnaryOperation:
        return not _turns_around(term)
    return term.ast_type in COMPUTED or (
        term.ast_type == ASTType.SymbolicTerm and re.fullmatch(r"-?\d+", str(term)) is not None
    )


def _is_mirrored(statement: Statement, compared: AST) -> bool:
    """Return whether a rule for an invariant is symmetric in the two variables compared, apart from the comparison."""
    guards = compared.atom.guards
    sides = [str(compared.atom.term), str(guards[0].term)]
    (head,) = statement.heads or (None,)
    plain = len(guards) == 1 and compared.sign == Sign.NoSign and all(VARIABLE.fullmatch(side) for side in sides)
    if head is None or head.signature not in MIRRORED or not plain or sides[0] == sides[1]:
        return False
    body = [text for literal, text in statement.literals if literal is not compared]
    texts = [*head.arguments, *body]
    if any('"' in text or ";" in text for text in texts):
        return False
    others = sorted(set().union(*map(variables, texts)) - {*sides, "_"})
    if len(others) > MOST_VARIABLES:
        return False
    first, second = head.arguments
    return any(
        _swapped(first, swap) == second and _swapped(second, swap) == first
        and {_swapped(text, swap) for text in body} == set(body)
        for swap in _involutions(others, {sides[0]: sides[1], sides[1]: sides[0]})
    )  # fmt: skip


def _involutions(names: Sequence[str], fixed: Mapping[str, str]) -> Iterator[dict[str, str]]:
    """Yield all involutions of the given names, each combined with the pairs in `fixed`."""
    if not names:
        yield dict(fixed)
        return
    first, *rest = names
    yield from _involutions(rest, fixed)
    for other in rest:
        yield from _involutions([each for each in rest if each != other], {**fixed, first: other, other: first})


def _swapped(text: str, swap: Mapping[str, str]) -> str:
    return VARIABLE.sub(lambda match: swap.get(match[0], match[0]), text)


def _through_negation(rules: Sequence[Statement]) -> Statement | None:
    """Return a rule that depends on its own head through `not`, or None if the rules are stratified."""
    above: dict[Node, set[Node]] = {}
    for rule in rules:
        heads = {node for head in rule.heads for node in _nodes(head)}
        for node in {node for atom in rule.body for node in _nodes(atom)}:
            above.setdefault(node, set()).update(heads)
    for rule in rules:
        reached = {node for head in rule.heads for node in _nodes(head)}
        waiting = list(reached)
        while waiting:
            more = above.get(waiting.pop(), set()) - reached
            reached |= more
            waiting += more
        if any(atom.negated and not reached.isdisjoint(_nodes(atom)) for atom in rule.body):
            return rule
    return None


def _nodes(atom: AtomNode) -> list[Node]:
    """Return the graph nodes to which an atom may belong; true and false initial values have separate nodes."""
    if atom.signature != ("initially", 2):
        return [(atom.signature, "")]
    value_term = atom.arguments[1]
    return [(atom.signature, value) for value in VALUES if value_term == value or value_term not in VALUES]
