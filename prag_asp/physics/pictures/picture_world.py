"""The world in which the pictures of a witness or demonstration are taken."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from prag_asp.errors import QueryError, SceneError
from prag_asp.physics.checks.numbers import LIMIT_TOLERANCE, broken_numbers
from prag_asp.physics.demonstration.demonstration import FRAMES_A_SECOND, Demonstration
from prag_asp.physics.filming.appearance_meshes import FINE, Fineness
from prag_asp.physics.filming.camera_rendering import moment_of
from prag_asp.physics.filming.studio import Studio, open_studio
from prag_asp.physics.pictures.bystanders import (
    absent_objects,
    place_bystanders,
    visible_bystanders,
    waypoint_moments,
)
from prag_asp.physics.pictures.sight import Sight
from prag_asp.physics.pictures.views import View, best_view
from prag_asp.physics.symbolic_facts import physical_task
from prag_asp.physics.witness import Moment, Witness
from prag_asp.physics.world.simulator import open_simulator
from prag_asp.scene.geometry import Pose
from prag_asp.scene.scene import Scene
from prag_asp.task import Task

GIVE = 0.005
"""The amount by which measured joint angles (radians) and openings (metres) may exceed their limits."""

PASSED = FRAMES_A_SECOND // 10
"""The interval, in frames of a demonstration, at which frames are kept clear of bystanders."""


@dataclass
class PictureWorld:
    """A studio, the scene with the sizes of a task, the size of a picture in pixels, and the bystanders.

    `shown` are the bystanders that hide nothing in the view that was chosen last.
    """

    task: Task
    moments: Sequence[Moment]
    scene: Scene
    studio: Studio
    size: tuple[int, int]
    placed: Mapping[str, Pose] = field(default_factory=dict)
    shown: Mapping[str, Pose] = field(default_factory=dict)
    _views: dict[tuple[int, ...], View] = field(default_factory=dict, repr=False)

    def choose_view(self, states: Sequence[int], frames: Iterable[Moment] = ()) -> View:
        """Return the best view of the given states, and remove the bystanders that hide something in it.

        `frames` are further moments that will be shown.
        """
        key = tuple(states)
        if key not in self._views:
            self._views[key] = best_view(self.task, self.moments, self.scene, self.studio, self.size, key)
        view = self._views[key]
        if self.placed:
            moments = [*(self.moments[k] for k in states), *frames]
            self.shown = visible_bystanders(self.placed, moments, self.studio, self.scene, (view, self.size))
        return view

    def show(self, moment: Moment) -> None:
        """Show a moment with the bystanders."""
        self.studio.show(replace(moment, poses={**moment.poses, **self.shown}))


@contextmanager
def open_picture_world(
    task: Task,
    shown: Witness | Demonstration,
    moments: Sequence[Moment],
    scene: Scene,
    size: tuple[int, int],
    *,
    fineness: Fineness = FINE,
    bystanders: bool = True,
) -> Iterator[PictureWorld]:
    """Open a world for pictures of a given size that can show all moments in a scene, and close it afterwards.

    Raises:
        QueryError: a number in the moments is wrong.
    """
    try:
        sized = scene.with_sizes(shown.sizes) if isinstance(shown, Witness) else shown.sized_scene(scene)
    except SceneError as error:
        raise QueryError(str(error)) from None
    with open_simulator(sized) as simulator:
        physical = physical_task(task, sized)
        tolerance = LIMIT_TOLERANCE if isinstance(shown, Witness) else GIVE
        for k, moment in enumerate(moments):
            for fault in broken_numbers(moment, physical, simulator, tolerance):
                raise QueryError(f"state {k}: {fault}")
        present = moments[0].poses
        absent = absent_objects(sized, present) if bystanders else []
        with open_studio(sized, (*present, *absent), fineness=fineness) as studio:
            world = PictureWorld(task, moments, sized, studio, size)
            if absent:
                view = world.choose_view(range(len(moments)))
                sight = Sight.of(studio, (view, size), moments)
                world.placed = place_bystanders(physical, moments, _passed(shown, sized), simulator, sight)
            yield world


def _passed(shown: Witness | Demonstration, scene: Scene) -> Iterator[Moment]:
    """Yield moments between the states."""
    if isinstance(shown, Witness):
        yield from waypoint_moments(shown, scene)
        return
    for frame in range(0, len(shown.times), PASSED):
        yield moment_of(shown, frame)
