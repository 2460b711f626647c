"""Problems of BDDL for tests, in the grammars of LIBERO and BEHAVIOR-1K, and random ones."""

from __future__ import annotations

from hypothesis import strategies as st

from prag_asp.bddl import BddlFact, BddlFormula, BddlProblem, Connective, Quantifier, Region

TIDY = """(define (problem LIBERO_Test_Manipulation)
  (:domain robosuite)
  (:language Put the Left mug in the drawer, and close it)
    (:regions
      (left_region
          (:target kitchen_table)
          (:ranges (
              (-0.1 0.1 0.0 0.2)
            )
          )
          (:yaw_rotation (
              (0.0 pi/2)
            )
          )
      )
      (right_region (:target kitchen_table) (:ranges ((0.1 0.1 0.2 0.2))))
      (top_region (:target white_drawer_1))
      (bottom_region (:target white_drawer_1))
      (cook_region (:target flat_stove_1))
    )
  (:fixtures
    kitchen_table - kitchen_table
    white_drawer_1 - white_drawer
    flat_stove_1 - flat_stove
  )
  (:objects
    mug_1 mug_2 - mug
    plate_1 - plate
  )
  (:obj_of_interest mug_1 white_drawer_1)
  (:init
    (On mug_1 kitchen_table_left_region)
    (On mug_2 kitchen_table_right_region) ; to the right
    (On plate_1 kitchen_table_right_region)
    (Open white_drawer_1_top_region)
  )
  (:goal
    (And (In mug_1 white_drawer_1_top_region) (Close white_drawer_1_top_region))
  )
)
"""
"""A problem as LIBERO writes them."""

CAMP = """(define (problem pack_for_camping-0)
    (:domain omnigibson)
    (:objects
        bottle.n.01_1 bottle.n.01_2 - bottle.n.01
        crate.n.02_1 crate.n.02_2 - crate.n.02
        floor.n.01_1 - floor.n.01
        agent.n.01_1 - agent.n.01
    )
    (:init
        (ontop bottle.n.01_1 floor.n.01_1)
        (ontop bottle.n.01_2 floor.n.01_1)
        (ontop crate.n.02_1 floor.n.01_1)
        (ontop crate.n.02_2 floor.n.01_1)
        (not (open crate.n.02_1))
        (inroom floor.n.01_1 garage)
        (ontop agent.n.01_1 floor.n.01_1)
    )
    (:goal
        (and
            (forpairs (?bottle.n.01 - bottle.n.01) (?crate.n.02 - crate.n.02) (inside ?bottle.n.01 ?crate.n.02))
            (forall (?crate.n.02 - crate.n.02) (not (open ?crate.n.02)))
            (exists (?bottle.n.01 - bottle.n.01)
                (forn (1) (?crate.n.02 - crate.n.02) (inside ?bottle.n.01 ?crate.n.02)))
            (imply (inside ?bottle.n.01_1 ?crate.n.02_1) (or (ontop ?crate.n.02_1 ?floor.n.01_1)))
        )
    )
)
"""
"""A problem as BEHAVIOR-1K writes them."""

NAMES = st.sampled_from(["mug_1", "on", "in", "a0", "bottle.n.01", "x", "crate__of__milk.n.02_11", "main-table", "2_b"])
WORDS = st.sampled_from(["Put", "the", "mug's", "lid,", "what?"])
NUMBERS = st.floats(-10, 10, allow_nan=False)


@st.composite
def formulas(draw: st.DrawFn, names: list[str], scope: tuple[str, ...] = (), depth: int = 2) -> BddlFormula:
    """Draw a formula over names of objects and the variables of quantifiers around it."""
    kinds = ["fact"] if not depth else ["fact", "and", "or", "not", "imply", "forall", "exists", "forn", "forpairs"]
    kind = draw(st.sampled_from(kinds))
    if kind == "fact":
        terms = draw(st.lists(st.sampled_from([*names, *(f"?{each}" for each in scope)]), max_size=3))
        return BddlFact(draw(NAMES), tuple(term for term in terms if term not in scope))
    if kind in ("and", "or", "not", "imply"):
        size = {"not": 1, "imply": 2}.get(kind) or draw(st.integers(0, 3))
        return Connective(kind, tuple(draw(formulas(names, scope, depth - 1)) for _ in range(size)))
    count = 2 if kind == "forpairs" else 1
    variables = tuple((f"v{depth}{index}", draw(NAMES)) for index in range(count))
    part = draw(formulas(names, (*scope, *(name for name, _ in variables)), depth - 1))
    return Quantifier(kind, variables, part, draw(st.integers(0, 9)) if kind == "forn" else None)


@st.composite
def problems(draw: st.DrawFn) -> BddlProblem:
    """Draw a problem."""
    names = draw(st.lists(NAMES, min_size=1, max_size=5, unique=True))
    cut = draw(st.integers(0, len(names)))
    classes = {name: draw(NAMES) for name in names}
    rectangle = st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
    region = st.builds(
        Region, NAMES, st.sampled_from(names), st.lists(rectangle, max_size=2).map(tuple),
        st.none() | st.tuples(NUMBERS, NUMBERS),
    )  # fmt: skip
    facts = st.builds(BddlFact, NAMES, st.lists(st.sampled_from(names), max_size=2).map(tuple))
    ordered = [*dict.fromkeys(classes.values())]
    return BddlProblem(
        draw(NAMES), draw(NAMES), " ".join(draw(st.lists(WORDS, max_size=4))),
        {name: classes[name] for name in sorted(names[:cut], key=lambda name: ordered.index(classes[name]))},
        {name: classes[name] for name in sorted(names[cut:], key=lambda name: ordered.index(classes[name]))},
        tuple(draw(st.lists(region, max_size=3))), tuple(draw(st.lists(st.sampled_from(names), max_size=2))),
        tuple(draw(st.lists(st.tuples(facts, st.booleans()), max_size=4))), draw(formulas(names)),
    )  # fmt: skip
