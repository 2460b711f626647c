"""Check that every instruction is parsed back, from its text alone, to its task, for all domains and languages.

    python benchmarks/language.py --count 10000

Instructions of tasks of lengths 3 to 6 are written and parsed by two independent writers. A vague instruction must give
the goal facts of the task, a default or exact one its plan, and a subgoal its action. Exits with code 1 and a list of
the errors if one does not.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1]))

from prag_asp import Domain, PragError, Task, TaskSpace, load_domain, shipped_domains
from prag_asp.dataset import Instructions, InstructionWriter, instruction_writer_of
from prag_asp.dataset.language import context_of
from prag_asp.grammar.reader import languages

ROOT = Path(__file__).parents[1]
LENGTHS = (3, 4, 5, 6)


def main() -> None:
    """Sample tasks, write their instructions, parse them back, and print a table and the errors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="total number of tasks")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    pairs = [(domain, language) for domain in _domains() for language in languages(domain.settings)]
    table = Table("domain", "language", "tasks", "parsed back", "by a name", "ms to write", "ms to parse")
    errors = list[str]()
    for domain, language in pairs:
        tasks = list(_sampled(domain, -(-options.count // len(pairs)), options.seed))
        writer, reader = instruction_writer_of(domain, language), instruction_writer_of(domain, language)
        begin = time.perf_counter()
        annotations = [writer.instructions(task, seed=options.seed) for task in tasks]
        middle = time.perf_counter()
        faults = [text for task, each in zip(tasks, annotations, strict=True) for text in _faults(reader, task, each)]
        end = time.perf_counter()
        errors += [f"{domain.name} {language}: {fault}" for fault in faults]
        named = sum(bool(each.named) for each in annotations)
        right = f"{100 * (1 - len({fault.split(':')[0] for fault in faults}) / len(tasks)):.6g} %"
        cost = ((middle - begin) / len(tasks), (end - middle) / len(tasks))
        costs = [f"{1e3 * each:.2f}" for each in cost]
        table.add_row(domain.name, language, str(len(tasks)), right, str(named), *costs)
    Console(width=120).print(table)
    for text in errors[:50]:
        Console().print(text, soft_wrap=True, highlight=False)
    sys.exit(bool(errors))


def _domains() -> list[Domain]:
    examples = sorted(each.parent for each in (ROOT / "examples").glob("*/domain.lp"))
    return [load_domain(each) for each in [*shipped_domains(), *examples]]


def _sampled(domain: Domain, number: int, seed: int) -> Iterator[Task]:
    """Yield tasks of all lengths, distinct at each length."""
    for place, length in enumerate(LENGTHS):
        share = number // len(LENGTHS) + (place < number % len(LENGTHS))
        yield from TaskSpace(domain, length).sample(share, seed=seed, weights={})


def _faults(reader: InstructionWriter, task: Task, annotation: Instructions) -> Iterator[str]:
    """Yield a description of each instruction that is not parsed back."""
    for level, text in {"vague": annotation.vague, "default": annotation.default, "exact": annotation.exact}.items():
        try:
            reading = reader.read(task, text)
        except PragError as error:
            yield f"{task}: {level}: {text} {error}"
            continue
        right = reading.goal == reader.goal(task) if level == "vague" else reading.actions == task.actions
        if not right:
            yield f"{task}: {level}: {text} parsed as {reading}"
    for number, (action, text) in enumerate(zip(task.actions, annotation.subgoals, strict=True)):
        try:
            read = reader.read(context_of(task, number), text).actions
        except PragError as error:
            yield f"{task}: subgoal {number + 1}: {text} {error}"
            continue
        if read != (action,):
            yield f"{task}: subgoal {number + 1}: {text} parsed as {read}"


if __name__ == "__main__":
    main()
