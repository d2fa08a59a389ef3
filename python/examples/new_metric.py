# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # A new metric over a cohort
#
# How much of the instruments' path is made while they press on the liver? No checkpoint says so. It takes a cohort, its recordings, and a few lines over
# their arrays. Here the attempts are performers': what is shown is how it is done, nothing about people.

# %%
import pathlib
import tempfile

import calot
import numpy as np

folder = pathlib.Path(tempfile.mkdtemp(prefix="calot-"))
cohort = folder / "cohort.db"

# %% [markdown]
# Six attempts, recorded and assessed. Each recording is re-simulated bit for bit before its values are stored.

# %%
for performer in ("skilled", "unskilled"):
    for seed in (1, 2, 3):
        file = folder / f"{performer}-{seed}.h5"
        calot.record(file, "touch-liver", performer, seed=seed, seconds=4, purpose="study")
        calot.assess(file, cohort=cohort)

# %% [markdown]
# The metric: length of the tip's path in steps in which a force acts on the liver, over the whole path. It is a share, without unit.


# %%
def pressed_share(recording: calot.Recording, hand: str) -> float:
    path = np.linalg.norm(np.diff(recording.observables[f"{hand}/tip_simulated"], axis=0), axis=1)
    liver = recording.structures.index("liver")
    pressing = recording.observables[f"{hand}/organ_force"][1:, liver] > 0.0
    return float(path[pressing].sum() / path.sum())


# %%
attempts = calot.Cohort(cohort).attempts(frame=False, include=("synthetic", "practice"))
shares: dict[str, list[float]] = {}
for file, profile in zip(attempts["file"], attempts["profile"]):
    recording = calot.open(folder / file)
    shares.setdefault(str(profile), []).extend(pressed_share(recording, hand) for hand in ("left", "right"))

# %% [markdown]
# Beside it a checkpoint of the cohort, read the same way.

# %%
values = calot.Cohort(cohort).values(frame=False, include=("synthetic", "practice"), name="path-length")
for profile, numbers in sorted(shares.items()):
    lengths = values["value"][values["profile"] == profile]
    print(f"{profile:<10} {len(numbers)} hands: {100 * np.median(numbers):.1f} % of the path pressed (median), path length {np.median(lengths):.2f} m")
print("performers: this shows the method, not what skilled people do")

# %%
for left in folder.iterdir():
    left.unlink()
folder.rmdir()
