"""Tables of a domain's own predicates: read into boxes, or refused with the key that is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import SceneError
from prag_asp.atom import parse_atom
from prag_asp.physics.symbolic_facts import facts
from prag_asp.scene.scene import BoxBounds, Own
from prag_asp.scene.scene_loader import parse_scene

PAIR = ("object", "object")


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
    box = BoxBounds((0.0, -inf, -0.5), (0.1, inf, inf))
    assert scene.own["odd"] == Own("odd", PAIR, (box,), whole=True, sentence="{0} {is} odd to {1}")
    assert scene.meaning(parse_atom("strange(cube_1,cube_2)")) == "odd"
    (fact,) = facts(scene, {parse_atom("strange(cube_1,cube_2)"): False})
    assert fact.sentence() == "cube 1 is not odd to cube 2"


@pytest.mark.parametrize(
    ("own", "message"),
    [
        (3, "scene.own: needs a table for each predicate"),
        ({"odd": 3}, "scene.own.odd: needs a table with arguments"),
        ({"near": FINE}, "scene.own.near: near already exists; choose another name"),
        ({"Odd": FINE}, "scene.own.Odd: is not a valid name of a fluent"),
        ({"odd": {"arguments": ["object"]}}, "scene.own.odd: has neither boxes nor python"),
        ({"odd": {**FINE, "python": "a.py"}}, "scene.own.odd: has boxes and python; give one of the two"),
        ({"odd": {**FINE, "box": 1}}, "scene.own.odd.box: unknown key; did you mean boxes?"),
        ({"odd": {**FINE, "arguments": "object"}}, "scene.own.odd.arguments: needs a list of object, robot, rotation"),
        ({"odd": {**FINE, "arguments": ["cube"]}}, "scene.own.odd.arguments: needs a list"),
        (
            {"odd": {**FINE, "arguments": ["robot", "object"]}},
            "scene.own.odd.arguments: are robot, obj",
        ),
        ({"odd": {**FINE, "arguments": ["object"]}}, "scene.own.odd.arguments: needs two objects"),
        ({"odd": {**FINE, "around": "cube_1"}}, "scene.own.odd.around: replaces the second argument"),
        (
            {"odd": {**FINE, "arguments": ["object"], "around": "cube_9"}},
            "scene.own.odd.around: unknown entity; did you mean cube_",
        ),
        ({"odd": {**FINE, "inside": "half"}}, "scene.own.odd.inside: needs one of centre, whole"),
        ({"odd": {**FINE, "boxes": []}}, "scene.own.odd.boxes: needs a list of boxes"),
        ({"odd": {**FINE, "boxes": [BOX, {}]}}, "scene.own.odd.boxes[1]: needs a table like"),
        ({"odd": {**FINE, "boxes": [{"w": [0, 1]}]}}, "scene.own.odd.boxes[0].w: unknown key"),
        ({"odd": {**FINE, "boxes": [{"x": [1, 0]}]}}, "scene.own.odd.boxes[0].x: needs a low and a high end"),
        ({"odd": {**FINE, "boxes": [{"x": [0, float("nan")]}]}}, "scene.own.odd.boxes[0].x: needs a low and a high"),
        ({"odd": {**FINE, "boxes": [{"x": ["a", True]}]}}, "scene.own.odd.boxes[0].x: needs a low and a high end"),
        ({"odd": {**FINE, "sentence": 3}}, "scene.own.odd.sentence: needs a sentence like"),
        ({"odd": {**FINE, "sentence": "{0} {is} {2}"}}, "scene.own.odd.sentence: has braces that name no argument"),
        ({"odd": {**FINE, "sentence": "{0} {is"}}, "scene.own.odd.sentence: has braces that name no argument"),
        ({"odd": {**FINE, "sentence": "{0} lies"}}, "scene.own.odd.sentence: lacks {0} or {is}"),
        ({"odd": {"arguments": ["object"], "python": "../a.py"}}, "scene.own.odd.python: ../a.py is outside"),
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
    with pytest.raises(SceneError, match=r"inside\.py is outside the folder of the domain; move it there"):
        parse_scene(table_with(own), {}, {"panda": "robot", "cube_1": "cube"}, folder=folder)
