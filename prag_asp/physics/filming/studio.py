"""A world for rendering: robots with simplified meshes, the objects of an episode, and cameras.

TinyRenderer draws robots and objects; the table, zones, floors of fixed containers and the room come from `backdrop`
and are merged by depth. Shadows come from a depth image that TinyRenderer takes from the light.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import SceneError
from prag_asp.physics.bullet import STDOUT, mute_output, pybullet
from prag_asp.physics.demonstration.footage import NOTHING, CameraImage, segmentation_type
from prag_asp.physics.filming.appearance_meshes import COARSE, Fineness, low_files
from prag_asp.physics.filming.backdrop import (
    AMBIENT,
    DIFFUSE,
    SPECULAR,
    Backdrop,
    backdrop,
    floors,
    has_still_floor,
    patches,
    rays,
)
from prag_asp.physics.filming.shadows import LightPlaces, ShadowMap, light_camera
from prag_asp.physics.filming.textures import Floats
from prag_asp.physics.robot.kinematics import tool_pose
from prag_asp.physics.witness import Moment
from prag_asp.physics.world.bodies import make_body, parking_place, put_body
from prag_asp.physics.world.collisions import BASE_LINK
from prag_asp.physics.world.furniture_bodies import JOINT, set_opening
from prag_asp.physics.world.simulated_arm import load_robot_files, set_joints
from prag_asp.physics.world.simulator import move, open_client, read_pose, start_world
from prag_asp.scene.boxes import Vector
from prag_asp.scene.cameras import Camera
from prag_asp.scene.geometry import Pose, matrix
from prag_asp.scene.robots import Joints, robot_of
from prag_asp.scene.scene import Scene
from prag_asp.scene.variation import USUAL_LIGHT, table_of

LIGHT_DISTANCE = 3.0
FLIPPED = np.diag((1.0, -1.0, -1.0, 1.0))
"""The transformation from camera axes to those of OpenGL, with y up and z backwards."""

BODY, LINK = (1 << 24) - 1, 24
"""The mask of the body number in a pixel, and the lowest bit of the link number, which is stored plus one."""

BODY_SHADOW = 0.72
"""The brightness of a surface in the shadow of another body, as a share of its brightness in the light."""

RESTING = 0.002
"""The tolerance of depth in metres within which an object hides the table below it."""


class Studio:
    """A world for rendering given objects of a scene; use `open_studio`, which closes it.

    `movable` are the objects that can move, and the furniture that has a moving part.
    """

    def __init__(
        self,
        scene: Scene,
        objects: Sequence[str],
        client: int,
        light: Vector = USUAL_LIGHT,
        fineness: Fineness = COARSE,
    ):
        self._scene, self._client, self._light = scene, client, light
        for entity in objects:
            if entity not in scene.shapes or not scene.shapes[entity].traits.body:
                raise SceneError(
                    f"{entity} has no shape to render; give its class the shape of an object under [scene.shapes]"
                )
        start_world(client)
        self._robots = {name: robot_of(scene, name) for name in scene.robots}
        self._arms = {
            name: load_robot_files(client, low_files(mount.kind, fineness), self._robots[name].base, visual=True)
            for name, mount in scene.robots.items()
        }
        self._bodies = {
            entity: make_body(
                client, scene, entity, parking_place(i), visual=True, floor=not has_still_floor(scene, entity)
            )
            for i, entity in enumerate(objects)
        }
        self.table = table = table_of(scene)
        zones = [entity for entity, shape in scene.shapes.items() if shape.kind == "zone"]
        self.movable = tuple(
            entity for entity in objects if entity not in scene.fixed or scene.shapes[entity].traits.furniture
        )
        self.legend = (NOTHING, table, *scene.robots, *objects, *zones)
        self._dtype = np.dtype(segmentation_type(self.legend))
        numbers = {entity: number for number, entity in enumerate(self.legend)}
        self._table, self._zones = numbers[table], patches(scene, numbers)
        self._floors = floors(scene, numbers)
        shown = {**self._arms, **self._bodies}
        self._numbers = np.zeros(max(shown.values()) + 2, dtype=np.int32)
        for entity, body in shown.items():
            self._numbers[body + 1] = numbers[entity]
        self._parts = {
            body: tuple(
                link for link in self._robots[name].links if link not in (BASE_LINK, *self._robots[name].arm_links)
            )
            for name, body in self._arms.items()
        }
        self._parts |= {
            body: (JOINT,) for entity, body in self._bodies.items() if scene.shapes[entity].traits.furniture
        }
        self._joints: dict[str, Joints] = {}
        self._poses: dict[Camera, NDArray[np.float64]] = {}
        self._fixed: dict[Camera, tuple[Backdrop, LightPlaces]] = {}
        self._shadows = ShadowMap(light_camera(scene, light, fineness.shadow_texels))
        self._shadows_are_old = True

    def show(self, moment: Moment) -> None:
        """Show a moment by moving all objects and arms, and remove the objects that the moment lacks."""
        for name, arm in moment.arms.items():
            set_joints(self._client, self._arms[name], self._robots[name], arm.joints, arm.width)
            self._joints[name] = arm.joints
        for entity, pose in moment.poses.items():
            put_body(self._client, self._scene, entity, self._bodies[entity], pose)
        for i, entity in enumerate(self._bodies):
            if entity not in moment.poses:
                move(self._client, self._bodies[entity], Pose(parking_place(i)))
        for entity, opening in moment.openings.items():
            set_opening(self._client, self._bodies[entity], opening)
        self._shadows_are_old = True

    def pose(self, camera: Camera) -> NDArray[np.float64]:
        """Return the current pose of a camera as a homogeneous matrix, with x to the right, y down and z forwards."""
        if camera not in self._poses:
            self._poses[camera] = camera.pose
        if not camera.mount:
            return self._poses[camera]
        return matrix(tool_pose(self._robots[camera.mount], self._joints[camera.mount])) @ self._poses[camera]

    def take(self, camera: Camera) -> CameraImage:
        """Take an image with a camera, and return it."""
        pose = self.pose(camera)
        behind, places = self._behind(camera, pose)
        colors, depth, bodies = self._drawn(camera, pose)
        in_front = (bodies >= 0) & (depth < behind.depth + RESTING)
        self._cast_shadows()
        light = np.ones(bodies.size, dtype=np.float32)
        light[places.pixels] -= (1.0 - AMBIENT / behind.shade) * self._shadows.on_table(places)
        bodies_at = self._places(camera, pose, depth, in_front)
        hidden = self._shadows.on_bodies(bodies_at, bodies.ravel()[bodies_at.pixels])
        light[bodies_at.pixels] = 1.0 - (1.0 - BODY_SHADOW) * hidden
        shown = np.where(in_front[..., None], colors, behind.rgb) * light.reshape(*bodies.shape, 1)
        depths = np.where(in_front, depth, behind.depth)
        depths[~np.isfinite(depths)] = 0.0
        return CameraImage(
            shown.astype(np.uint8),
            depths.astype(np.float16),
            np.where(in_front, self._numbers[bodies + 1], behind.numbers).astype(self._dtype),
        )

    def _behind(self, camera: Camera, pose: NDArray[np.float64]) -> tuple[Backdrop, LightPlaces]:
        """Return the image of table and room from a camera pose, and the places of its points in the light's image."""
        if not camera.mount and camera in self._fixed:
            return self._fixed[camera]
        behind = backdrop(self._scene, camera, pose, self._zones, self._table, self._light, self._floors)
        places = self._places(camera, pose, behind.depth, behind.level)
        if not camera.mount:
            self._fixed[camera] = (behind, places)
        return behind, places

    def _places(
        self, camera: Camera, pose: NDArray[np.float64], depth: Floats, chosen: NDArray[np.bool_]
    ) -> LightPlaces:
        """Return the places, in the light's image, of the points shown by the chosen pixels."""
        (x, y), turn = rays(camera), pose.astype(np.float32)
        pixels = np.flatnonzero(chosen)
        rows, columns = np.divmod(pixels, camera.size[0])
        across, down, far = x[0, columns], y[rows, 0], depth.ravel()[pixels]
        first, second, third = (
            (turn[i, 0] * across + turn[i, 1] * down + turn[i, 2]) * far + turn[i, 3] for i in range(3)
        )
        return self._shadows.places(pixels, (first, second, third))

    def _cast_shadows(self) -> None:
        """Take the depth image from the light, if anything has moved."""
        if self._shadows_are_old:
            camera = self._shadows.camera
            _, depth, bodies = self._drawn(camera, self.pose(camera))
            self._shadows.update(np.where(bodies >= 0, depth, np.float32(np.inf)), bodies)
            self._shadows_are_old = False

    def counts(self, camera: Camera, *, robots: bool = True) -> Counter[str]:
        """Return the number of pixels that show each object (for furniture, its moving part) and each robot's hand.

        Hands are listed under the names of their robots; `robots=False` removes the robots for this image.
        """
        if robots:
            labels, _ = self._labelled(camera)
        else:
            arms = {arm: read_pose(self._client, arm) for arm in self._arms.values()}
            for i, arm in enumerate(arms):
                move(self._client, arm, Pose(parking_place(i)))
            labels, _ = self._labelled(camera)
            for arm, place in arms.items():
                move(self._client, arm, place)
        numbers, counts = np.unique(labels[labels >= 0], return_counts=True)
        return Counter(
            {self.legend[number]: count for number, count in zip(numbers.tolist(), counts.tolist(), strict=True)}
        )

    def distances(self, camera: Camera, entities: Collection[str]) -> Floats:
        """Return the distance in metres of each pixel that shows one of the entities, and 0 for the others.

        For robots, only the hands count; for furniture, only the moving parts.
        """
        labels, depth = self._labelled(camera)
        chosen = [number for number, entity in enumerate(self.legend) if entity in entities]
        return np.where(np.isin(labels, chosen), depth, np.float32(0.0))

    def _labelled(self, camera: Camera) -> tuple[NDArray[np.int32], Floats]:
        """Return the number of the entity in each pixel (-1 for none, or for another part of it), and the distances."""
        flags = pybullet.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX
        _, depth, numbers = self._drawn(camera, self.pose(camera), flags)
        labels = np.full(numbers.shape, -1, dtype=np.int32)
        for value in np.unique(numbers[numbers >= 0]).tolist():
            body, link = value & BODY, (value >> LINK) - 1
            if link in self._parts.get(body, (link,)):
                labels[numbers == value] = self._numbers[body + 1]
        return labels, depth

    def _drawn(
        self, camera: Camera, pose: NDArray[np.float64], flags: int = 0
    ) -> tuple[NDArray[np.uint8], Floats, NDArray[np.int32]]:
        """Return the colours, the depths in metres, and the body numbers (-1 for none) that TinyRenderer draws."""
        width, height = camera.size
        result = pybullet.getCameraImage(
            width,
            height,
            *matrices(camera, pose),
            lightDirection=self._light,
            lightAmbientCoeff=AMBIENT,
            lightDiffuseCoeff=DIFFUSE,
            lightSpecularCoeff=SPECULAR,
            lightDistance=LIGHT_DISTANCE,
            shadow=False,
            renderer=pybullet.ER_TINY_RENDERER,
            flags=flags,
            physicsClientId=self._client,
        )
        # if PyBullet was built without NumPy, it returns flat tuples
        colors = np.asarray(result[2], dtype=np.uint8).reshape(height, width, 4)[:, :, :3]
        buffer = np.asarray(result[3], dtype=np.float32).reshape(height, width)
        near, far = camera.near, camera.far
        depth: Floats = far * near / (far - (far - near) * buffer)
        return colors, depth, np.asarray(result[4], dtype=np.int32).reshape(height, width)


def matrices(camera: Camera, pose: NDArray[np.float64]) -> tuple[list[float], list[float]]:
    """Return the view and projection matrices in column order, for TinyRenderer.

    Measurements show that TinyRenderer samples the lower left corner of a pixel, so the projection is shifted by half a
    pixel.
    """
    width, height = camera.size
    view = FLIPPED @ np.linalg.inv(pose)
    projection = pybullet.computeProjectionMatrixFOV(camera.field_of_view, width / height, camera.near, camera.far)
    shifted = list(projection)
    shifted[8], shifted[9] = shifted[8] + 1 / width, shifted[9] + 1 / height
    return view.T.ravel().tolist(), shifted


@contextmanager
def open_studio(
    scene: Scene, objects: Sequence[str], light: Vector = USUAL_LIGHT, fineness: Fineness = COARSE
) -> Iterator[Studio]:
    """Open a world for rendering given objects of a scene, and close it afterwards.

    `light` is the direction to the light, and `fineness` sets how finely robots and shadows are rendered.

    Raises:
        SceneError: a robot cannot be loaded, PyBullet refuses a body, or an object has no body.
    """
    with open_client() as client:
        with mute_output(STDOUT):
            studio = Studio(scene, objects, client, light, fineness)
        yield studio
