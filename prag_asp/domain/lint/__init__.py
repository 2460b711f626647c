"""Check a domain before it is used: every problem as one line ``file:line: what is wrong; what to do``.

    syntax -> vocabulary, directives, recursion -> (clingo grounds the base part) -> hierarchy, effects
    -> composites, limits -> occurrence, open_world -> execution, table

A stage is only reached without problems in the stages before, so that one mistake is reported once.
"""

from prag_asp.domain.lint.stages import check

__all__ = ["check"]
