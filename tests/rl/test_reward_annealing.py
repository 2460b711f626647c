from __future__ import annotations

import pytest

from prag_asp.rl.reward_annealing import RewardAnnealing


def test_a_share_fades_as_episodes_end_well_and_comes_back_as_they_do_not() -> None:
    fading, shares = RewardAnnealing("success"), []
    for success in (*[False] * 10, *[True] * 60, *[False] * 60):
        fading.step()
        fading.end(success)
        shares.append(fading.share)
    assert shares[:10] == [1.0] * 10, "no success yet"
    assert shares[10:60] == pytest.approx([1.0 - number / 50 for number in range(1, 51)])
    assert shares[60:70] == [0.0] * 10
    assert shares[70:120] == pytest.approx([number / 50 for number in range(1, 51)])


def test_a_share_fades_with_steps_whatever_comes_of_them() -> None:
    fading, shares = RewardAnnealing(4), []
    for success in (True, False) * 3:
        shares.append(fading.share)
        fading.step()
        fading.end(success)
    assert shares == [1.0, 0.75, 0.5, 0.25, 0.0, 0.0]
