from __future__ import annotations

import math

import pytest

from prag_asp.physics.situation import Situation
from prag_asp.physics.witness import Arm
from prag_asp.physics.world.support import riders, unsupported
from prag_asp.scene.forms import rectangle
from prag_asp.scene.geometry import Pose, hull, inside_by, intersection, yaw_quaternion
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import BodyModel, Material, Scene, Shape, Solid

PLANK = Shape("box", (0.2, 0.05, 0.02))
CUBE = Shape("box", (0.05, 0.05, 0.05))
SHAPES = {
    "a": CUBE,
    "b": CUBE,
    "c": CUBE,
    "plank": PLANK,
    "ball": Shape("sphere", (0.06,) * 3),
    "bowl": Shape("container", (0.2, 0.2, 0.06), 0.006),
    "tray": Shape("container", (0.3, 0.1, 0.06), 0.006),
}


def _situation(**places: tuple[float, float, float]) -> Situation:
    poses = {name: Pose(place) for name, place in places.items()}
    return Situation(Scene(shapes=SHAPES), poses)


@pytest.mark.parametrize(
    ("places", "falls"),
    [
        ({"a": (0.5, 0, 0.025)}, None),
        ({"a": (0.5, 0, 0.03)}, "a"),
        ({"a": (0.5, 0, 0.02)}, "a"),
        ({"a": (5.0, 0, 0.025)}, "a"),
        ({"a": (0.5, 0, 0.025), "b": (0.52, 0, 0.075)}, None),
        ({"a": (0.5, 0, 0.025), "b": (0.53, 0, 0.075)}, "b"),
        ({"a": (0.5, 0, 0.025), "ball": (0.5, 0.01, 0.08)}, None),
        ({"ball": (0.5, 0, 0.03), "a": (0.5, 0, 0.085)}, "a"),
        ({"bowl": (0.5, 0, 0.03), "a": (0.5, 0, 0.031)}, None),
        ({"bowl": (0.5, 0, 0.03), "a": (0.5, 0, 0.085)}, "a"),
        ({"tray": (0.5, 0, 0.03), "a": (0.6, 0, 0.031)}, None),
        ({"a": (0.42, 0, 0.025), "b": (0.58, 0, 0.025), "plank": (0.5, 0, 0.06)}, None),
    ],
)
def test_a_body_stays_where_something_bears_its_centre_of_mass(places, falls):
    assert unsupported(_situation(**places), list(places)) == falls


def test_each_cube_of_a_leaning_stack_is_borne_but_the_stack_falls():
    places = {"a": (0.5, 0, 0.025), "b": (0.52, 0, 0.075), "c": (0.54, 0, 0.125)}
    assert unsupported(_situation(a=places["a"], b=places["b"]), ["a", "b"]) is None
    assert unsupported(_situation(**places), list(places)) == "b"


def test_a_weight_on_the_overhang_tips_a_plank_and_a_counterweight_holds_it():
    plank = {"a": (0.5, 0, 0.025), "plank": (0.52, 0, 0.06)}
    loaded = {**plank, "b": (0.6, 0, 0.095)}
    balanced = {**loaded, "c": (0.44, 0, 0.095)}
    assert unsupported(_situation(**plank), list(plank)) is None
    assert unsupported(_situation(**loaded), list(loaded)) == "plank"
    assert unsupported(_situation(**balanced), list(balanced)) is None


def test_a_held_body_does_not_fall():
    held = Arm(PANDA.home, 0.05, "a", Pose((0.0, 0.0, 0.0)))
    assert unsupported(_situation(a=(0.5, 0, 0.3)).with_arm("panda", held), ["a"]) is None


def test_what_rests_on_a_moved_body_or_in_it_rides_along():
    situation = _situation(bowl=(0.5, 0, 0.03), a=(0.5, 0, 0.031), b=(0.5, 0, 0.081), c=(0.7, 0, 0.025))
    assert riders(situation, "bowl", ["a", "b", "c"]) == ["a", "b"]
    assert riders(situation, "a", ["bowl", "b", "c"]) == ["b"]


def test_two_squares_an_eighth_turn_apart_share_an_octagon():
    square, turned = rectangle(0, 0, 1, 1, 0), rectangle(0, 0, 1, 1, math.pi / 4)
    shared = intersection(square, turned)
    assert len(hull(list(shared))) == 8
    assert inside_by(shared, (0.0, 0.0)) == pytest.approx(1.0)
    assert inside_by(shared, (1.1, 0.0)) == pytest.approx(-0.1)
    assert intersection(square, rectangle(3, 0, 1, 1, 0)) == ()


def test_the_outline_of_a_turned_body_bears_what_its_bounding_box_would_not():
    poses = {"plank": Pose((0.5, 0, 0.01), yaw_quaternion(math.pi / 4)), "a": Pose((0.55, 0.05, 0.045))}
    situation = Situation(Scene(shapes=SHAPES), poses)
    assert unsupported(situation, list(poses)) is None
    moved = situation.with_pose("a", Pose((0.55, -0.05, 0.045)))
    assert unsupported(moved, list(poses)) == "a"


def test_what_bears_a_load_depends_on_the_materials():
    places = {"a": (0.5, 0, 0.025), "plank": (0.52, 0, 0.06), "b": (0.6, 0, 0.095)}
    poses = {name: Pose(place) for name, place in places.items()}
    for density, falls in ((400.0, "plank"), (4000.0, None)):
        scene = Scene(shapes=SHAPES, materials={"plank": Material(density)})
        assert unsupported(Situation(scene, poses), list(poses)) == falls


@pytest.mark.parametrize(
    ("x", "falls"), [(0.5, "hammer"), (0.47, "hammer"), (0.43, None), (0.42, None), (0.36, "hammer")]
)
def test_a_body_is_borne_at_its_centre_of_mass_and_not_at_the_middle_of_its_box(x, falls):
    # A bar of 160 mm whose centre of mass is 60 mm to the right of its middle, over a post of 40 mm at 0.5 m.
    outline = rectangle(0.0, 0.0, 0.08, 0.02, 0.0)
    model = BodyModel((Solid("box", (0.16, 0.04, 0.03)),), 0.3, (0.06, 0.0, 0.0), base=outline, crown=outline)
    shapes = {"hammer": Shape("urdf", (0.16, 0.04, 0.03), model=model), "post": Shape("box", (0.04, 0.04, 0.08))}
    poses = {"hammer": Pose((x, 0.0, 0.095)), "post": Pose((0.5, 0.0, 0.04))}
    scene = Scene(shapes=shapes, fixed={"post": (0.5, 0.0, 0.0)})
    assert unsupported(Situation(scene, poses), list(poses)) == falls


def test_a_body_stands_on_its_foot_and_bears_others_on_its_crown():
    foot, crown = rectangle(0.0, 0.0, 0.01, 0.01, 0.0), rectangle(0.03, 0.0, 0.02, 0.02, 0.0)
    lamp = Shape(
        "urdf", (0.1, 0.06, 0.1), model=BodyModel((Solid("box", (0.1, 0.06, 0.1)),), 1.0, base=foot, crown=crown)
    )
    scene = Scene(shapes={"lamp": lamp, "cube": CUBE, "edge": CUBE}, fixed={"edge": (0.53, 0.0, 0.0)})
    for x, falls in ((0.53, None), (0.48, "cube"), (0.56, "cube")):
        poses = {"lamp": Pose((0.5, 0.0, 0.05)), "cube": Pose((x, 0.0, 0.125))}
        assert unsupported(Situation(scene, poses), list(poses)) == falls
    poses = {"lamp": Pose((0.5, 0.0, 0.1)), "edge": Pose((0.53, 0.0, 0.025))}  # its foot is beside the block
    assert unsupported(Situation(scene, poses), list(poses)) == "lamp"


@pytest.mark.parametrize("of_file", [False, True])
@pytest.mark.parametrize(
    ("width", "balance", "margin"),
    # A tenth of 60 and 80 mm, 10 mm of 160, 5 mm of 40 that are more than a tenth, and what the scene wants instead.
    [(0.06, 0.01, 0.006), (0.08, 0.01, 0.008), (0.16, 0.01, 0.01), (0.04, 0.01, 0.005), (0.16, 0.02, 0.016),
     (0.16, 0.002, 0.002), (0.16, 0.0, 0.0)],
)  # fmt: skip
def test_what_is_placed_keeps_a_margin_to_the_edge_of_its_support(of_file, width, balance, margin):
    size = (width, width, 0.03)
    outline = rectangle(0.0, 0.0, width / 2, width / 2, 0.0)
    centre = (0.01, 0.0, 0.0) if of_file else (0.0, 0.0, 0.0)
    model = BodyModel((Solid("box", size),), 0.3, centre, base=outline, crown=outline) if of_file else None
    shapes = {"plate": Shape("urdf" if of_file else "box", size, model=model), "post": Shape("box", (0.2, 0.2, 0.08))}
    scene = Scene(shapes=shapes, fixed={"post": (0.5, 0.0, 0.0)}, balance=balance)
    for inside, falls in ((margin + 1e-4, None), (margin - 1e-4, "plate")):
        poses = {"plate": Pose((0.6 - inside - centre[0], 0.0, 0.095)), "post": Pose((0.5, 0.0, 0.04))}
        assert unsupported(Situation(scene, poses), list(poses), needs_margin=True) == falls
        assert inside < 0.0 or unsupported(Situation(scene, poses), list(poses)) is None
