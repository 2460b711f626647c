"""The command ``prag-asp`` without what its start costs: a process that has imported everything forks for each.

Whoever has the folder of `warm_commands` at the front of PATH finds there a program ``prag-asp``. It hands its streams,
folder, variables and arguments to that process, and ends with the code of the fork that becomes the command. Pipes and
redirections of a shell are those of the command; what a newly started interpreter alone shows is not to be seen so.
"""

from __future__ import annotations

import atexit
import gc
import json
import os
import select
import signal
import socket
import subprocess
import sys
import traceback
from contextlib import ExitStack, suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NoReturn

from tests.grasps import grasps_shared, shared_folder

ROOT = Path(__file__).parent.parent
SERVE = "import sys; from tests.warm import serve; serve(*sys.argv[1:])"

OFTEN = ("prag", "tabletop", "blocks", "hanoi")
"""Domains that most commands refer to: they are loaded, and their logic is computed, once before the first fork."""

PLACE = "place"
"""Where the process is asked, in the folder of the program: a whole path may be longer than sockets allow."""

ASK = """#!{python} -IS
import json, os, socket, sys
said = json.dumps([os.getcwd(), dict(os.environ), sys.argv[1:]]).encode()
with socket.socket(socket.AF_UNIX) as server:
    os.chdir({folder!r})
    server.connect({place!r})
    socket.send_fds(server, [b"0"], [0, 1, 2])
    server.sendall(said)
    server.shutdown(socket.SHUT_WR)
    code = server.recv(9)
sys.exit(int(code))
"""


@cache
def warm_commands() -> Path:
    """Return the folder of the program that asks a warm process, which is there until this one ends."""
    with ExitStack() as ending:
        folder = Path(ending.enter_context(TemporaryDirectory()))
        program = folder / "prag-asp"
        program.write_text(ASK.format(python=sys.executable, folder=str(folder), place=PLACE))
        program.chmod(0o700)
        variables = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1", "LC_ALL": "C.UTF-8"}
        command = [sys.executable, "-c", SERVE, *map(str, filter(None, (folder, shared_folder())))]
        server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=variables)
        ending.enter_context(server)
        assert server.stdin is not None and server.stdout is not None
        ending.callback(server.stdin.close)  # which ends it, as the sudden end of this process would
        assert server.stdout.readline() == b"warm\n"
        atexit.register(ending.pop_all().close)
    return folder


def serve(folder: str, grasps: str = "") -> None:
    """Become the commands that are asked for in a folder, each in a fork, until nobody can ask any more.

    `grasps` is the folder with the grasps of bodies that tests have found, if they are shared.
    """
    from tests.shared_domains import share_shipped_domains

    share_shipped_domains()
    from prag_asp import TaskSpace, load_domain
    from prag_asp.physics.filming.appearance_meshes import COARSE, FINE, MIDDLE, low_files
    from tests.fuzz.isolated import warm
    from tests.sharing import logic_shared, small_pictures

    warm()
    sys.path.remove("")  # what lies in the folder of a command is not a module for it
    with ExitStack() as shared, socket.socket(socket.AF_UNIX) as asked:
        for each in (small_pictures(), logic_shared(), *([grasps_shared(Path(grasps))] if grasps else [])):
            shared.enter_context(each)
        for name in OFTEN:
            TaskSpace(load_domain(name), 1).sample(1, seed=0)
        for fineness in (COARSE, MIDDLE, FINE):
            low_files("panda", fineness)
        gc.collect()
        gc.freeze()
        os.chdir(folder)
        asked.bind(PLACE)
        asked.listen()
        os.write(1, b"warm\n")
        while asked in select.select([asked, sys.stdin], [], [])[0]:
            connection, _ = asked.accept()
            if os.fork() == 0:
                asked.close()
                _answer(connection)
            connection.close()
            _forget_the_ended()


def _forget_the_ended() -> None:
    """Let go of the forks that have ended."""
    with suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            continue


def _answer(connection: socket.socket) -> NoReturn:
    """Run one command in a fork of this one, and tell its code; where nobody waits for it any more, end it."""
    _, streams, _, _ = socket.recv_fds(connection, 1, 3)
    with connection.makefile("rb") as said:
        folder, variables, arguments = json.loads(said.read())
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
    command = os.fork()
    if command == 0:
        connection.close()
        _become(folder, variables, arguments)
    either = select.poll()
    either.register(os.pidfd_open(command), select.POLLIN)
    either.register(connection, 0)  # of which one hears that it is closed
    if [each for each, _ in either.poll()] == [connection.fileno()]:
        os.kill(command, signal.SIGKILL)
    _, status = os.waitpid(command, 0)
    with suppress(OSError):
        connection.sendall(str(os.waitstatus_to_exitcode(status)).encode())
    os._exit(0)


def _become(folder: str, variables: dict[str, str], arguments: list[str]) -> NoReturn:
    """Be the process of a command, with its streams already, to its end.

    At the end Python would take apart all that is there, which is shared until then, and would first be copied for it.
    """
    from prag_asp.cli import main

    os.chdir(folder)
    os.environ.clear()
    os.environ.update(variables)
    sys.argv = ["prag-asp", *arguments]
    code = 1
    try:
        main()
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else 1
    except BaseException:
        traceback.print_exc()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):
            stream.flush()
    os._exit(code)
