"""Objects that a task does not name, in pictures."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from prag_asp.physics import film_strip, physical_task
from prag_asp.physics.bullet import pybullet
from prag_asp.physics.pictures.bystanders import (
    CLEAR,
    MOST,
    Room,
    absent_objects,
    place_bystanders,
    waypoint_moments,
)
from prag_asp.physics.pictures.camera import view_camera
from prag_asp.physics.pictures.picture_world import open_picture_world
from prag_asp.physics.pictures.sight import Sight, boxes_of
from prag_asp.physics.witness import Arm, Moment
from prag_asp.scene.geometry import Pose
from prag_asp.scene.robots import PANDA
from prag_asp.scene.scene import Shape
from tests.physics.scenarios import stacking

SIZE = (180, 160)


@pytest.fixture(scope="module")
def witness(tabletop_validator):
    return tabletop_validator.validate(stacking(), seed=1).witness


@pytest.fixture(scope="module")
def world(witness, tabletop):
    with open_picture_world(stacking(), witness, witness.moments, tabletop, SIZE) as opened:
        yield opened


def test_the_movable_objects_of_the_scene_are_placed_on_the_table_apart_from_everything(world, witness, simulator):
    assert sorted([*world.placed, *witness.moments[0].poses]) == sorted(
        entity for entity, shape in world.scene.shapes.items() if shape.traits.body
    )
    for moment in (*witness.moments, *waypoint_moments(witness, world.scene)):
        simulator.show(replace(moment, poses={**moment.poses, **world.placed}))
        others = [simulator.body(entity) for entity in moment.poses] + [simulator.arm.body]
        for entity, pose in world.placed.items():
            body = simulator.body(entity)
            assert pose.position[2] == pytest.approx(world.scene.shapes[entity].half[2])
            assert not any(
                pybullet.getClosestPoints(body, other, CLEAR - 1e-4, physicsClientId=simulator.client)
                for other in others
            ), (entity, moment)


def test_no_pixel_of_what_the_task_moves_is_hidden(world, witness):
    camera = view_camera(world.choose_view(range(len(witness.moments))), SIZE)
    assert world.shown, "something is there that could hide"
    for moment in witness.moments:
        world.studio.show(moment)
        alone = world.studio.distances(camera, {"cube_1", "brick_1", "panda"})
        world.show(moment)
        among = world.studio.distances(camera, {"cube_1", "brick_1", "panda"})
        assert (among[alone > 0] > 0).all() and (alone > 0).sum() > 100


def test_the_same_places_are_found_in_every_picture_and_no_picture_has_to_have_them(world, witness, tabletop):
    with open_picture_world(stacking(), witness, witness.moments, tabletop, SIZE) as again:
        assert again.placed == world.placed
    bare, full = (
        np.asarray(film_strip(stacking(), witness, tabletop, frames=2, size=(90, 80), bystanders=some))
        for some in (False, True)
    )
    assert bare.shape == full.shape and (bare != full).any()


def test_a_bystander_changes_no_fact(world, witness, tabletop, simulator):
    sight = Sight.of(world.studio, (world.choose_view(range(3)), SIZE), witness.moments)

    def placed(holds) -> dict[str, Pose]:
        fact = SimpleNamespace(is_satisfied=lambda situation: holds(situation.poses))
        physical = replace(physical_task(stacking(), tabletop), initial=(fact,))
        return place_bystanders(physical, witness.moments, (), simulator, sight)

    everything = placed(lambda poses: True)
    assert everything.keys() == world.placed.keys()
    assert not placed(lambda poses: len(poses) == len(witness.moments[0].poses))
    assert placed(lambda poses: "can_1" in poses).keys() == everything.keys() - {"can_1"}


def test_nothing_stands_below_a_hand_that_seems_to_hold_it(tabletop, simulator):
    hand = Moment({}, {"panda": Arm(PANDA.home, 0.08)})
    room = Room.of([hand], [], simulator)
    passed = Room.of([], [hand], simulator)
    x, y, z = min(room.bodies[:, 0].tolist(), key=lambda low: low[2])

    def is_free(room: Room, place: tuple[float, float, float]) -> bool:
        corners = tuple(side - 0.025 for side in place), tuple(side + 0.025 for side in place)
        return room.has_place("cube_1", Pose(place), boxes_of([corners]))

    below = (x + 0.02, y + 0.02, z + 0.03)
    assert not is_free(room, below) and is_free(passed, below)
    assert is_free(room, (x + 0.4, y + 0.3, 0.025))


def test_large_objects_come_first_and_a_crowd_is_cut(tabletop):
    crowd = {f"peg_{i}": Shape("box", (0.01 * i, 0.02, 0.02)) for i in range(1, 21)}
    scene = replace(tabletop, shapes={**tabletop.shapes, **crowd})
    assert (
        absent_objects(scene, {})
        == sorted(
            (name for name, shape in scene.shapes.items() if shape.traits.body and name not in scene.fixed),
            key=lambda name: -scene.shapes[name].size[0] * scene.shapes[name].size[1],
        )[:MOST]
    )
