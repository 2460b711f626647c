"""Circuits of shared conjunctions and disjunctions, and their evaluation on words of bits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

FALSE, TRUE = 0, 1
"""The constant gates."""

CONSTANTS = 2


@dataclass(frozen=True)
class Layer:
    """Gates of one kind that read only earlier gates.

    `first` is the number of the first gate. `operands` holds the operands of all gates, and `starts` the index of the
    first operand of each gate.
    """

    conjunctions: bool
    first: int
    operands: NDArray[np.intp]
    starts: NDArray[np.intp]


@dataclass(frozen=True)
class Circuit:
    """Numbered gates: the constants, the inputs, and then the layers."""

    inputs: int
    gates: int
    layers: tuple[Layer, ...]

    @property
    def widest(self) -> int:
        """The largest number of words in use at once, per input word."""
        return self.gates + max((len(layer.operands) for layer in self.layers), default=0)

    def evaluate(self, inputs: NDArray[np.uint64]) -> NDArray[np.uint64]:
        """Return the values of all gates, shape (gates, words), for inputs of shape (inputs, words)."""
        values = np.empty((self.gates, inputs.shape[1]), dtype=np.uint64)
        values[FALSE], values[TRUE] = np.uint64(0), ~np.uint64(0)
        values[CONSTANTS : CONSTANTS + self.inputs] = inputs
        for layer in self.layers:
            combine = np.bitwise_and if layer.conjunctions else np.bitwise_or
            own = values[layer.first : layer.first + len(layer.starts)]
            combine.reduceat(values[layer.operands], layer.starts, axis=0, out=own)
        return values


class Gates:
    """Gates under construction: equal gates are shared, and a gate whose value a constant determines is a constant."""

    def __init__(self, inputs: int) -> None:
        self._inputs = inputs
        self._numbers: dict[tuple[bool, tuple[int, ...]], int] = {}
        self._keys: list[tuple[bool, tuple[int, ...]]] = []

    def input(self, place: int) -> int:
        """Return the gate of an input."""
        return CONSTANTS + place

    def all(self, operands: Iterable[int]) -> int:
        """Return the conjunction of gates."""
        return self._gate(True, operands)

    def any(self, operands: Iterable[int]) -> int:
        """Return the disjunction of gates."""
        return self._gate(False, operands)

    def _gate(self, conjunction: bool, operands: Iterable[int]) -> int:
        neutral, decisive = (TRUE, FALSE) if conjunction else (FALSE, TRUE)
        inputs = set(operands) - {neutral}
        if decisive in inputs:
            return decisive
        if len(inputs) < 2:
            return inputs.pop() if inputs else neutral
        key = (conjunction, tuple(sorted(inputs)))
        if key not in self._numbers:
            self._numbers[key] = CONSTANTS + self._inputs + len(self._keys)
            self._keys.append(key)
        return self._numbers[key]

    def circuit(self, roots: Sequence[int]) -> tuple[Circuit, Mapping[int, int]]:
        """Return the circuit of the given gates and of all gates that they read, and each gate's number in it."""
        before = CONSTANTS + self._inputs
        needed: set[int] = set()
        waiting = [gate for gate in roots if gate >= before]
        while waiting:
            gate = waiting.pop()
            if gate not in needed:
                needed.add(gate)
                waiting += [each for each in self._keys[gate - before][1] if each >= before]
        depths: dict[int, int] = {}
        kinds: dict[tuple[int, bool], list[int]] = {}
        for gate in sorted(needed):  # in order of construction
            conjunction, operands = self._keys[gate - before]
            depths[gate] = 1 + max(depths.get(each, 0) for each in operands)
            kinds.setdefault((depths[gate], conjunction), []).append(gate)
        numbers = {gate: gate for gate in range(before)}
        layers = []
        for (_, conjunction), members in sorted(kinds.items()):
            first = len(numbers)
            read = [self._keys[gate - before][1] for gate in members]
            numbers |= {gate: first + place for place, gate in enumerate(members)}
            starts = np.array([0, *accumulate(map(len, read[:-1]))], dtype=np.intp)
            reading = np.array([numbers[each] for several in read for each in several], dtype=np.intp)
            layers.append(Layer(conjunction, first, reading, starts))
        return Circuit(self._inputs, len(numbers), tuple(layers)), numbers
