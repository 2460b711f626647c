"""Train a default agent to add actions to a scripted reach, and test it on 30 fresh episodes."""

import gymnasium
from stable_baselines3 import SAC

from prag_asp.rl.wrappers import ScriptedReach

env = ScriptedReach(gymnasium.make("prag_asp.rl:prag_asp/TabletopPick-v0"))
model = SAC("MlpPolicy", env, seed=0).learn(10_000)

ends: list[bool] = []
seen, _ = env.reset(seed=1)
while len(ends) < 30:
    seen, _, reached, late, _ = env.step(model.predict(seen, deterministic=True)[0])
    if reached or late:
        ends.append(reached)
        seen, _ = env.reset()
print(sum(ends), "of", len(ends))
