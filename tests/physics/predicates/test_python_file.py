"""Python files with a domain's own predicates: trusted or not run, and told in one line where they fail."""

from __future__ import annotations

from pathlib import Path

import pytest

from prag_asp import SceneError, TaskSpace, load_domain
from prag_asp.domain.load import load_scene
from prag_asp.physics.predicates import own_predicates, predicate_of
from prag_asp.physics.situation import Situation
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Own, Scene
from tests.physics.scenarios import STUDIO
from tests.physics.scenarios import STUDIO_SHAPES as SHAPES

PAIR = ("object", "object")


def written(folder: Path, text: str, arguments: tuple[str, ...] = PAIR) -> Scene:
    """Return a trusted scene with one predicate `odd` of a Python file with this text."""
    path = folder / "own.py"
    path.write_text(text)
    return Scene(shapes=SHAPES, own={"odd": Own("odd", arguments, file=str(path))}, trusted=True)


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
        ("x = 1\ny = = 2\n", r"own\.py:2: SyntaxError: .*; fix the file"),
        ("x = 1\n\nraise ValueError('no\\nway')\n", r"own\.py:3: ValueError: no way; fix the file"),
        ("import sys\nsys.exit(3)\n", r"own\.py:2: SystemExit: 3; fix the file"),
        ("import no_such_module\n", r"own\.py:1: ModuleNotFoundError: No module named 'no_such_module'"),
        ("x = 1\n", r"own\.py:1: defines no PREDICATES; write PREDICATES = "),
        ("PREDICATES = [1]\n", r"own\.py:1: defines no PREDICATES"),
        ("PREDICATES = {'even': 1}\n", r"own\.py:1: PREDICATES has no odd; it has even"),
        ("PREDICATES = {'odd': 1}\n", r"own\.py:1: PREDICATES\['odd'\] needs a Predicate of that name; got 1"),
        (
            "from prag_asp.physics import PREDICATES\nPREDICATES = {'odd': PREDICATES['near']}\n",
            r"needs a Predicate of that name; got one named near",
        ),
        (
            "from dataclasses import replace\nfrom prag_asp.physics import PREDICATES\n"
            "PREDICATES = {'odd': replace(PREDICATES['near'], name='odd', subject=2)}\n",
            r"odd has the subject 2 of 2 arguments; count from 0",
        ),
        (
            "from dataclasses import replace\nfrom prag_asp.physics import PREDICATES\n"
            "PREDICATES = {'odd': replace(PREDICATES['near'], name='odd', violations=3)}\n",
            r"own\.py:1: odd: its violations has to be a function; got 3",
        ),
        (
            "from dataclasses import replace\nfrom prag_asp.physics import PREDICATES\n"
            "PREDICATES = {'odd': replace(PREDICATES['near'], name='odd', demands=3)}\n",
            r"own\.py:1: odd: its demands has to be a function; got 3",
        ),
    ],
)
def test_a_python_file_that_fails_is_reported_in_one_line_with_its_place(
    text: str, message: str, tmp_path: Path
) -> None:
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
        ("1 / 0", "Volume()", r"own\.py:5: odd: ZeroDivisionError: division by zero; fix the file"),
        ("__import__('sys').exit(0)", "Volume()", r"own\.py:5: odd: SystemExit: 0; fix the file"),
        ("float('nan')", "Volume()", r"own\.py:4: the violations of odd have to be numbers, at least one; got \[nan\]"),
        ("'near'", "Volume()", r"own\.py:4: the violations of odd have to be numbers, .* got \['near'\]; fix the fun"),
        ("0.0", "None", r"own\.py:7: the volume of odd has to be a Volume, with numbers as its bounds; got None"),
        ("0.0", "Volume(low=(float('nan'), 0.0, 0.0))", r"own\.py:7: the volume of odd has to be a Volume, .* got Vol"),
        ("0.0", "situation.pose(arguments[7])", r"own\.py:8: odd: IndexError: tuple index out of range"),
    ],
)
def test_what_goes_wrong_in_a_function_of_a_file_is_reported_with_its_line(
    violation: str, volume: str, message: str, tmp_path: Path
) -> None:
    predicate = predicate_of(written(tmp_path, ODD.format(violation=violation, volume=volume)), "odd")
    situation = Situation(Scene(shapes=SHAPES), {"cup_1": Pose((0.5, 0.0, 0.04))})
    with pytest.raises(SceneError, match=message):
        predicate.distance(situation, ("cup_1", "cup_1"))
        predicate.volume(situation, ("cup_1", "cup_1"), (0.0, 0.0, 0.0, 1.0))


OTHERS = """
from functools import partial, wraps
from prag_asp.physics.predicates import Predicate, Volume, states

def same(function):
    @wraps(function)
    def inner(*arguments):
        return function(*arguments)
    return inner

def given(sign, situation, arguments):
    return iter(())

@same
def volume(situation, arguments, quaternion):
    return 3

class Words:
    def __call__(self, arguments, value=True):
        return None

PREDICATES = {"odd": Predicate("odd", partial(given, 1), volume, Words())}
"""


def test_a_wrong_result_is_reported_with_the_line_of_what_gave_it_however_it_is_wrapped(tmp_path: Path) -> None:
    predicate = predicate_of(written(tmp_path, OTHERS), "odd")
    nowhere = Situation(Scene(shapes=SHAPES), {})
    with pytest.raises(SceneError, match=r"own\.py:11: the violations of odd have .* at least one; got \[\]"):
        predicate.distance(nowhere, ("cup_1", "cup_2"))
    with pytest.raises(SceneError, match=r"own\.py:14: the volume of odd has .* got 3"):
        predicate.volume(nowhere, ("cup_1", "cup_2"), (0.0, 0.0, 0.0, 1.0))
    with pytest.raises(SceneError, match=r"own\.py:19: the sentence of odd has to be a string; got None"):
        predicate.sentence(("cup_1", "cup_2"))


FUNCTIONS = """
from prag_asp.physics.predicates import Predicate, Volume, states

def violations(situation, arguments):
    yield 0.0

def volume(situation, arguments, quaternion):
    return Volume()

def own(*arguments):
    return {result}

PREDICATES = {{"odd": Predicate("odd", violations, volume, states("{{0}} {{is}} odd"), {part}=own)}}
"""


@pytest.mark.parametrize(
    ("part", "result", "message"),
    [
        (
            "impossible",
            "[3]",
            r"own\.py:10: the reasons why odd is impossible have to be strings; got \[3\]; fix the func",
        ),
        ("impossible", "1 / 0", r"own\.py:11: odd: ZeroDivisionError: division by zero; fix the file"),
        (
            "demands",
            "[(0, 'far')]",
            r"own\.py:10: the demands of odd have to be pairs of an axis .*; got \[\(0, 'far'\)",
        ),
        ("demands", "[(3, None)]", r"own\.py:10: the demands of odd have to be pairs of an axis \(0 to 2\) and a Gap"),
        ("excludes", "True", r"own\.py:10: the reason why odd excludes another has to be a string, or None; got True"),
        ("nowhere", "None", r"own\.py:10: the result of `nowhere` of odd has to be True or False; got None"),
        ("otherwise", "None", r"own\.py:10: the volume `otherwise` of odd has to be a Volume, .*; got None"),
        (
            "robot_sentence",
            "None",
            r"own\.py:10: the robot_sentence of odd has to be a string; got None",
        ),
    ],
)
def test_what_goes_wrong_in_a_function_for_proofs_is_reported_with_its_line(
    part: str, result: str, message: str, tmp_path: Path
) -> None:
    predicate = predicate_of(written(tmp_path, FUNCTIONS.format(part=part, result=result)), "odd")
    with pytest.raises(SceneError, match=message):
        getattr(predicate, part)(None, ("cup_1", "cup_2"))
