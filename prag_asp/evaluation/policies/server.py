"""A policy behind a websocket that follows the protocol of openpi's policy servers.

Messages are encoded as msgpack; an array is a map with the binary keys ``__ndarray__`` (true), ``data`` (its bytes),
``dtype`` (NumPy's type string) and ``shape``. The server first sends a map of metadata. Each request is a map with an
observation, and each response is a map with ``actions``: an array of one action, or of a chunk of actions to be
performed in sequence. A text message reports an error on the server.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from contextlib import ExitStack
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prag_asp.errors import QueryError
from prag_asp.evaluation.policies.policy import Environment, PolicyMaker

WAIT = 600.0
"""The time limit for an answer, in seconds; a server may load or compile its model at the first request."""

CAMERA = "camera_"
"""The prefix of images in an observation of the environment."""

ARRAY = b"__ndarray__"


class ServerPolicy:
    """A policy that requests actions from a server, a chunk at a time.

    A request has ``observation/state`` (the numbers of the observation), ``observation/NAME`` for each camera (8-bit
    colours, height x width x 3), and ``prompt``, the instruction.
    """

    def __init__(self, address: str) -> None:
        """Connect to a server.

        Raises:
            QueryError: no server responds at the address, or a package is missing.
        """
        self._address, self._resources = address, ExitStack()
        try:
            from websockets.exceptions import WebSocketException
            from websockets.sync.client import connect
        except ImportError:
            raise QueryError('policy servers need websockets and msgpack: pip install "prag_asp[servers]"') from None
        self._errors = (WebSocketException, OSError, TimeoutError)
        try:
            self._connection = self._resources.enter_context(connect(address, compression=None, max_size=None))
            self._received()  # metadata
        except (*self._errors, ValueError) as error:
            raise QueryError(f"{address}: no policy server answers: {_line(error)}; start it first") from None
        self._chunk: deque[NDArray[Any]] = deque()

    def begin(self, seed: int) -> None:
        """Begin an episode: discard the rest of the last chunk."""
        self._chunk.clear()

    def __call__(self, observation: Any, info: Mapping[str, Any]) -> NDArray[Any]:
        """Return the next action in the chunk, or the first action of the next chunk.

        Raises:
            QueryError: the server reports an error, disconnects, or violates the protocol.
        """
        if not self._chunk:
            numbers = observation["observation"] if isinstance(observation, Mapping) else observation
            images = {
                f"observation/{name.removeprefix(CAMERA)}": image
                for name, image in (observation.items() if isinstance(observation, Mapping) else ())
                if name.startswith(CAMERA)
            }
            request = {"observation/state": numbers, **images, "prompt": info["instruction"]}
            try:
                self._connection.send(_packed(request))
                answer = self._received()
            except self._errors as error:
                raise QueryError(f"{self._address}: the policy server does not answer: {_line(error)}") from None
            actions = answer.get("actions") if isinstance(answer, Mapping) else None
            if not isinstance(actions, np.ndarray) or actions.ndim not in (1, 2) or not actions.size:
                raise QueryError(
                    f"{self._address}: an answer needs an array 'actions' with one action or a chunk of them"
                )
            self._chunk.extend(np.atleast_2d(actions))
        return self._chunk.popleft()

    def close(self) -> None:
        """Close the connection."""
        self._resources.close()

    def _received(self) -> Any:
        """Return the next message."""
        message = self._connection.recv(timeout=WAIT)
        if isinstance(message, str):
            last = message.strip().splitlines()[-1:]
            raise QueryError(f"{self._address}: the policy server reports an error: {' '.join(last):.300}")
        return unpacked(message)


def maker(text: str) -> PolicyMaker:
    """Return the maker of a client for a server."""

    def make(env: Environment) -> ServerPolicy:
        return ServerPolicy(text)

    return make


def _packed(values: Mapping[str, Any]) -> bytes:
    """Return the message that encodes a map with arrays."""
    import msgpack

    def encoded(value: Any) -> Any:
        if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
            return {ARRAY: True, b"data": value.tobytes(), b"dtype": value.dtype.str, b"shape": value.shape}
        raise TypeError(f"{type(value).__name__} is not sent to a server")

    message: bytes = msgpack.packb(values, default=encoded)
    return message


def unpacked(message: bytes) -> Any:
    """Return the decoded values of a message.

    Raises:
        QueryError: the message violates the protocol.
    """
    import msgpack

    def decoded(value: dict[Any, Any]) -> Any:
        if ARRAY in value:
            kind = np.dtype(value[b"dtype"])
            if kind.kind not in "biuf":
                raise ValueError(f"an array of {kind}")
            return np.frombuffer(value[b"data"], kind).reshape(value[b"shape"])
        return value

    try:
        return msgpack.unpackb(message, object_hook=decoded, strict_map_key=False)
    except (ValueError, TypeError, KeyError, msgpack.UnpackException) as error:
        raise QueryError(f"a message of the policy server does not follow the protocol: {_line(error)}") from None


def _line(error: Exception) -> str:
    """Return an error as one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())
