from __future__ import annotations

import os

from prag_asp.physics.bullet import mute_output


def test_a_descriptor_is_restored_when_the_last_context_that_muted_it_ends() -> None:
    heard, spoken = os.pipe()
    one, two = mute_output(spoken), mute_output(spoken)
    one.__enter__()
    two.__enter__()
    one.__exit__(None, None, None)  # as threads do: not the last one first
    os.write(spoken, b"not heard ")
    two.__exit__(None, None, None)
    os.write(spoken, b"heard")
    assert os.read(heard, 100) == b"heard"
    os.close(heard)
    os.close(spoken)
