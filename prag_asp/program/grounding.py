"""The grounding of programs with clingo, whose messages become errors with file and line."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

import clingo

from prag_asp.errors import DomainError
from prag_asp.processes.progress_events import stage
from prag_asp.program.finite.checks import Checks
from prag_asp.program.finite.guards import Guarded, guard_program
from prag_asp.program.parse import require_memory
from prag_asp.program.problem import Problem
from prag_asp.program.sources import ADDED, Program

POSITION = r"<(?:string|block)>:(?P<line>\d+):[-\d:]+: *(?:error|info|warning|note): *"
UNSAFE = r"'([^']+)' is unsafe"

SCRIPT = "#Script"
"""The text that clingo prints for the value of a check in an undefined operation."""

REMARKS = "--warn=atom-undefined"
"""The option that makes clingo report atoms that no rule derives."""

MESSAGES = 1000
"""The number of messages after which clingo suppresses all others."""

ProgramPart = tuple[str, Sequence[clingo.Symbol]]


class Grounder:
    """A clingo control for one program, without output.

    `notes` are the messages about undefined operations, which are errors only if `strict`. `remarks` are the messages
    about atoms that no rule derives; clingo prints them with the option `REMARKS`. If `text` is given, it is an aspif
    program that is grounded instead of `program`, without further checks. An `observer` receives the ground program
    from clingo.

    Raises:
        DomainError: clingo cannot parse the program, or one of its intervals is too wide.
    """

    def __init__(
        self,
        program: Program,
        *arguments: str,
        strict: bool = True,
        text: str | None = None,
        observer: clingo.Observer | None = None,
    ) -> None:
        self._program, self._strict = program, strict
        self.notes: list[str] = []
        self.remarks: list[Problem] = []
        self._parts = 0
        guarded = guard_program(program) if text is None else Guarded(text, (), endless_steps=False)
        self._checks = Checks(guarded.sites)
        self._messages: list[tuple[clingo.MessageCode, str]] = []
        self.control = clingo.Control(
            ["--warn=no-atom-undefined", *arguments],
            logger=lambda code, text: self._messages.append((code, text)),
            message_limit=MESSAGES,
        )
        if observer is not None:
            self.control.register_observer(observer)  # before aspif is read, because that immediately adds its rules
        self._run(lambda: self.control.add("base", [], guarded.text))

    def ground(self, parts: Iterable[ProgramPart]) -> None:
        """Ground program parts.

        Raises:
            DomainError: clingo cannot ground them, or an operation is out of range or (with `strict`) undefined.
        """
        stage("grounding the domain")
        self._run(lambda: self.control.ground(list(parts), context=self._checks))

    def state(self, atoms: Iterable[clingo.Symbol]) -> None:
        """Add facts for use by program parts that are grounded later."""
        self._add_facts(f"{atom}." for atom in atoms)

    def leave_open(self, atoms: Iterable[clingo.Symbol]) -> None:
        """Add external atoms, which may be true or false, for use by program parts that are grounded later."""
        self._add_facts(f"#external {atom}." for atom in atoms)

    def add(self, part: str, rules: Iterable[str]) -> None:
        """Add rules to a part that is not yet ground."""
        text = "\n".join(rules)
        self._run(lambda: self.control.add(part, [], text))

    def _add_facts(self, statements: Iterable[str]) -> None:
        """Ground statements as a separate part.

        clingo's backend would be faster, but after it has added atoms, later grounding loses instances of constraints
        with conditional literals that always apply (``:- r(X), not p(X,Y) : q(X,Y).``).
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
            codes = (clingo.MessageCode.RuntimeError, clingo.MessageCode.Other)
            errors = [locate_message(self._program, text) for code, text in self._messages if code in codes]
            raise DomainError(*(dict.fromkeys(errors) or [f"clingo: {error}"])) from None
        undefined = [text for code, text in self._messages if code == clingo.MessageCode.OperationUndefined]
        located = [(locate_message(self._program, text), SCRIPT in text) for text in undefined]
        out_of_range = [text for text, is_check in located if is_check]
        if out_of_range and self._checks.overflows:
            raise self._checks.overflow(out_of_range[0])
        # For X+0, clingo prints only X and the check.
        notes = dict.fromkeys(self._checks.as_written(text) if is_check else text for text, is_check in located)
        if notes and self._strict:
            raise DomainError(f"{next(iter(notes))}; guard the operation")
        self.notes += notes
        remarks = (text for code, text in self._messages if code == clingo.MessageCode.AtomUndefined)
        self.remarks += dict.fromkeys(_remark(self._program, text) for text in remarks)


def locate_message(program: Program, message: str) -> str:
    """Return a clingo message as one line that begins with the file and the line number."""
    place = re.search(POSITION, message)
    if not place:
        return " ".join(message.split())
    path, line = program.locate(int(place["line"]))
    unsafe = sorted({"_" if name.startswith("#") else name for name in re.findall(UNSAFE, message)})
    if unsafe:
        text = f"{path}:{line}: unsafe variable {', '.join(unsafe)}"
        return f"{text}; bind it in the body by an atom without `not`"
    words = " ".join(re.sub(POSITION, "", message).split())
    return f"{path}:{line}: {words}"


def _remark(program: Program, message: str) -> Problem:
    """Turn clingo's message about an atom that no rule derives into a warning, without the checks in its arguments."""
    place = re.search(POSITION, message)
    path, line = program.locate(int(place["line"])) if place else (ADDED, 0)
    words = " ".join(re.sub(POSITION, "", message).split())
    return Problem(path, line, re.sub(rf"\+{SCRIPT}\d+", "", words), "undefined")
