"""The check of a domain before use; every problem is one line: ``file:line: what is wrong; what to do``.

    syntax -> vocabulary, directives, recursion -> (clingo grounds the base part) -> unsatisfiable atoms
    -> hierarchy, effects -> composites, limits -> (`prag_asp.pruning`) -> occurrence -> open world -> settings

Learned invariants are checked separately, after all other stages.

A stage runs only if the previous stages found no errors, so each mistake is reported once. An error means that the
domain has no meaning, or that a count could be wrong. Anything else that looks wrong is a warning, which does not stop
the check.
"""

from prag_asp.lint.stages import Checked, check, check_learned, with_entities

__all__ = ["Checked", "check", "check_learned", "with_entities"]
