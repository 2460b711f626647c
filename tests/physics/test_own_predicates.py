"""Predicates of a domain's own: read, refused, trusted, searched for, checked, in one process and in two."""

from __future__ import annotations

import math
import pickle
import random
from dataclasses import replace
from pathlib import Path

import pytest

from prag_asp import Domain, SceneError, TaskSpace, load_domain
from prag_asp.domain.atom import parse_atom
from prag_asp.domain.scene import Box, Own, Scene, Shape, load_scene, parse_scene
from prag_asp.physics import Budget, check_witness, open_validator, validate_tasks
from prag_asp.physics.facts import facts, problem
from prag_asp.physics.geometry import Pose, yaw_of
from prag_asp.physics.predicates import Volume, own_predicates, predicate_of
from prag_asp.physics.search.spans import foresee_spans
from prag_asp.physics.search.start import order_of
from prag_asp.physics.situation import Situation
from tests.physics.scenarios import state, task

STUDIO = Path(__file__).parents[2] / "examples" / "own_predicates"
PAIR = ("object", "object")
SHAPES = {
    "panda": Shape("robot"),
    "table_1": Shape("table"),
    "cup_1": Shape("cylinder", (0.06, 0.06, 0.08)),
    "cup_2": Shape("cylinder", (0.06, 0.06, 0.08)),
    "brick_1": Shape("box", (0.11, 0.05, 0.04)),
    "camera_1": Shape("box", (0.1, 0.05, 0.06)),
}


@pytest.fixture(scope="module")
def studio() -> Domain:
    return load_domain(STUDIO, trust=True)


def written(folder: Path, text: str, arguments: tuple[str, ...] = PAIR) -> Scene:
    """Return a trusted scene with one predicate `odd` of a Python file with this text."""
    path = folder / "own.py"
    path.write_text(text)
    return Scene(shapes=SHAPES, own={"odd": Own("odd", arguments, file=str(path))}, trusted=True)


def table_with(own: dict[str, object], **more: object) -> dict[str, object]:
    cube = {"kind": "box", "size": [0.05, 0.05, 0.05]}
    return {"shapes": {"robot": {"kind": "robot"}, "cube": cube}, "own": own, **more}


BOX = {"x": [0.0, 0.1]}
FINE = {"arguments": ["object", "object"], "boxes": [BOX], "sentence": "{0} {is} odd to {1}"}


def test_a_table_of_boxes_becomes_a_predicate_with_its_bounds() -> None:
    own = {**FINE, "boxes": [{"x": [0, 0.1], "z": [-0.5, float("inf")]}], "inside": "whole"}
    scene = parse_scene(
        table_with({"odd": own}, predicates={"strange": "odd"}),
        {},
        {"panda": "robot", "cube_1": "cube", "cube_2": "cube"},
    )
    inf = float("inf")
    box = Box((0.0, -inf, -0.5), (0.1, inf, inf))
    assert scene.own["odd"] == Own("odd", PAIR, (box,), whole=True, sentence="{0} {is} odd to {1}")
    assert scene.meaning(parse_atom("strange(cube_1,cube_2)")) == "odd"
    (fact,) = facts(scene, {parse_atom("strange(cube_1,cube_2)"): False})
    assert fact.sentence() == "cube 1 is not odd to cube 2"


@pytest.mark.parametrize(
    ("own", "message"),
    [
        (3, "scene.own: needs a table for each predicate"),
        ({"odd": 3}, "scene.own.odd: needs a table with arguments"),
        ({"near": FINE}, "scene.own.near: near is there already; choose another name"),
        ({"Odd": FINE}, "scene.own.Odd: is no name of a fluent"),
        ({"odd": {"arguments": ["object"]}}, "scene.own.odd: has neither boxes nor python"),
        ({"odd": {**FINE, "python": "a.py"}}, "scene.own.odd: has boxes and python; define it by one of them"),
        ({"odd": {**FINE, "box": 1}}, "scene.own.odd.box: unknown key; did you mean boxes?"),
        ({"odd": {**FINE, "arguments": "object"}}, "scene.own.odd.arguments: needs a list of object, robot, rotation"),
        ({"odd": {**FINE, "arguments": ["cube"]}}, "scene.own.odd.arguments: needs a list"),
        ({"odd": {**FINE, "arguments": ["robot", "object"]}}, "scene.own.odd.arguments: of boxes can only be objects"),
        ({"odd": {**FINE, "arguments": ["object"]}}, "scene.own.odd.arguments: need two objects"),
        ({"odd": {**FINE, "around": "cube_1"}}, "scene.own.odd.around: stands in for a second argument"),
        (
            {"odd": {**FINE, "arguments": ["object"], "around": "cube_9"}},
            "scene.own.odd.around: unknown entity; did you mean cube_",
        ),
        ({"odd": {**FINE, "inside": "half"}}, "scene.own.odd.inside: needs one of centre, whole"),
        ({"odd": {**FINE, "boxes": []}}, "scene.own.odd.boxes: needs a list of boxes"),
        ({"odd": {**FINE, "boxes": [BOX, {}]}}, "scene.own.odd.boxes.2: needs a table like"),
        ({"odd": {**FINE, "boxes": [{"w": [0, 1]}]}}, "scene.own.odd.boxes.1.w: unknown key"),
        ({"odd": {**FINE, "boxes": [{"x": [1, 0]}]}}, "scene.own.odd.boxes.1.x: needs a low and a high end"),
        ({"odd": {**FINE, "boxes": [{"x": [0, float("nan")]}]}}, "scene.own.odd.boxes.1.x: needs a low and a high"),
        ({"odd": {**FINE, "boxes": [{"x": ["a", True]}]}}, "scene.own.odd.boxes.1.x: needs a low and a high end"),
        ({"odd": {**FINE, "sentence": 3}}, "scene.own.odd.sentence: needs a sentence like"),
        ({"odd": {**FINE, "sentence": "{0} {is} {2}"}}, "scene.own.odd.sentence: has braces that name no argument"),
        ({"odd": {**FINE, "sentence": "{0} {is"}}, "scene.own.odd.sentence: has braces that name no argument"),
        ({"odd": {**FINE, "sentence": "{0} lies"}}, "scene.own.odd.sentence: needs {0}, and {is} for is or is not"),
        ({"odd": {"arguments": ["object"], "python": "../a.py"}}, "scene.own.odd.python: ../a.py lies outside"),
        ({"odd": {"arguments": ["object"], "python": "a.txt"}}, "scene.own.odd.python: needs the name of a Python"),
        ({"odd": {"arguments": ["object"], "python": "no.py"}}, "scene.own.odd.python: no.py is not in the folder"),
    ],
)
def test_a_malformed_predicate_is_refused_with_its_key(own: object, message: str, tmp_path: Path) -> None:
    entities = {"panda": "robot", "cube_1": "cube", "cube_2": "cube"}
    with pytest.raises(SceneError) as caught:
        parse_scene(table_with(own), {}, entities, folder=tmp_path)  # type: ignore[arg-type]
    assert str(caught.value).startswith(message)


def test_a_link_out_of_the_folder_of_the_domain_is_refused(tmp_path: Path) -> None:
    (tmp_path / "outside.py").write_text("PREDICATES = {}")
    folder = tmp_path / "domain"
    folder.mkdir()
    (folder / "inside.py").symlink_to(tmp_path / "outside.py")
    own = {"odd": {"arguments": ["object"], "python": "inside.py"}}
    with pytest.raises(SceneError, match=r"inside\.py lies outside of the folder of the domain; move it there"):
        parse_scene(table_with(own), {}, {"panda": "robot", "cube_1": "cube"}, folder=folder)


def test_a_python_file_is_run_only_where_it_is_trusted(tmp_path: Path) -> None:
    ran = tmp_path / "ran"
    for name in ("domain.lp", "domain.toml"):
        (tmp_path / name).write_text((STUDIO / name).read_text())
    text = (STUDIO / "predicates.py").read_text()
    (tmp_path / "predicates.py").write_text(f"{text}\nopen({str(ran)!r}, 'w').close()\n")
    domain = load_domain(tmp_path)
    assert TaskSpace(domain, 3).count() == 280
    scene = load_scene(domain)
    with pytest.raises(
        SceneError, match=r"predicates\.py:1: defines looks_at in Python, .*; read the file, then add --trust"
    ):
        own_predicates(scene)
    assert not ran.exists()
    trusted = load_scene(load_domain(tmp_path, trust=True))
    assert set(own_predicates(trusted)) == {
        "in_corner",
        "on_the_left",
        "looks_at",
    }
    assert ran.exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\ny = = 2\n", r"own\.py:2: SyntaxError: .*; mend the file"),
        ("x = 1\n\nraise ValueError('no\\nway')\n", r"own\.py:3: ValueError: no way; mend the file"),
        ("import sys\nsys.exit(3)\n", r"own\.py:2: SystemExit: 3; mend the file"),
        ("import no_such_module\n", r"own\.py:1: ModuleNotFoundError: No module named 'no_such_module'"),
        ("x = 1\n", r"own\.py:1: defines no PREDICATES; write PREDICATES = "),
        ("PREDICATES = [1]\n", r"own\.py:1: defines no PREDICATES"),
        ("PREDICATES = {'even': 1}\n", r"own\.py:1: PREDICATES has no odd; it has even"),
        ("PREDICATES = {'odd': 1}\n", r"own\.py:1: PREDICATES\['odd'\] has to be a Predicate of that name; got 1"),
        (
            "from prag_asp.physics import PREDICATES\nPREDICATES = {'odd': PREDICATES['near']}\n",
            r"has to be a Predicate of that name; got one of the name near",
        ),
        (
            "from dataclasses import replace\nfrom prag_asp.physics import PREDICATES\n"
            "PREDICATES = {'odd': replace(PREDICATES['near'], name='odd', subject=2)}\n",
            r"odd has the subject 2, but 2 arguments",
        ),
    ],
)
def test_a_python_file_that_fails_is_told_in_one_line_with_its_place(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=message) as caught:
        predicate_of(written(tmp_path, text), "odd")
    assert "\n" not in str(caught.value)


ODD = """
from prag_asp.physics.predicates import Predicate, Volume, states

def violations(situation, arguments):
    yield {violation}

def volume(situation, arguments, quaternion):
    return {volume}

PREDICATES = {{"odd": Predicate("odd", violations, volume, states("{{0}} {{is}} odd"))}}
"""


@pytest.mark.parametrize(
    ("violation", "volume", "message"),
    [
        ("1 / 0", "Volume()", r"own\.py:5: odd: ZeroDivisionError: division by zero; mend the file"),
        ("__import__('sys').exit(0)", "Volume()", r"own\.py:5: odd: SystemExit: 0; mend the file"),
        ("float('nan')", "Volume()", r"own\.py:1: odd: .* returned \[nan\]"),
        ("'near'", "Volume()", r"returned \['near'\]"),
        ("0.0", "None", r"own\.py:1: odd: volume returned None"),
        ("0.0", "Volume(low=(float('nan'), 0.0, 0.0))", "volume returned Volume"),
        ("0.0", "situation.pose(arguments[7])", r"own\.py:8: odd: IndexError: tuple index out of range"),
    ],
)
def test_what_goes_wrong_in_a_function_of_a_file_is_told_with_its_line(
    violation: str, volume: str, message: str, tmp_path: Path
) -> None:
    predicate = predicate_of(written(tmp_path, ODD.format(violation=violation, volume=volume)), "odd")
    situation = Situation(Scene(shapes=SHAPES), {"cup_1": Pose((0.5, 0.0, 0.04))}, Pose((0.0, 0.0, 1.0)), 0.0)
    with pytest.raises(SceneError, match=message):
        predicate.distance(situation, ("cup_1", "cup_1"))
        predicate.volume(situation, ("cup_1", "cup_1"), (0.0, 0.0, 0.0, 1.0))


def test_a_scene_with_own_predicates_goes_to_other_processes(studio: Domain) -> None:
    scene = load_scene(studio)
    assert pickle.loads(pickle.dumps(scene)) == scene
    tasks = TaskSpace(studio, 4).sample(8, seed=2)
    one, two = (list(validate_tasks(tasks, scene, seed=2, workers=workers)) for workers in (1, 2))
    assert one == two
    assert sum(verdict.feasible for verdict in one) >= 7


def test_tasks_with_own_predicates_are_found_and_their_witnesses_pass(studio: Domain) -> None:
    scene = load_scene(studio)
    tasks = TaskSpace(studio, 4).sample(25, seed=5)
    used = {fact.predicate.name for each in tasks for effect in problem(each, scene).effects for fact in effect.fresh}
    assert {"in_corner", "on_the_left", "looks_at", "between"} <= used
    with open_validator(scene) as validator:
        verdicts = [validator.validate(each, seed=5, index=i) for i, each in enumerate(tasks)]
    assert sum(verdict.feasible for verdict in verdicts) >= 23
    for each, verdict in zip(tasks, verdicts, strict=True):
        if verdict.feasible:
            assert check_witness(each, verdict.witness, scene) == []


def test_what_a_relation_refers_to_is_put_down_before_its_subject_as_far_as_there_is_no_circle() -> None:
    scene = Scene(shapes=SHAPES)

    def order(*fluents: str) -> list[str]:
        return order_of(problem(task(state(*fluents)), scene), scene)

    assert order("between(brick_1,cup_1,cup_2)", "on_top(cup_1,camera_1)") == ["camera_1", "cup_1", "cup_2", "brick_1"]
    assert order("near(cup_1,brick_1)", "near(brick_1,cup_2)") == ["brick_1", "cup_1", "cup_2"]
    circle = order("between(brick_1,cup_1,cup_2)", "between(cup_1,brick_1,cup_2)", "on_top(brick_1,cup_1)")
    assert circle.index("cup_1") < circle.index("brick_1")


@pytest.mark.parametrize(("larger", "fits"), [(0.0, True), (0.0035, True), (0.0045, False)])
def test_a_body_as_large_as_its_box_is_in_it_up_to_the_tolerance(larger: float, fits: bool) -> None:
    box = Box((0.1, -0.2, 0.0), (0.21 - larger, -0.15, 0.04))  # the brick is 110 x 50 x 40 mm
    own = Own("odd", PAIR, (box,), whole=True, sentence="{0} {is} in {1}")
    predicate = predicate_of(Scene(shapes=SHAPES, own={"odd": own}), "odd")
    turned = (0.0, 0.0, math.sin(0.4), math.cos(0.4))
    poses = {"camera_1": Pose((0.5, 0.1, 0.03), turned)}
    situation = Situation(Scene(shapes=SHAPES), poses, Pose((0.0, 0.0, 1.0)), 0.0)
    floor = (
        predicate.volume(situation, ("brick_1", "camera_1"), turned).meet(Volume((0, -1, 0.02), (1, 1, 0.02))).floor()
    )
    assert (floor is not None) == fits
    if floor is not None:
        at = Volume.draw(floor, random.Random(1).uniform)
        assert at is not None
        assert predicate.distance(situation.with_pose("brick_1", Pose(at, turned)), ("brick_1", "camera_1")) == 0.0


def test_a_first_state_goes_back_to_what_leaves_no_room(studio: Domain, monkeypatch: pytest.MonkeyPatch) -> None:
    # The brick and the camera, which are put down first, are seldom near enough for a cup to be near both.
    both = task(state("near(cup_1,brick_1)", "near(camera_1,cup_1)", "-near(brick_1,camera_1)"), ("wait(panda)", {}))

    def found() -> int:
        with open_validator(load_scene(studio)) as validator:
            return sum(validator.validate(both, seed=seed, budget=Budget(1, 1)).feasible for seed in range(40))

    often = found()
    assert often >= 34
    monkeypatch.setattr("prag_asp.physics.search.start.BACKTRACKS", 0)
    assert found() < often


def test_two_objects_leave_room_for_what_comes_between_them_later(studio: Domain) -> None:
    scene = load_scene(studio)
    row = task(
        state("holding(panda,brick_1)"),
        ("set(panda,brick_1)", state("-holding(panda,brick_1)", "between(brick_1,cup_1,cup_2)")),
        ("pick(panda,camera_1)", state("holding(panda,camera_1)")),
        ("set(panda,camera_1)", state("-holding(panda,camera_1)", "between(camera_1,brick_1,cup_2)")),
        ("pick(panda,cup_1)", state("holding(panda,cup_1)")),
        forget=("between(brick_1,cup_1,cup_2)", "between(camera_1,brick_1,cup_2)"),
    )
    spans = foresee_spans(problem(row, scene), scene)
    assert set(spans) == {(0, "cup_1"), (0, "cup_2"), (1, "brick_1")}
    (cups,), (brick,) = spans[0, "cup_1"], spans[1, "brick_1"]
    assert cups.other == brick.other == "cup_2"
    gap = 0.005 + 2 * 0.003
    assert brick.enough == pytest.approx(0.025 + 2 * 0.025 + 0.03 + 2 * gap)
    assert cups.enough == pytest.approx(0.03 + 0.025 + gap + brick.enough)
    assert cups.ample > cups.enough
    with open_validator(scene) as validator:
        verdicts = [validator.validate(row, seed=seed, budget=Budget(2, 10)) for seed in range(20)]
    assert sum(verdict.feasible for verdict in verdicts) >= 18


def test_what_is_held_moves_where_another_is_the_subject_of_the_relation(studio: Domain) -> None:
    scene = load_scene(studio)
    looked_at = task(
        state("holding(panda,cup_1)", "on_top(camera_1,table_1)"),
        ("show(panda,cup_1)", state("-holding(panda,cup_1)", "on_top(cup_1,table_1)", "looks_at(camera_1,cup_1)")),
    )
    assert problem(looked_at, scene).effects[0].moved == ("cup_1",)
    with open_validator(scene) as validator:
        verdict = validator.validate(looked_at, seed=1)
    assert verdict.feasible
    first, second = verdict.witness.moments
    assert first.poses["camera_1"] == second.poses["camera_1"]


def test_nothing_is_in_a_relation_to_itself(studio: Domain) -> None:
    scene = load_scene(studio)
    with open_validator(scene) as validator:
        for fluents, words in (
            (["near(cup_1,cup_1)"], "nothing is in a relation to itself"),
            (["near(cup_1,cup_2)", "far(cup_2,cup_1)"], "cup_1 cannot be near and far at once"),
        ):
            verdict = validator.validate(task(state(*fluents), ("wait(panda)", state("upright(cup_1)"))), seed=0)
            assert verdict.status == "infeasible" and words in verdict.reason.replace("cup_2 and cup_1", "cup_1")
        fine = task(state("-near(cup_1,cup_1)", "near(cup_1,cup_2)"), ("wait(panda)", {}))
        assert validator.validate(fine, seed=0).feasible


def test_relations_are_searched_for_together(studio: Domain) -> None:
    scene = load_scene(studio)
    arranged = task(
        state(
            "aligned(brick_1,camera_1)", "near(brick_1,camera_1)", "far(cup_1,brick_1)", "near(cup_2,cup_1)",
            "upright(cup_1)", "-aligned(cup_2,cup_1)", "-near(cup_2,camera_1)",
        ),
        ("wait(panda)", {}),
    )  # fmt: skip
    with open_validator(scene) as validator:
        verdict = validator.validate(arranged, seed=3)
    assert verdict.feasible and check_witness(arranged, verdict.witness, scene) == []
    poses = verdict.witness.moments[0].poses
    turn = 4 * (yaw_of(poses["brick_1"].quaternion) - yaw_of(poses["camera_1"].quaternion))
    assert math.cos(turn) >= math.cos(math.radians(4 * 5))


@pytest.mark.parametrize("fluent", ["near(apple_1,can_1)", "between(apple_1,can_1,box_1)", "over(apple_1,bowl_1)"])
def test_what_is_carried_is_brought_where_the_relation_holds_in_the_air(fluent: str, prag: Scene) -> None:
    box = Box((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    scene = replace(prag, own={"over": Own("over", PAIR, (box,), sentence="{0} {is} over {1}")})
    carried = task(
        state("-at(panda,apple_1)", "open(panda)"),
        ("approach(panda,apple_1)", state("at(panda,apple_1)")),
        ("grasp(panda,apple_1)", state("holding(panda,apple_1)", "-open(panda)")),
        ("move(panda,apple_1)", state(fluent)),
    )
    with open_validator(scene) as validator:
        verdict = validator.validate(carried, seed=1)
    assert verdict.feasible and check_witness(carried, verdict.witness, scene) == []
    assert verdict.witness.moments[-1].poses["apple_1"].position[2] > 0.1
