# SPDX-License-Identifier: GPL-3.0-or-later
"""What stepping from Python costs over stepping in C++: the same actions, step by step from Python and all in one call.

usage: stepping.py [SCENE...]

Both simulate the same bits. They take turns, and of each the fastest run counts, in processor time of this thread: what else the machine does weighs on
both alike, and least on the fastest.
"""
import sys
import time

import calot
import numpy as np

STEPS, TURNS = 200, 7


def actions(env: calot.Environment) -> calot._arrays.Array:
    """The right tip goes to the nearest point of the first structure and stirs there, so that tissue is simulated in most steps."""
    env.reset()
    home = env.hands
    surface = next(iter(env.moment().surfaces.values())).position
    target = surface[np.argmin(np.linalg.norm(surface - home[1, :3], axis=1))]
    made = np.repeat(home[None], STEPS, axis=0)
    made[:, 1, :3] += np.clip(np.arange(1, STEPS + 1) / 50, 0.0, 1.0)[:, None] * (target - home[1, :3])
    made[:, 1, 1] += 0.002 * np.sin(np.arange(STEPS) / 10)
    return made


def in_cpp(env: calot.Environment, rows: calot._arrays.Array) -> None:
    env.run(rows)


def in_python(env: calot.Environment, rows: calot._arrays.Array) -> None:
    for row in rows:
        env.step(row)


def main() -> None:
    for scene in sys.argv[1:] or ["touch-liver", "dissect-bed", "cholecystectomy"]:
        env = calot.Environment(scene, seed=1)
        rows = actions(env)
        best = {in_cpp: float("inf"), in_python: float("inf")}
        for _ in range(TURNS):
            for way in best:
                env.reset()
                begin = time.thread_time()
                way(env, rows)
                best[way] = min(best[way], time.thread_time() - begin)
        cpp, python = (1e6 * t / STEPS for t in best.values())
        print(f"{scene}: {cpp:.0f} us a step in C++, {python:.0f} us from Python, ratio {python / cpp:.3f} ({python - cpp:+.1f} us)", flush=True)


if __name__ == "__main__":
    main()
