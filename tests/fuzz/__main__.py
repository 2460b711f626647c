"""Run a campaign of mutants: ``python -m tests.fuzz --count 10000 [--seed S]``."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from time import monotonic

from tests.fuzz.campaign import Finding, keep, trials
from tests.fuzz.isolated import Limits, warm
from tests.fuzz.kinds import KINDS, mutant
from tests.fuzz.shrink import shrunk

SHOWN = 2000
"""Characters of a file of a finding that are printed."""


def main(arguments: list[str] | None = None) -> int:
    """Run the campaign, and return 1 where something is wrong."""
    asked = _parsed(arguments)
    warm()
    limits = Limits(asked.seconds, asked.memory)
    numbers = [asked.only] if asked.only is not None else range(asked.first, asked.first + asked.count)
    mutants = (mutant(number, asked.seed, tuple(asked.kind)) for number in numbers)
    kept: dict[str, Finding] = {}
    seen: Counter[str] = Counter()
    tried: Counter[str] = Counter()
    begun = monotonic()
    for done in trials(mutants, asked.jobs, limits):
        tried.update({"mutants": 1, "commands": done.commands, "accepted": done.accepted, done.mutant.kind: 1})
        if done.finding:
            seen[done.finding.signature] += 1
            kept.setdefault(done.finding.signature, done.finding)
            if asked.verbose:
                print(f"{done.mutant.name}: {done.finding.what[:200]}", flush=True)
            elif seen[done.finding.signature] == 1:
                keep(done.finding, asked.findings)
    for finding in kept.values():
        _show(finding if asked.as_found else shrunk(finding, limits), asked.findings)
    kinds = ", ".join(f"{tried[kind]} {kind}" for kind in KINDS if tried[kind])
    faults = ", ".join(f"{number} {signature}" for signature, number in seen.most_common()) or "nothing is wrong"
    print(
        f"\n{tried['mutants']} mutants of the seed {asked.seed} ({kinds}), {tried['commands']} commands, "
        f"{tried['accepted']} accepted, {monotonic() - begun:.0f} s: {faults}"
    )
    return 1 if seen else 0


def _parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=500, help="How many mutants.")
    parser.add_argument("--first", type=int, default=0, help="The number of the first of them.")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int, metavar="NUMBER", help="One mutant of the campaign.")
    parser.add_argument("--kind", action="append", default=[], choices=list(KINDS))
    parser.add_argument("--jobs", type=int, default=2, help="How many at once.")
    parser.add_argument("--seconds", type=float, default=Limits.seconds, help="What one command may take.")
    parser.add_argument("--memory", type=int, default=Limits.memory_bytes, help="Bytes that one command may take.")
    parser.add_argument("--findings", type=Path, default=Path("findings"), help="Folder for what is found.")
    parser.add_argument("--as-found", action="store_true", help="Make no finding smaller.")
    parser.add_argument("--verbose", action="store_true", help="Print a line for each finding as it comes.")
    return parser.parse_args(arguments)


def _show(finding: Finding, folder: Path) -> None:
    """Keep a finding, and print how to see it again."""
    own = keep(finding, folder)
    print(f"\n{finding.mutant.name}: {finding.what[:500]}")
    print(f"  sh {own}/run.sh    # prag-asp {' '.join(map(repr, finding.arguments))[:500]}")
    print(f"  {finding.ran.seconds:.1f} s, {finding.ran.peak_bytes / 1e6:.0f} MB, code {finding.ran.code}")
    for name, content in finding.mutant.files.items():
        if len(content) <= SHOWN and content.isascii():
            print(f"  -- {name}\n" + "\n".join(f"     {line}" for line in content.decode().splitlines()))
    for name, what in finding.mutant.special.items():
        print(f"  -- {name}: {what}")
    err = finding.ran.err.decode("utf-8", "replace")[-SHOWN:]
    print("  -- stderr\n" + "\n".join(f"     {line!r}" for line in err.splitlines()[-8:]), flush=True)


if __name__ == "__main__":
    sys.exit(main())
