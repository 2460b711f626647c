"""Check a domain before it is used: every problem as one line ``file:line: what is wrong; what to do``.

    syntax -> vocabulary, directives, recursion -> (clingo grounds the base part) -> hierarchy, effects
    -> composites, limits -> occurrence, open_world -> execution, table

What was learned is checked after all of that, on its own.

A stage is only reached without problems in the stages before, so that one mistake is reported once.
"""

from prag_asp.lint.stages import check, check_learned

__all__ = ["check", "check_learned"]
