"""clingo, with its complaints turned into errors that name the file and the line."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

import clingo

from prag_asp.errors import DomainError
from prag_asp.processes.progress_events import stage
from prag_asp.program.finite.checks import Checks
from prag_asp.program.finite.guards import guarded
from prag_asp.program.parse import require_memory
from prag_asp.program.sources import Program

POSITION = r"<(?:string|block)>:(?P<line>\d+):[-\d:]+: *(?:error|info|warning|note): *"
UNSAFE = r"'([^']+)' is unsafe"

SCRIPT = "#Script"
"""How clingo writes, within an operation that is undefined, the value of a check."""

Part = tuple[str, Sequence[clingo.Symbol]]


class Grounder:
    """A clingo control that holds one program; nothing of it is printed, whatever the program does.

    `notes` are what clingo itself only remarks, where it is not to be an error (`strict`): undefined operations.

    Raises:
        DomainError: clingo cannot parse the program, or an interval of it has too many numbers.
    """

    def __init__(self, program: Program, *arguments: str, strict: bool = True) -> None:
        self._program, self._strict = program, strict
        self.notes: list[str] = []
        self._parts = 0
        found = guarded(program)
        self._checks = Checks(found.sites)
        self._messages: list[tuple[clingo.MessageCode, str]] = []
        self.control = clingo.Control(
            ["--warn=no-atom-undefined", *arguments],
            logger=lambda code, text: self._messages.append((code, text)),
            message_limit=100,
        )
        self._run(lambda: self.control.add("base", [], found.text))

    def ground(self, parts: Iterable[Part]) -> None:
        """Ground program parts.

        Raises:
            DomainError: clingo cannot ground them, or an arithmetic or set operation is out of range or (where that is
                an error) undefined.
        """
        stage("grounding the domain")
        self._run(lambda: self.control.ground(list(parts), context=self._checks))

    def state(self, atoms: Iterable[clingo.Symbol]) -> None:
        """State ground atoms, which the parts that are ground later read."""
        self._tell(f"{atom}." for atom in atoms)

    def leave_open(self, atoms: Iterable[clingo.Symbol]) -> None:
        """Have the parts that are ground later take it for possible that each of some atoms holds."""
        self._tell(f"#external {atom}." for atom in atoms)

    def add(self, part: str, rules: Iterable[str]) -> None:
        """Add rules to a part that is not ground yet."""
        text = "\n".join(rules)
        self._run(lambda: self.control.add(part, [], text))

    def _tell(self, statements: Iterable[str]) -> None:
        """Ground statements as a part of their own.

        clingo's backend would be faster, but where atoms come by it, instances of constraints that are ground later are
        lost, such as always apply and have conditions (``:- r(X), not p(X,Y) : q(X,Y).``).
        """
        self._parts += 1
        name = f"told_{self._parts}"
        self._run(lambda: self.control.add(name, [], "\n".join(statements)))
        self.ground([(name, [])])

    def _run(self, work: Callable[[], None]) -> None:
        self._messages.clear()
        self._checks.overflows.clear()
        try:
            work()
        except RuntimeError as error:
            require_memory(error)
            raise DomainError(*(dict.fromkeys(self._errors()) or [f"clingo: {error}"])) from None
        undefined = [text for code, text in self._messages if code == clingo.MessageCode.OperationUndefined]
        out_of_range = [text for text in undefined if SCRIPT in text]
        if out_of_range and self._checks.overflows:
            raise self._checks.overflow(located(self._program, out_of_range[0]))
        told = dict.fromkeys(map(self._undefined, undefined))
        if told and self._strict:
            raise DomainError(f"{next(iter(told))}; guard the operation")
        self.notes += told

    def _undefined(self, message: str) -> str:
        """Return what is told of an undefined operation; of ``X+0``, clingo writes nothing but X and the check."""
        told = located(self._program, message)
        return self._checks.as_written(told) if SCRIPT in told else told

    def _errors(self) -> list[str]:
        return [
            located(self._program, text)
            for code, text in self._messages
            if code in (clingo.MessageCode.RuntimeError, clingo.MessageCode.Other)
        ]


def located(program: Program, message: str) -> str:
    """Return a message of clingo as one line that begins with the file and line it speaks of."""
    place = re.search(POSITION, message)
    if not place:
        return " ".join(message.split())
    path, line = program.locate(int(place["line"]))
    unsafe = sorted({"_" if name.startswith("#") else name for name in re.findall(UNSAFE, message)})
    if unsafe:
        told = f"{path}:{line}: unsafe variable {', '.join(unsafe)}"
        return f"{told}; bind it in the body by an atom without `not`"
    words = " ".join(re.sub(POSITION, "", message).split())
    return f"{path}:{line}: {words}"
