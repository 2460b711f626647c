"""Train a default agent to pick up all objects but cans, and save it as picker.zip."""

import gymnasium
from stable_baselines3 import SAC

from prag_asp.rl.wrappers import ScriptedReach

env = gymnasium.make("prag_asp.rl:prag_asp/Tabletop-v0", length=1, steps=50, split="train", hold_out="can")
SAC("MlpPolicy", ScriptedReach(env), seed=0).learn(10_000).save("picker.zip")
