"""A few of the kills that ``python -m tests.output.kills`` does many of."""

from __future__ import annotations

import pytest

from tests.output.kills import campaign


@pytest.mark.slow
def test_commands_that_are_killed_at_random_moments_cut_no_file_and_end_with_the_same_bytes() -> None:
    assert sum(campaign(2, 5, ["enumerate", "split"]).values()) == 2
