"""The server answers its own page only, and each mistake with one line."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from http.client import HTTPConnection
from threading import Event, Thread
from time import sleep
from typing import Any
from urllib.parse import urlencode, urlsplit

import pytest

from prag_asp import LimitReached, QueryError, load_domain
from prag_asp.explore.explored_domain import ExploredDomain
from prag_asp.explore.page_server import PageServer
from prag_asp.explore.physics_view import call_here
from prag_asp.explore.space_pages import PAGE, space_views
from prag_asp.explore.turns import Doing, Turns
from prag_asp.space.limits import Limits
from tests.commands import run

reported: list[str] = []


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    turns = Turns()
    explored = ExploredDomain(
        load_domain("blocks"), ("blocks",), "load_domain('blocks')", limits=Limits(stop=turns.stop)
    )

    def broken(fields: Any) -> Any:
        raise ValueError("a mistake")

    views = {**space_views(explored), "broken": broken}
    with PageServer(PAGE, views, turns, report=reported.append) as server:
        thread = Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def ask(server: PageServer, path: str, method: str = "GET", **headers: str) -> tuple[int, dict[str, str], bytes]:
    connection = HTTPConnection("127.0.0.1", server.port, timeout=180)
    host = {"Host": f"127.0.0.1:{server.port}"}
    connection.request(
        method, path, headers={**host, **{name.replace("_", "-"): text for name, text in headers.items()}}
    )
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, dict(answer.headers), content


def view(server: PageServer, name: str, **fields: str) -> tuple[int, Any]:
    status, _, content = ask(server, f"/{server.token}/api/{name}?{urlencode(fields)}")
    return status, json.loads(content)


def test_the_page_and_its_files_are_served_with_a_strict_policy(server: PageServer) -> None:
    for file in ("", *(path.name for path in PAGE.iterdir())):
        status, headers, content = ask(server, f"/{server.token}/{file}?length=3")
        assert status == 200, file
        assert content == (PAGE / (file or "index.html")).read_bytes()
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "unsafe" not in headers["Content-Security-Policy"]
        assert headers["Cache-Control"] == "no-store"


def test_the_files_name_no_other_host() -> None:
    for path in PAGE.iterdir():
        text = path.read_text().replace("http://www.w3.org/2000/svg", "")
        assert "http:" not in text and "https:" not in text and "//cdn" not in text
        assert "innerHTML" not in text


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("/", {}),
        ("/x/", {}),
        ("//api/plan?state=length=3", {}),
        ("/TOKEN/", {"Host": "evil.example"}),
        ("/TOKEN/", {"Host": "127.0.0.1:1"}),
        ("/TOKEN/api/plan?state=length%3D3", {"Origin": "http://evil.example"}),
        ("/TOKEN/api/plan?state=length%3D3", {"Origin": "null"}),
        ("/TOKEN/api/plan?state=length%3D3", {"Sec_Fetch_Site": "cross-site"}),
    ],
)
def test_other_pages_and_users_are_refused(server: PageServer, path: str, headers: dict[str, str]) -> None:
    status, _, content = ask(server, path.replace("TOKEN", server.token), **headers)
    assert status == 403
    assert len(json.loads(content)["lines"]) == 1


def test_nothing_but_its_own_files_is_served(server: PageServer) -> None:
    for path in ("../page_server.py", "..%2fpage_server.py", "page/", "api/", "api/nothing", "/etc/passwd"):
        assert ask(server, f"/{server.token}/{path}")[0] == 404
    assert ask(server, f"/{server.token}/", "POST")[0] == 501
    assert ask(server, f"/{server.token}/?{'x' * 70_000}")[0] == 414


def test_views_are_json_and_mistakes_are_one_line(server: PageServer) -> None:
    status, plan = view(server, "plan", state="length=6")
    assert (status, plan["count"]) == (200, "84")
    assert view(server, "count", state="length=4&where=usess")[1] == {
        "refused": ["condition 'usess': no condition 'usess'; did you mean uses?"]
    }
    for name, fields in (
        ("plan", {"state": "length=6&where=matches+(("}),
        ("plan", {"state": "length=3&where=ends+" + "(" * 5000}),
        ("rank", {"state": "length=3", "rank": "9" * 4000}),
        ("sample", {"state": "length=3", "seed": "-1"}),
        ("sample", {"state": "length=3&where=lacks+pick_up", "seed": "1"}),
        ("compare", {"state": "length=3"}),
        ("plan", {"state": "length=3", "number": "x"}),
    ):
        status, problem = view(server, name, **fields)
        assert (status, len(problem["refused"])) == (200, 1), (name, problem)
    assert ask(server, f"/{server.token}/api/plan?{'&'.join('a=1' for _ in range(40))}")[0] == 400


def test_a_mistake_of_the_package_ends_one_request(server: PageServer) -> None:
    assert view(server, "broken")[0] == 500
    assert reported == ["broken: ValueError: a mistake"]
    assert view(server, "count", state="length=1")[0] == 200


def test_other_views_are_answered_while_physics_judges_a_task() -> None:
    pytest.importorskip("pybullet")
    begun, go = Event(), Event()

    def call(*work: Any) -> Any:
        begun.set()
        assert go.wait(60)
        return call_here(*work)

    turns, verdicts = Turns(), []
    explored = ExploredDomain(load_domain("tabletop"), ("tabletop",), "", progress=turns.tell)
    state = "length=1&do=pick(panda,brick_1,bin_1)"
    with PageServer(PAGE, space_views(explored, call), turns) as server:
        serving = Thread(target=server.serve_forever, args=(0.01,))
        judging = Thread(target=lambda: verdicts.append(view(server, "verdict", state=state, window="w/physics")))
        for thread in (serving, judging):
            thread.start()
        assert begun.wait(60)
        turns.tell("counting")
        assert view(server, "count", state=state)[1]["count"] == "1"
        assert json.loads(ask(server, f"/{server.token}/api/doing")[2])["note"] == ""
        go.set()
        judging.join()
        assert [(status, found["status"]) for status, found in verdicts] == [(200, "feasible")]
        status, headers, content = ask(server, f"/{server.token}/api/strip?{urlencode({'state': state})}")
        assert (status, headers["Content-Type"], content[1:4]) == (200, "image/png", b"PNG")
        assert view(server, "end", window="w/physics", number="1") == (200, {"ended": True})
        assert view(server, "verdict", state=state, window="w/physics")[0] == 409
        server.shutdown()
        serving.join()


def test_an_older_request_of_a_window_is_dropped(server: PageServer) -> None:
    assert view(server, "count", state="length=2", window="w", number="2")[0] == 200
    assert view(server, "count", state="length=2", window="w", number="1")[0] == 409
    assert view(server, "count", state="length=2", window="v", number="1")[0] == 200


def test_a_closed_connection_ends_the_work_on_its_request() -> None:
    turns, begun = Turns(), Event()

    def endless(fields: Any) -> Any:
        begun.set()
        while turns.stop() is None:
            sleep(0.01)
        raise LimitReached("ended", 0, turns.stop())

    def short(fields: Any) -> Doing:
        return Doing("done")

    with PageServer(PAGE, {"endless": endless, "short": short}, turns) as server:
        serving = Thread(target=server.serve_forever, args=(0.01,))
        serving.start()
        with socket.create_connection(("127.0.0.1", server.port)) as connection:
            host = f"Host: 127.0.0.1:{server.port}"
            connection.sendall(f"GET /{server.token}/api/endless?window=w HTTP/1.1\r\n{host}\r\n\r\n".encode())
            assert begun.wait(60)
        assert view(server, "short", window="v") == (200, {"words": "done", "note": ""})
        server.shutdown()
        serving.join()


def test_a_used_port_is_one_line(server: PageServer) -> None:
    with pytest.raises(QueryError, match="another program uses it"):
        PageServer(PAGE, {}, Turns(), port=server.port)


def test_the_server_listens_on_the_loopback_address_only(server: PageServer) -> None:
    assert server.server_address[0] == "127.0.0.1"
    assert urlsplit(server.link).hostname == "127.0.0.1"
    with socket.create_connection(("127.0.0.1", server.port)):
        pass


def test_the_command_refuses_wrong_conditions_and_prefixes_before_it_serves() -> None:
    for options, problem in (
        (("--where", "usess"), "did you mean uses"),
        (("--prefix", "pick_up"), "choose an action with its arguments"),
        (("--length", "2..3"), "2..3"),
        (("--port", "99999"), "99999"),
    ):
        done = run("explore", "blocks", "--length", "3", *options)
        assert done.returncode in (2, 64)
        assert done.stdout == ""
        assert problem in done.stderr
        assert len(done.stderr.splitlines()) == 1
