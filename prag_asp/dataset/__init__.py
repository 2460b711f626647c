"""Datasets of tasks: filter tasks by physics, validate them again, read and write files, and export datasets.

>>> from itertools import islice
>>> from prag_asp import TaskSpace, load_domain
>>> from prag_asp.dataset import feasible
>>> [str(record.task) for record in islice(feasible(TaskSpace(load_domain("tabletop"), length=1), seed=7), 1)]
['place(panda,can_1,in_front_of,tray_1)']
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prag_asp.lazy import names_from

if TYPE_CHECKING:
    from prag_asp.dataset.dataset_spec import ApartSpec, DatasetSpec
    from prag_asp.dataset.formats.exporting import export
    from prag_asp.dataset.generation import generate
    from prag_asp.dataset.jsonl import Record, read_lines, read_tasks, write_line
    from prag_asp.dataset.language.instruction_reader import Reading, read_instruction
    from prag_asp.dataset.language.instruction_writer import Instructions, InstructionWriter, instruction_writer_of
    from prag_asp.dataset.language.plain import instruction
    from prag_asp.dataset.learned_rules import Learned, learn
    from prag_asp.dataset.merging import merge
    from prag_asp.dataset.pass_rates import Tally
    from prag_asp.dataset.physics_filter import feasible
    from prag_asp.dataset.revalidation import Outcome, recheck
    from prag_asp.dataset.scenario import Scenario, SearchStart
    from prag_asp.dataset.scenarios import Scenarios, exclude, read_scenarios
    from prag_asp.dataset.store.entry import DatasetEntry
    from prag_asp.dataset.strata.stratified_sampling import StratifiedSample, stratified_sample
    from prag_asp.dataset.strata.stratum_figures import StratumFigures
    from prag_asp.dataset.suites.counting import count_suite
    from prag_asp.dataset.suites.suite_builder import generate_suite
    from prag_asp.dataset.suites.suite_reader import load_suite
    from prag_asp.dataset.suites.suite_spec import Suite
    from prag_asp.dataset.suites.verifying import verify
    from prag_asp.dataset.verification.finding import Finding
    from prag_asp.space.strata.allocation import Stratification

__all__ = [
    "ApartSpec",
    "DatasetEntry",
    "DatasetSpec",
    "Finding",
    "InstructionWriter",
    "Instructions",
    "Learned",
    "Outcome",
    "Reading",
    "Record",
    "Scenario",
    "Scenarios",
    "SearchStart",
    "Stratification",
    "StratifiedSample",
    "StratumFigures",
    "Suite",
    "Tally",
    "count_suite",
    "exclude",
    "export",
    "feasible",
    "generate",
    "generate_suite",
    "instruction",
    "instruction_writer_of",
    "learn",
    "load_suite",
    "merge",
    "read_instruction",
    "read_lines",
    "read_scenarios",
    "read_tasks",
    "recheck",
    "stratified_sample",
    "verify",
    "write_line",
]

_HOMES = {
    "prag_asp.dataset.physics_filter": ("feasible",),
    "prag_asp.dataset.dataset_spec": ("ApartSpec", "DatasetSpec"),
    "prag_asp.dataset.formats.exporting": ("export",),
    "prag_asp.dataset.generation": ("generate",),
    "prag_asp.dataset.jsonl": ("Record", "read_lines", "read_tasks", "write_line"),
    "prag_asp.dataset.language.plain": ("instruction",),
    "prag_asp.dataset.language.instruction_reader": ("Reading", "read_instruction"),
    "prag_asp.dataset.language.instruction_writer": ("Instructions", "InstructionWriter", "instruction_writer_of"),
    "prag_asp.dataset.learned_rules": ("Learned", "learn"),
    "prag_asp.dataset.merging": ("merge",),
    "prag_asp.dataset.revalidation": ("Outcome", "recheck"),
    "prag_asp.dataset.scenario": ("Scenario", "SearchStart"),
    "prag_asp.dataset.scenarios": ("Scenarios", "exclude", "read_scenarios"),
    "prag_asp.dataset.store.entry": ("DatasetEntry",),
    "prag_asp.dataset.strata.stratum_figures": ("StratumFigures",),
    "prag_asp.dataset.strata.stratified_sampling": ("StratifiedSample", "stratified_sample"),
    "prag_asp.space.strata.allocation": ("Stratification",),
    "prag_asp.dataset.suites.counting": ("count_suite",),
    "prag_asp.dataset.suites.suite_builder": ("generate_suite",),
    "prag_asp.dataset.suites.suite_reader": ("load_suite",),
    "prag_asp.dataset.suites.suite_spec": ("Suite",),
    "prag_asp.dataset.suites.verifying": ("verify",),
    "prag_asp.dataset.pass_rates": ("Tally",),
    "prag_asp.dataset.verification.finding": ("Finding",),
}

__getattr__ = names_from(__name__, _HOMES)


def __dir__() -> list[str]:
    return __all__
