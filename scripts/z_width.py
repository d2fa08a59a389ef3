#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the closed loop's table (test_closed_loop) into docs/explanation/forces.md, and draws it."""
import argparse
import os
import pathlib
import subprocess
import sys

BEGIN, END = "<!-- table: scripts/z_width.py -->", "<!-- end of table -->"
STIFFEST = 20000


def measured(program):
    """(passive, damping, delay): (stiffest wall, stiffness shown there, stiffness shown of 300 N/m)."""
    done = subprocess.run([str(program), "--gtest_filter=ZWidthHeavy.Table"], env={**os.environ, "CALOT_HEAVY": "1"},
                          capture_output=True, text=True, check=False)
    rows = {}
    for line in done.stdout.splitlines():
        if line.startswith("zwidth "):
            passive, damping, delay, *values = line.split()[1:]
            rows[passive == "1", float(damping), int(delay)] = tuple(float(v) for v in values)
    if done.returncode != 0 or not rows:
        sys.exit(f"{program}: the table could not be made\n{done.stdout[-2000:]}")
    return rows


def stiffness(value):
    return f"over {STIFFEST:,}" if value >= STIFFEST else f"{value:,.0f}"


def table(rows):
    delays = sorted({key[2] for key in rows})
    dampings = sorted({key[1] for key in rows})
    out = ["Stiffest wall that stays still (N/m), over the wall's damping and the delay; the simulated hand of above.", "",
           "| | damping (N s/m) | " + " | ".join(f"{d} ms" for d in delays) + " |", "|---|---|" + "---|" * len(delays)]
    for passive, name in ((False, "as it is"), (True, "passive")):
        for damping in dampings:
            out.append(f"| {name} | {damping:g} | " + " | ".join(stiffness(rows[passive, damping, d][0]) for d in delays) + " |")
    out += ["", "What the hand feels of a wall of 300 N/m without damping (N/m, mean force over mean depth in the last second):", "",
            "| | " + " | ".join(f"{d} ms" for d in delays) + " |", "|---|" + "---|" * len(delays)]
    for passive, name in ((False, "as it is"), (True, "passive")):
        out.append(f"| {name} | " + " | ".join(f"{rows[passive, 0.0, d][2]:,.0f}" for d in delays) + " |")
    out += ["", f"And of one of {STIFFEST:,} N/m, passive:", "", "| damping (N s/m) | " + " | ".join(f"{d} ms" for d in delays) + " |",
            "|---|" + "---|" * len(delays)]
    for damping in dampings:
        out.append(f"| {damping:g} | " + " | ".join(f"{rows[True, damping, d][1]:,.0f}" for d in delays) + " |")
    return "\n".join(out)


def diagram(rows, path):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "calot"
    import matplotlib.pyplot as plot
    figure, axes = plot.subplots(1, 2, figsize=(9, 3.8), layout="constrained", sharey=True)
    delays = sorted({key[2] for key in rows})
    dampings = sorted({key[1] for key in rows})
    titles = ("as it is: stiffest wall that stays still", f"passive: what is felt of {STIFFEST:,} N/m, still")
    for panel, passive, title in zip(axes, (False, True), titles):
        for i, delay in enumerate(delays):
            panel.semilogy(dampings, [max(1.0, rows[passive, b, delay][1 if passive else 0]) for b in dampings], "o-", markersize=4,
                           color=plot.cm.viridis(i / len(delays)), label=f"{delay} ms" if passive else None)
        panel.set_title(title, fontsize=10)
        panel.set_xlabel("damping of the wall (N s/m)")
        panel.grid(True, which="major", alpha=0.3)
    axes[0].set_ylabel("stiffness (N/m)")
    figure.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), title="delay", fontsize=8)
    figure.savefig(path, bbox_inches="tight", metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=pathlib.Path, help="test_closed_loop")
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[1])
    arguments = parser.parse_args()
    page = arguments.root / "docs/explanation/forces.md"
    text = page.read_text(encoding="utf-8")
    if BEGIN not in text or END not in text:
        sys.exit(f"{page}: the marks of the table are not there: {BEGIN} and {END}")
    rows = measured(arguments.program)
    before, rest = text.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    picture = "![Stiffest still wall without the controller and felt stiffness with it](../pictures/z-width.svg)"
    diagram(rows, arguments.root / "docs/pictures/z-width.svg")
    page.write_text(f"{before}{BEGIN}\n\n{table(rows)}\n\n{picture}\n\n{END}{after}", encoding="utf-8")
    print(f"z-width: {page.name} and z-width.svg written")


if __name__ == "__main__":
    main()
