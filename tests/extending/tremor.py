# SPDX-License-Identifier: GPL-3.0-or-later
NAME = "right-tremor"
VERSION = 1
UNIT = "m"
BETTER = "lower"


def compute(attempt):
    y = attempt.samples["right_position"][:, 1]
    if len(y) < 100:
        return None, "shorter than 0.1 s"
    # What remains of the height when its mean over 50 ms is taken away: nothing below 20 Hz.
    smooth = sum(y[k:len(y) - 49 + k] for k in range(50)) / 50
    return float(abs(y[25:len(y) - 24] - smooth).mean())
