"""Check a domain before it is used: every problem as one line ``file:line: what is wrong; what to do``.

    syntax -> vocabulary, directives, recursion -> (clingo grounds the base part) -> demands -> hierarchy, effects
    -> composites, limits -> occurrence -> execution -> open_world -> table

What was learned is checked after all of that, on its own.

A stage is only reached without errors in the stages before, so that one mistake is reported once. An error means that
the domain means nothing, or that a count could be wrong. What is merely strange is a warning, which stops nothing.
"""

from prag_asp.lint.stages import Checked, check, check_learned, with_entities

__all__ = ["Checked", "check", "check_learned", "with_entities"]
