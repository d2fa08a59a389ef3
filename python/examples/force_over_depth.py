# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Force over depth
#
# How stiff is the liver under the tip of a probe? A controller presses straight down, slowly, and comes back. The force is the tissue's on the instrument;
# the depth is how far the tip is beyond the point of first contact.

# %%
import calot
import numpy as np

env = calot.Environment("touch-liver", seed=1)
env.reset()
env.mount("right", "probe")

# %% [markdown]
# The point: of the liver's triangles that look straight at the right port, to 15 degrees, the one nearest to it.

# %%
liver, port = env.moment().surfaces["liver"], env.scene.ports[1]
corners = liver.position[liver.triangles]
middle = corners.mean(axis=1)
normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
normal /= np.linalg.norm(normal, axis=1)[:, None]
way_in = (middle - port) / np.linalg.norm(middle - port, axis=1)[:, None]
facing = np.einsum("ij,ij->i", normal, way_in) < -np.cos(np.radians(15.0))
chosen = np.flatnonzero(facing)[np.argmin(np.linalg.norm(middle[facing] - port, axis=1))]
target, along = middle[chosen], way_in[chosen]

# %% [markdown]
# 0.3 s to the surface, 1 s down to 8 mm, 1 s back. One action a step of 10 ms; all of them in one call.

# %%
down = np.linspace(0.0, 0.008, 100)
way = np.concatenate([np.linspace(-0.015, 0.0, 60), down, down[::-1]])
actions = np.repeat(env.hands[None], len(way), axis=0)
actions[:, 1, :3] = target + way[:, None] * along
results = env.run(actions)

# %%
force = -results["right/contact_force"] @ along  # along the way in, positive where the tissue pushes back
touching = results["right/organ_force"][:, env.scene.structures.index("liver")] > 0.0
first = int(np.argmax(touching))
depth = (results["right/tip_real"] - results["right/tip_real"][first]) @ along

# %% [markdown]
# The slope on the way in, from a straight line through 1 to 4 mm.

# %%
inwards = np.arange(len(way)) < 160
fitted = inwards & (depth > 0.001) & (depth < 0.004)
slope = np.polyfit(depth[fitted], force[fitted], 1)[0]
print("depth (mm)  force in (N)  force out (N)")
for d in (1, 2, 4, 6):
    there = [np.argmin(np.abs(np.where(side, depth, np.inf) - d / 1000)) for side in (inwards, ~inwards)]
    print(f"{d:10d}  {force[there[0]]:12.3f}  {force[there[1]]:13.3f}")
print(f"stiffness between 1 and 4 mm: {slope:.0f} N/m, over {fitted.sum()} steps; contact after {first} steps")
assert touching.any() and slope > 0.0
env.close()
