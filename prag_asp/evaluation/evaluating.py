"""Evaluate a policy on scenarios, in several processes, and resume where an interrupted evaluation stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
import msgspec
import numpy as np

from prag_asp.dataset.scenarios import Scenarios
from prag_asp.dataset.strata.stratum_figures import StratumFeed
from prag_asp.errors import NotFound, OutputError, QueryError
from prag_asp.evaluation.episode import EpisodeJob, EpisodeSetup, EvaluatedEpisode, open_episodes, open_runner
from prag_asp.evaluation.policies import content_of, contents_digest, environment_of, load_policy
from prag_asp.evaluation.policies.python_callable import CallablePolicy, source_files
from prag_asp.evaluation.results import EVALUATION, EvaluationRecord, Results
from prag_asp.evaluation.stratified_rates import weighted
from prag_asp.missing import require_pyarrow
from prag_asp.output import Journal, file_in, make_folder
from prag_asp.output.digests import digest
from prag_asp.processes.progress_events import report_progress
from prag_asp.processes.worker_pool import map_ordered
from prag_asp.processes.workers import uninterrupted
from prag_asp.versions import versions
from prag_asp.wording import plural, unknown

if TYPE_CHECKING:
    from prag_asp.evaluation.policies.policy import PolicyMaker
    from prag_asp.evaluation.sources import ScenarioSource

ACTIVITY = "evaluating a policy"
"""The name of the activity in progress displays."""

ENVIRONMENT = (
    "control", "rate", "action_scale", "observation", "everything", "goals", "steps", "language", "cameras", "size",
)  # fmt: skip
"""The environment options that an evaluation may set: those for the observations and actions of a policy."""

JOURNAL = "journal.part"
"""The file with the results of episodes, which exists until all episodes have ended."""

VIDEOS = "videos"
"""The folder for the videos of failures."""

Progress = Callable[[str, int, int], None]
"""A callback that reports progress: a message, the number of episodes so far, and the number requested."""


def evaluate(
    policy: str | Callable[..., Any],
    source: ScenarioSource,
    folder: str | Path | None = None,
    *,
    workers: int = 1,
    seed: int = 0,
    wrapper: Callable[[Any], gymnasium.Env[Any, Any]] | None = None,
    videos: int = 0,
    progress: Progress = report_progress,
    **environment: Any,
) -> Results:
    """Run a policy in each scenario of a source, and return the results.

    `policy` is a string that `load_policy` accepts, a function of an observation (and of `info`, if it has a parameter
    with that name), or a class whose instances are such functions. `environment` holds `TaskEnv` options (see
    `ENVIRONMENT`). They override options set by the policy, such as the control mode of a LeRobot checkpoint. A
    `wrapper` wraps the environment, as in training. The global random generators of Python, NumPy and PyTorch are
    seeded for each episode, so results do not depend on the number of `workers`, unless the policy does.

    With a `folder`, the results are written there: evaluation.json, a table of episodes, and `videos` of the first
    failures. An interrupted evaluation resumes from this folder; it keeps all episodes before the first unfinished one.
    If an option or a file of the policy has changed since, the evaluation starts again. The results of a complete
    evaluation are never overwritten. Of a Python policy or wrapper, only the file that defines it is considered.

    Raises:
        QueryError: an argument is wrong, or the policy fails.
        NotFound: fewer feasible scenarios are found than requested.
        OutputError: the folder contains other results, or cannot be written.
        WorkerError: workers died repeatedly.
    """
    if workers < 1:
        raise QueryError(f"an evaluation needs at least 1 worker; got {workers}")
    for option in environment:
        if option not in ENVIRONMENT:
            raise QueryError(unknown(option, ENVIRONMENT, "option of the environment"))
    if videos and folder is None:
        raise QueryError(f"videos {videos}: videos need a folder for the results; give one")
    name = policy if isinstance(policy, str) else _name(policy)
    maker: PolicyMaker = load_policy(policy) if isinstance(policy, str) else partial(CallablePolicy, policy)
    environment = {**(environment_of(policy) if isinstance(policy, str) else {}), **environment}
    domain, count = source.domain, source.count
    setup = EpisodeSetup(domain, source.lengths, {"reward": "sparse", **environment}, maker, wrapper, seed, name)
    content = content_of(policy) if isinstance(policy, str) else contents_digest(source_files(policy))
    wrapping = None if wrapper is None else [_name(wrapper), contents_digest(source_files(wrapper))]
    options = {key: str(value) for key, value in sorted(environment.items())}
    record = EvaluationRecord(
        digest([name, content, source.identity, options, wrapping, seed]), name, source.title,
        domain.label, Scenarios(domain).digest, options, seed, count, 0, versions(),
        wrapper="" if wrapper is None else _name(wrapper),
    )  # fmt: skip
    if folder is None:
        return Results(*_evaluated(record, source, setup, workers, [], lambda line: None, progress))
    require_pyarrow()
    path = make_folder(folder)
    EVALUATION.require_folder(path, JOURNAL, VIDEOS)
    existing = EVALUATION.read(path)
    if existing is None:
        return _continued(path, record, source, setup, workers, videos, progress)
    if existing.identity != record.identity:
        changed = ", with other options or scenarios or before its files changed" if existing.policy == name else ""
        raise OutputError(f"{path}: holds another evaluation, of {existing.policy}{changed}; give a new folder")
    return Results.open(path)


def _continued(
    folder: Path, record: EvaluationRecord, source: ScenarioSource, setup: EpisodeSetup, workers: int, videos: int,
    progress: Progress,
) -> Results:  # fmt: skip
    """Resume an interrupted evaluation where it stopped, and write the results and videos to a folder."""
    journal = Journal(folder / JOURNAL, record.identity)
    try:
        results = Results(*_evaluated(record, source, setup, workers, journal.lines, journal.write, progress))
        if videos:
            _write_videos(results, source, setup, folder, videos)
        with uninterrupted():
            results.write(folder)
            journal.clear()
    finally:
        journal.close()
    return results


def _evaluated(
    record: EvaluationRecord,
    source: ScenarioSource,
    setup: EpisodeSetup,
    workers: int,
    lines: Sequence[bytes],
    write: Callable[[bytes], None],
    progress: Progress,
) -> tuple[EvaluationRecord, tuple[EvaluatedEpisode, ...]]:
    """Return the record and all episodes, beginning with the stored ones in `lines`; `write` stores new ones.

    Raises:
        NotFound: there are fewer feasible scenarios than requested, except in strata that have no more.
    """
    groups = source.groups()
    feed = StratumFeed([(each.name, each.size, each.requested) for each in groups], [each.jobs for each in groups])
    left = iter(feed)
    episodes: list[EvaluatedEpisode] = []
    rejected = 0

    def successes() -> str:
        return f"{sum(each.success for each in episodes)} of {plural(len(episodes), 'episode')} succeeded"

    def add(result: EvaluatedEpisode | None, line: bytes | None = None) -> None:
        nonlocal rejected
        if feed.take(counts=result is not None) is None:
            return
        if line is not None:
            write(line)
        if result is None:
            rejected += 1
        else:
            episodes.append(result)
        progress(successes(), len(episodes), record.episodes)

    for line, _ in zip(lines, left, strict=False):
        add(msgspec.json.decode(line, type=EvaluatedEpisode | None))
    if not feed.full:
        with closing(map_ordered(left, partial(open_episodes, setup), workers, activity=ACTIVITY, chunk=1)) as found:
            for result in found:
                add(result, msgspec.json.encode(result))
                if feed.full:
                    break
    strata = source.strata(feed)
    if not (feed.exhausted if strata else feed.full):
        tasks = f"only {len(episodes)} of {plural(record.episodes, 'scenario')} are feasible"
        raise NotFound(
            f"{tasks}, of {plural(rejected + len(episodes), 'task')}; request fewer, or give a larger budget"
        )
    record = msgspec.structs.replace(record, episodes=len(episodes), rejected=rejected, strata=strata)
    return record, weighted(episodes, strata)


def _write_videos(results: Results, source: ScenarioSource, setup: EpisodeSetup, folder: Path, count: int) -> None:
    """Repeat the first failed episodes exactly, and write a video of each one."""
    from prag_asp.dataset.formats.video import Video
    from prag_asp.missing import require_packages

    require_packages("video", ("av",))
    failed = [number for number, episode in enumerate(results.episodes) if not episode.success][:count]
    with open_runner(setup, render_mode="rgb_array") as runner:
        for number, job in _jobs_of(results, source):
            if number not in failed:
                continue
            frames: list[Any] = []
            runner.run(job, lambda env: frames.append(np.asarray(env.render())))  # noqa: B023  called at once
            name = f"{number + 1:06}.mp4"
            height, width = frames[0].shape[:2]
            make_folder(folder / VIDEOS)
            video = Video(file_in(folder / VIDEOS, name), (width, height), runner.frame_rate)
            for frame in frames:
                video.add(frame)
            video.close()
            if number == failed[-1]:
                return


def _jobs_of(results: Results, source: ScenarioSource) -> Iterator[tuple[int, EpisodeJob]]:
    """Yield the job for each episode, with the number of the episode."""
    number = 0
    for _, job in chain.from_iterable(group.jobs for group in source.groups()):
        if number < len(results.episodes) and str(job.scenario) == results.episodes[number].scenario:
            yield number, job
            number += 1


def _name(function: Any) -> str:
    """Return the name of a function or a class, preceded by its module."""
    return f"{getattr(function, '__module__', '')}:{getattr(function, '__qualname__', type(function).__qualname__)}"
