# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # A controller that touches the liver
#
# It sees what the environment reports, and moves the right hand towards a point of the liver until the liver pushes back with 0.3 N; then it holds that
# force for half a second. What it did is recorded as any source's attempt, marked as a controller's, and the recording is verified bit for bit.

# %%
import pathlib
import tempfile

import calot
import numpy as np

folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-"))
WANTED = 0.3  # N
SPEED = 0.0004  # m a step: 40 mm/s
GAIN = 0.002  # m a step for each newton that is missing: the liver gives way by some 0.04 m a newton

# %%
env = calot.Environment("touch-liver", seed=4, seconds=5.0)
env.record(folder / "touch.h5", controller="touch", version="1")
observation, info = env.reset()
liver = env.scene.structures.index("liver")
surface, port = env.moment().surfaces["liver"], env.scene.ports[1]
corners = surface.position[surface.triangles]
middle = corners.mean(axis=1)
normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
normal /= np.linalg.norm(normal, axis=1)[:, None]
way_in = (middle - port) / np.linalg.norm(middle - port, axis=1)[:, None]
facing = np.einsum("ij,ij->i", normal, way_in) < -np.cos(np.radians(15.0))
chosen = np.flatnonzero(facing)[np.argmin(np.linalg.norm(middle[facing] - port, axis=1))]
target, along = middle[chosen], way_in[chosen]

# %% [markdown]
# First the way to the target, then along the shaft by what the force is short of.

# %%
action = env.hands
held = 0
forces = []
while held < 50:
    force = observation["structure_force"][1, liver]
    missing = target - action[1, :3]
    if force == 0.0 and held == 0 and np.linalg.norm(missing) > SPEED:
        action[1, :3] += SPEED * missing / np.linalg.norm(missing)
    else:
        action[1, :3] += np.clip(GAIN * (WANTED - force), -SPEED, SPEED) * along
    observation, reward, terminated, truncated, info = env.step(action)
    force = observation["structure_force"][1, liver]
    held = held + 1 if abs(force - WANTED) < 0.1 * WANTED else 0
    forces.append(force)
    if terminated or truncated:
        break
env.finish("completed")

# %%
recording = calot.open(folder / "touch.h5")
report = recording.verify()
print(f"{len(forces)} steps, the last 50 at {np.mean(forces[-50:]):.3f} N (wanted {WANTED} N)")
print(f"{recording.operator}, {recording.outcome}: {report['message']}, {report['steps']} steps")
assert held == 50 and report["verdict"] == "bit-exact"

# %%
(folder / "touch.h5").unlink()
folder.rmdir()
