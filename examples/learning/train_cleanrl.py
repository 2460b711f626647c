"""Train CleanRL's soft actor-critic, from a clone of its repository, which is written for an older Gymnasium."""

import runpy
import sys

import gymnasium


class VectorEnv(gymnasium.vector.SyncVectorEnv):
    """Vector environments that report final observations under the key that older ones used."""

    def step(self, actions):
        """Apply actions."""
        *rest, info = super().step(actions)
        return *rest, {"final_observation": info.get("final_obs")}


gymnasium.vector.SyncVectorEnv = lambda makers: VectorEnv(makers, autoreset_mode="SameStep")
sys.argv[1:] = ["--env-id=prag_asp.rl:prag_asp/PragApproach-v0", "--total-timesteps=10000", "--learning-starts=1000"]
sys.path.insert(0, "cleanrl")
actor = runpy.run_path("cleanrl/cleanrl/sac_continuous_action.py", run_name="__main__")["actor"]
