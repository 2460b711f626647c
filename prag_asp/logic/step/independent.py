"""The independent parts of a domain, which share no variable, action, rule or condition on the final state.

Atoms that depend on no variable are evaluated first, so that rules that count or name the actions of a step do not
connect parts. After that, an action belongs with the variables that it reads or sets. A part must also remain unchanged
while another part acts; `Transition.rests` decides this for each state.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace

from prag_asp.logic.step.moves import Move
from prag_asp.logic.step.normal import RuleBody
from prag_asp.logic.step.simplify import simplify
from prag_asp.logic.step.transition import Transition
from prag_asp.program.entity_names import action_name

FEWEST_VARIABLES = 12
"""The minimum number of variables for which parts are searched for; with fewer, there are few states anyway."""

Node = tuple[str, int]
"""A variable, an atom that rules define, or an action, by number."""

IDLE: Node = ("variables that no action sets or reads", 0)
FREE: Node = ("actions that set and read no variable", 0)
"""A node for all actions without variables, which form one part."""


def independent_parts(transition: Transition, *, by_name: bool = False) -> tuple[Transition, ...]:
    """Return the independent parts of a step function.

    If each part rests in all of its states, the plans of the step function are the shuffles of the plans of its parts.

    With `by_name`, actions of one name belong to one part. The result is empty if there is only one part, or if there
    are fewer than `FEWEST_VARIABLES`.
    """
    if len(transition.variables) < FEWEST_VARIABLES:
        return ()
    return _Parts(transition, by_name).step_functions()


class _Parts:
    """Parts of connected nodes, as disjoint sets (Tarjan 1975)."""

    def __init__(self, transition: Transition, by_name: bool) -> None:
        self._transition = transition
        self._above: dict[Node, Node] = {}
        before = transition.step.ground.before
        self._variable = {
            before[symbol]: place for place, symbol in enumerate(transition.variables) if symbol in before
        }
        moves = enumerate(map(transition.move, range(len(transition.actions))))
        self._moves = {letter: move for letter, move in moves if not move.impossible}
        self._idle_nodes: dict[int, list[Node]] = {}
        self._asking: dict[int, list[Node]] = {}
        self._settled = self._decided()
        nodes = [
            *(("action", letter) for letter in self._moves),
            *(("variable", place) for place in range(len(transition.variables))),
        ]
        for letter, move in self._moves.items():
            self._join_effects(letter, move)
        if self._are_joined(nodes):
            return  # the other rules could only join more
        rules = transition.rules
        for place, atom in enumerate(rules.written):
            if atom in rules.order:
                self._join([("variable", place), ("atom", atom)])
        for atom, bodies in rules.idle.items():
            self._join([("atom", atom), *self._read(bodies)])
        for number, body in rules.idle_constraints:
            self._idle_nodes[number] = self._read([body])
            self._join(self._idle_nodes[number])
        if self._are_joined(nodes):
            return
        for letter, move in self._moves.items():
            self._join_action(letter, move)
        if by_name:
            first: dict[str, int] = {}
            for letter in self._moves:
                named = first.setdefault(action_name(transition.actions[letter]), letter)
                self._join([("action", named), ("action", letter)])

    def step_functions(self) -> tuple[Transition, ...]:
        """Return the step functions of the parts, or an empty tuple if there is only one part."""
        whole = self._transition
        final = [self._leaves(body) for body in whole.step.final]
        for leaves in final:
            self._join(leaves)
        # Join nodes that no action touches, and actions without variables.
        acting = {self._root(("action", letter)) for letter in self._moves}
        placed = {self._root(("variable", place)) for place in range(len(whole.variables))}
        self._join([IDLE, *(placed - acting)])
        self._join([FREE, *(acting - placed)])
        parts: dict[Node, tuple[list[int], list[int]]] = {}
        for place in range(len(whole.variables)):
            parts.setdefault(self._root(("variable", place)), ([], []))[0].append(place)
        for letter in self._moves:
            parts.setdefault(self._root(("action", letter)), ([], []))[1].append(letter)
        if sum(bool(letters) for _, letters in parts.values()) < 2:
            return ()
        transitions = []
        for root, (places, letters) in parts.items():
            occurs = {whole.actions[letter]: whole.step.occurs[whole.actions[letter]] for letter in letters}
            ends = zip(whole.step.final, final, strict=True)
            own = tuple(body for body, leaves in ends if not leaves or self._root(leaves[0]) == root)
            constraints = tuple(body for number, body in enumerate(whole.constraints) if self._concerns(number, root))
            variables = tuple(whole.variables[place] for place in places)
            transitions.append(Transition(replace(whole.step, occurs=occurs, final=own), variables, constraints, ()))
        return tuple(transitions)

    def _decided(self) -> set[int]:
        """Return the atoms that depend on no variable if no action occurs."""
        rules = self._transition.rules
        decided: set[int] = set()
        for stratum in rules.strata:
            inside = set(stratum.atoms)
            read = {abs(literal) for atom in inside for body in rules.idle[atom] for literal in body.literals}
            if not any(atom in self._variable or atom in rules.order for atom in read - decided - inside):
                decided |= inside
        return decided

    def _join_effects(self, letter: int, move: Move) -> None:
        """Join an action with the nodes that its guards read, and with the variables that it sets."""
        places = self._transition.places_set(move)
        self._join([("action", letter), *self._read(move.guards), *(("variable", place) for place in places)])

    def _join_action(self, letter: int, move: Move) -> None:
        """Join an action with the other nodes that it reads, and record the constraints that read it."""
        action: Node = ("action", letter)
        own = {atom for stratum in move.strata for atom in stratum.atoms}
        for atom in own:
            self._join([action, ("atom", atom), *self._read(move.bodies[atom], own)])
        self._join([action, *self._read(move.constraints, own)])
        constants = {**self._transition.rules.no_action, **move.constants}
        for number in move.touched:
            simplified = simplify(self._transition.constraints[number], constants)
            if isinstance(simplified, RuleBody):
                self._join([action, *self._idle_nodes.get(number, ())])
                self._asking.setdefault(number, []).append(action)

    def _concerns(self, number: int, root: Node) -> bool:
        """Return whether a constraint belongs to a part because it reads a variable or an action of the part.

        A constraint that reads no variable if no action occurs belongs to all parts, unless every action decides it.
        """
        idle = self._idle_nodes.get(number)
        if any(self._root(node) == root for node in (*(idle or ()), *self._asking.get(number, ()))):
            return True
        return idle == [] and not all(number in move.touched for move in self._moves.values())

    def _read(self, bodies: Iterable[RuleBody], own: Collection[int] = ()) -> list[Node]:
        """Return the variables and derived atoms that bodies read.

        Derived atoms that depend on no variable are omitted, unless they are in `own`.
        """
        nodes: list[Node] = []
        for atom in {abs(literal) for body in bodies for literal in body.literals}:
            if atom in self._variable:
                nodes.append(("variable", self._variable[atom]))
            elif atom in own or (atom in self._transition.rules.order and atom not in self._settled):
                nodes.append(("atom", atom))
        return nodes

    def _leaves(self, body: RuleBody) -> list[Node]:
        """Return the variables on which a constraint on the final state depends."""
        step = self._transition.step
        places = {step.ground.now.get(symbol): place for place, symbol in enumerate(self._transition.variables)}
        seen: set[int] = set()
        waiting = [abs(literal) for literal in body.literals]
        while waiting:
            atom = waiting.pop()
            if atom not in seen:
                seen.add(atom)
                waiting += [abs(each) for derivation in step.final_bodies.get(atom, ()) for each in derivation.literals]
        return [("variable", places[atom]) for atom in sorted(seen) if atom in places and atom not in step.final_bodies]

    def _are_joined(self, nodes: Iterable[Node]) -> bool:
        """Return whether all nodes belong to one part."""
        return len(set(map(self._root, nodes))) == 1

    def _root(self, node: Node) -> Node:
        path = []
        while (above := self._above.get(node, node)) != node:
            path.append(node)
            node = above
        for each in path:
            self._above[each] = node
        return node

    def _join(self, nodes: Iterable[Node]) -> None:
        first: Node | None = None
        for node in nodes:
            root = self._root(node)
            if first is None:
                first = root
            else:
                self._above[root] = self._root(first)
