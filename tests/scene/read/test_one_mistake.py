"""One mistake in a scene gives one line, however much else depends on what is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import DomainError, load_domain

ROOT = Path(__file__).parents[3]
TRAY = "size = [0.30, 0.24, 0.035], wall = 0.006"
WHOLE_TRAY = f'tray = {{ kind = "container", {TRAY} }}\n'
CORNER = "{ x = [0.07, 0.15], y = [0.05, 0.13], z = [0, 0.1] }"
CASES = [
    ("domains/tabletop", TRAY, "size = [0.30, 0.24, 0.035], wall = 0.5", "scene.shapes.tray.wall: needs a thickness"),
    ("domains/tabletop", TRAY, "size = [0.30, 0.24], wall = 0.006", "scene.shapes.tray.size: needs three"),
    ("domains/tabletop", "size = [0.30, 0.24, 0.035]", "siez = [0.30, 0.24, 0.035]", "unknown key; did you mean size?"),
    ("domains/tabletop", "tray = { kind", "trai = { kind", "scene.shapes.trai: unknown class; did you mean tray?"),
    ("domains/tabletop", WHOLE_TRAY, "", "scene.fixed.tray_1: tray_1 has no shape; set scene.shapes.tray"),
    ("domains/tabletop", '{ kind = "robot" }', '{ kind = "robt" }', "unknown shape 'robt'; did you mean robot?"),
    ("domains/tabletop", "[scene.shapes]", "[[scene.shapes]]", "scene.shapes: needs a table"),
    ("domains/tabletop", "[scene.shapes]", "[scene.shaps]", "scene.shaps: unknown key; did you mean shapes?"),
    ("domains/kitchen", "size = [0.26, 0.24, 0.10]", 'size = "big"', "scene.shapes.drawer.size: needs three"),
    ("domains/tabletop", "size = [0.30, 0.24, 0.035]", "size = [1.90, 1.24, 0.035]", "is larger than the table"),
    (
        "domains/tabletop",
        "size = [0.30, 0.24, 0.035]",
        "size = [1.30, 1.24, 0.035]",
        "tray_1 is not wholly on the table",
    ),
    ("domains/tabletop", "size = [0.30, 0.24, 0.035]", "size = { low = [0.3, 0.2, 0.1] }", "size.high: missing"),
    ("domains/prag", "open =", "opne =", "scene.predicates.opne: there is no fluent opne; did you mean open?"),
    ("domains/two_arms", 'lies = "on_top"', 'lies = "holding"', "to be of the kind robot where it means holding"),
    (
        "examples/own_predicates",
        'sentence = "{0} {is} in a corner of {1}"\n',
        "",
        "in_corner.sentence: missing",
    ),
    ("domains/kitchen", "size = [0.26, 0.24, 0.10]", "size = [0.26, 0.24, 0.01]", "needs one size of at least 0.12"),
    ("domains/prag", "quarter_turn = 90", "quarter_turn = 1e300", "scene.rotations.quarter_turn: needs a yaw"),
    ("domains/two_arms", "base =", "bse =", "scene.robots.left.bse: unknown key; did you mean base?"),
    ("examples/own_predicates", CORNER, "{ x = 3 }", "scene.own.in_corner.boxes[0].x: needs a low and a high end"),
    ("examples/own_predicates", 'inside = "centre"', "inside = 3", "scene.own.in_corner.inside: needs one of"),
    ("examples/own_predicates", "sentence =", "sentnce =", "unknown key; did you mean sentence?"),
]


@pytest.mark.parametrize(("folder", "old", "new", "message"), CASES)
def test_one_mistake_gives_one_line(tmp_path: Path, folder: str, old: str, new: str, message: str) -> None:
    for file in (ROOT / folder).glob("*.*"):
        text = file.read_text()
        if file.name == "domain.toml":
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / file.name).write_text(text)
    with pytest.raises(DomainError) as caught:
        load_domain(tmp_path)
    (line,) = str(caught.value).splitlines()
    assert message in line and line.startswith(f"{tmp_path}/domain.toml:")


def test_two_mistakes_give_two_lines(tmp_path: Path) -> None:
    text = (ROOT / "domains/tabletop/domain.toml").read_text()
    (tmp_path / "domain.lp").write_text((ROOT / "domains/tabletop/domain.lp").read_text())
    (tmp_path / "domain.toml").write_text(text.replace(TRAY, "size = 3, wall = 0").replace("radius = ", "raduis = "))
    with pytest.raises(DomainError) as caught:
        load_domain(tmp_path)
    message = [line.split(": ")[1] for line in str(caught.value).splitlines()]
    assert sorted(message) == ["scene.shapes.can.raduis", "scene.shapes.tray.size", "scene.shapes.tray.wall"]


def test_an_unknown_class_of_several_entities_is_one_mistake(tmp_path: Path) -> None:
    for file in (ROOT / "domains/tabletop").glob("*.*"):
        (tmp_path / file.name).write_text(file.read_text().replace("cube_2), cube)", "cube_2), kube)"))
    with pytest.raises(DomainError) as caught:
        load_domain(tmp_path)
    (line,) = str(caught.value).splitlines()
    assert line.endswith("domain.lp:16: unknown class kube of cube_1, cube_2; did you mean cube?")
