from __future__ import annotations

from dataclasses import replace

import numpy as np

from prag_asp import load_domain, load_scene
from prag_asp.physics.filming.studio import open_studio
from prag_asp.physics.pictures.views import acting, best_view, points_of_interest, view_from
from prag_asp.physics.witness import Arm, Moment
from prag_asp.scene.cameras import FIELD_OF_VIEW, Camera
from prag_asp.scene.geometry import Pose, yaw_quaternion
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Scene, Shape
from tests.physics.random_tasks import shipped_scene
from tests.physics.scenarios import stacking, state, task

SIZE = (90, 80)


def camera(view, size=SIZE) -> Camera:
    return Camera(*view, FIELD_OF_VIEW, size=size, far=10.0)


def test_what_acts_is_what_action_and_subgoal_name_and_a_hand(tabletop):
    assert [acting(stacking(), tabletop, k) for k in range(3)] == [
        set(), {"panda", "cube_1"}, {"panda", "cube_1", "brick_1"},
    ]  # fmt: skip


def test_a_wall_before_what_acts_is_looked_around():
    wall = Shape("box", (0.03, 0.5, 0.3))
    scene = replace(shipped_scene("tabletop"), fixed={})
    scene = replace(scene, shapes={**scene.shapes, "bin_1": wall})
    poses = {"cube_1": Pose((0.35, 0.0, 0.025)), "brick_1": Pose((0.35, 0.1, 0.02)), "bin_1": Pose((0.45, 0.0, 0.15))}
    moments = [Moment(poses, {"panda": Arm(PANDA.home, 0.08)})] * 3
    usual = view_from(scene, points_of_interest(stacking(), moments, scene), SIZE[0] / SIZE[1])
    with open_studio(scene, tuple(poses)) as studio:
        chosen = best_view(stacking(), moments, scene, studio, SIZE)
        studio.show(moments[0])
        before, after = (studio.counts(camera(view)) for view in (usual, chosen))
    assert before["cube_1"] < 4 < after["cube_1"] and after["brick_1"] > 4
    assert chosen[0][0] > 0.4, "the eye still faces the robot, so that left stays left"


def test_an_open_drawer_is_seen_by_the_part_that_moves():
    kitchen = load_scene(load_domain("kitchen"))
    x, y, yaw = kitchen.fixed["drawer_1"]
    pose = Pose((x, y, kitchen.shapes["drawer_1"].size[2] / 2), yaw_quaternion(yaw))
    with open_studio(kitchen, ("drawer_1",)) as studio:
        counts = []
        for opening in (0.0, 0.15):
            studio.show(Moment({"drawer_1": pose}, {"panda": Arm(PANDA.home, 0.08)}, {"drawer_1": opening}))
            counts.append(studio.counts(camera(kitchen.cameras["front"][:2], (96, 96)))["drawer_1"])
    assert counts[1] > counts[0] + 50
    opened = task(state(), ("open(panda,drawer_1)", state("is_open(drawer_1)")))
    assert acting(opened, kitchen, 1) == {"panda", "drawer_1"}


def test_the_turn_of_a_ball_is_seen():
    scene = Scene({"ball_1": Shape("sphere", (0.08, 0.08, 0.08))}, colors={"ball_1": "#e4572e"})
    near = Camera((0.9, 0.0, 0.3), (0.5, 0.0, 0.04), 20.0, size=(48, 48))
    pictures = []
    with open_studio(scene, ("ball_1",)) as studio:
        for quaternion in ((0, 0, 0, 1), (0.6, 0, 0, 0.8), (0, 0.6, 0, 0.8), (0, 0, 0.8, 0.6)):
            studio.show(Moment({"ball_1": Pose((0.5, 0.0, 0.04), quaternion)}, {"panda": Arm(PANDA.home, 0.08)}))
            pictures.append(studio.take(near))
    ball = pictures[0].segmentation == pictures[0].segmentation.max()
    for i, one in enumerate(pictures):
        for two in pictures[:i]:
            changed = np.abs(one.rgb.astype(int) - two.rgb).max(axis=-1)[ball] > 60
            assert changed.mean() > 0.04, i


def test_the_default_camera_sees_what_is_fixed_outside_of_the_workspace(tabletop):
    scene = replace(tabletop, workspace=(0.4, 0.5, -0.1, 0.1), fixed={"tray_1": (0.5, 0.6, 0.0)}, cameras={})
    assert is_seen(scene.cameras["front"], (0.5, 0.6, 0.0))


def is_seen(placed: Camera, point: tuple[float, float, float]) -> bool:
    x, y, z, _ = np.linalg.inv(placed.pose) @ (*point, 1.0)
    u, v, _ = placed.intrinsics @ (x / z, y / z, 1.0)
    return 0 < u < placed.size[0] and 0 < v < placed.size[1]


def test_a_view_sees_movable_objects_that_no_action_names_and_fixed_ones_that_an_action_names(tabletop):
    poses = {"can_1": Pose((0.7, 0.5, 0.05)), "cube_1": Pose((0.4, 0.0, 0.025)), "bin_1": Pose((0.47, -0.28, 0.03))}
    moments = [Moment(poses, {"panda": Arm(PANDA.home, 0.08)})]
    points = points_of_interest(stacking(), moments, tabletop)
    assert is_seen(camera(view_from(tabletop, points, 1.0), (100, 100)), (0.7, 0.5, 0.05))
    assert min(y for _, y, _ in points) > -0.28, "no action names the bin"
    step = ("insert(panda,cube_1,bin_1)", state("inside(cube_1,bin_1)"))
    assert min(y for _, y, _ in points_of_interest(task(state(), step), moments, tabletop)) < -0.4


def test_a_state_in_which_nothing_acts_is_seen_as_usual(tabletop):
    moments = [Moment({}, {"panda": Arm(PANDA.home, 0.08)})] * 3
    points = points_of_interest(stacking(), moments[:1], tabletop)
    with open_studio(tabletop, ()) as studio:
        chosen = best_view(stacking(), moments, tabletop, studio, SIZE, (0,))
    assert chosen == view_from(tabletop, tuple(dict.fromkeys(points)), SIZE[0] / SIZE[1])
