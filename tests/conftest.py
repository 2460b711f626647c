"""No test reads or writes the user's cache; chance is the same in every run unless it is asked to be fresh."""

from __future__ import annotations

import gc
import os
import secrets
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from _pytest.runner import runtestprotocol
from hypothesis import is_hypothesis_test

from tests import chance as chances
from tests.patience import patience
from tests.processes import children
from tests.shared_domains import share_shipped_domains

share_shipped_domains()

ROOT = Path(__file__).parent

LONGEST = 900.0
"""Seconds that a test may take, on whatever machine; ten times as many with ten times the examples."""

LONGEST_FILES = (
    "docs/test_examples.py",
    "space/test_known_counts.py",
    "test_wheel.py",
    "dataset/making/test_on_ray.py",
    "rl/test_learning.py",
    "output/test_kills.py",
    "fuzz/test_campaign.py",
    "space/test_orbits.py",
    "cli/test_validate.py",
    "physics/test_scenes.py",
    "space/test_reduced_count.py",
    "cli/test_supervision.py",
    "evaluation/test_evaluate.py",
    "rl/test_environment.py",
    "space/test_five_engines.py",
)
"""The files that take longest, longest first, as measured: several processes begin with them."""

ATTEMPTS = 3
"""How often a test is run at most, if the machine is suspended in each of its runs."""

COMPLAINTS = pytest.StashKey[int]()
"""Where what goes wrong with a test as a whole is told, past what is captured of it."""

os.environ["PRAG_ASP_CACHE"] = ""
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command has it: a thread more waits in vain, and computes
if os.environ.pop("PYTHONDONTWRITEBYTECODE", None):  # processes that tests start need not compile the package each time
    sys.dont_write_bytecode = False

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in a shell's background, and so in all that tests interrupt
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("chance", "random tests")
    group.addoption(
        "--fresh",
        action="store_true",
        help="Run the random tests alone, with fresh seeds and ten times the examples, and say with which seed.",
    )
    group.addoption("--seed", type=int, metavar="N", help="Do again what --fresh did with this seed.")
    group.addoption(
        "--found",
        type=Path,
        default=chances.FOUND,
        metavar="FOLDER",
        help="The examples that tests have failed for, which --fresh adds to.  [default: tests/found]",
    )


@pytest.hookimpl(tryfirst=True)  # before hypothesis reads its seed
def pytest_configure(config: pytest.Config) -> None:
    options = config.option
    config.stash[COMPLAINTS] = os.dup(2)  # nothing is captured yet
    if options.fresh and options.seed is None:
        options.seed = getattr(config, "workerinput", {}).get("seed") or secrets.randbelow(10**9)
    if options.seed is None:
        chances.fix(options.found)
    else:
        options.hypothesis_seed = str(options.seed)
        chances.freshen(options.seed, options.found)


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tell a process that runs a part of the tests the seed that they all have."""
    node.workerinput["seed"] = node.config.option.seed


def pytest_sessionstart(session: pytest.Session) -> None:
    """Have each of several processes begin with other tests, so that none of them compiles what another one has.

    What fails here does so again where it is told.
    """
    worker = getattr(session.config, "workerinput", None)
    if worker is None:
        return
    asked = {str(Path(each.partition("::")[0]).resolve()) for each in session.config.args}
    files = [each for each in sorted(ROOT.rglob("test_*.py")) if not asked.isdisjoint(map(str, (each, *each.parents)))]
    first = int(worker["workerid"].removeprefix("gw")) * len(files) // worker["workercount"]
    for file in (*files[first:], *files[:first]):
        with suppress(Exception, pytest.skip.Exception):
            import_module(".".join(file.relative_to(ROOT.parent).with_suffix("").parts))


def pytest_report_header(config: pytest.Config) -> str | None:
    return _told(config)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    told = _told(config)
    if told is not None and terminalreporter.stats.get("failed"):
        terminalreporter.section("random tests")
        terminalreporter.line(told)
        terminalreporter.line(f"what hypothesis found is in {config.option.found}, and is tried first from now on")


def _told(config: pytest.Config) -> str | None:
    """Return how to do a fresh run again."""
    seed = config.option.seed
    return None if seed is None else f"random tests alone, with fresh seeds; again: pytest --seed {seed}"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.option.seed is not None:
        random = [item for item in items if _has_examples(item) or "chance" in getattr(item, "fixturenames", ())]
        config.hook.pytest_deselected(items=[item for item in items if item not in random])
        items[:] = random
    # What takes long comes first, so that no process is left with it at the end while the others have nothing to do.
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    tests = Counter(item.path for item in items)
    place = {ROOT / name: number for number, name in enumerate(LONGEST_FILES)}
    items.sort(key=lambda item: (place.get(item.path, len(place)), item.path not in slow, -tests[item.path]))


def pytest_collection_finish() -> None:
    """Look for garbage less often, and never in what was imported: it is large, and stays to the end."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 50)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    """Run a test within its time, and again if it fails while the machine was suspended, for that ends all waits."""
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    seconds = LONGEST * (1 if item.config.option.seed is None else 10)
    for _ in range(ATTEMPTS):
        with patience(seconds, item.config.stash[COMPLAINTS]) as given:
            reports = runtestprotocol(item, log=False, nextitem=nextitem)
        if not given.jumped or not any(report.failed for report in reports):
            break
    for report in reports:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def pytest_runtest_setup(item: pytest.Item) -> None:
    if _has_examples(item):
        # Found examples go by the name: by default they go by a digest of the test's text, and an edit would lose them.
        item.obj._hypothesis_internal_database_key = item.name.encode()  # type: ignore[attr-defined]


def _has_examples(item: pytest.Item) -> bool:
    """Tell whether hypothesis gives a test its examples."""
    return is_hypothesis_test(getattr(item, "obj", None))


@pytest.fixture(scope="session")
def chance() -> chances.Chance:
    """Seeds, generators and numbers of examples that are the same in every run, or fresh."""
    return chances.now()


@pytest.fixture(scope="session", autouse=True)
def shipped_domains_are_checked_once() -> Iterator[None]:
    """Check each shipped domain once in a process, if its tests load any."""
    if "prag_asp" not in sys.modules:
        yield
        return
    from tests.checks import checks_shared

    with checks_shared():
        yield


@pytest.fixture(scope="session", autouse=True)
def grasps_are_searched_once(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Search the grasps of each body once in all processes that run tests, if these tests load any physics."""
    if "prag_asp.physics.grasps.body_grasps" not in sys.modules:
        yield
        return
    from tests.grasps import grasps_shared

    folder = tmp_path_factory.getbasetemp()
    with grasps_shared((folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "grasps"):
        yield


@pytest.fixture
def started() -> Callable[[], list[int]]:
    """Tell which processes a test has started and not seen end: one of a test before, in this process, may stay."""
    before = set(children())
    return lambda: [each for each in children() if each not in before]
