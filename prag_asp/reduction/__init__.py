"""Small-model reduction: a domain with many interchangeable entities is grounded with only a few of them.

Theorem: let the author's statements treat m entities alike and satisfy the restrictions in `applicability`. Then the
tasks and skeletons of length n are the same, up to renaming, for every m of at least `EntityBound.needed(n)`. A task
that names j of the entities stands for m (m - 1) ... (m - j + 1) plans, which gives the number of plans. The premises
are checked on the statements and on a program with few entities. The proof is in
docs/explanations/small_model_reduction.md.

    applicability    the first statement to which the theorem does not apply
    alike_entities   the groups of entities that the statements treat alike, and the program without some of them
    reduction        how many entities of each group plans of a length need, and the program with only these

`domain.load` looks for a reduction before it grounds anything large. `space.reduced_count` counts with a reduction.
"""
