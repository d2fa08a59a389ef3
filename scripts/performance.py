#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the figures of two runs of calot-bench into docs/explanation/performance.md, with their bounds, and the diagram of time against error."""
import argparse
import json
import pathlib
import platform
import re
import sys

BEGIN, END = "<!-- figures: scripts/performance.sh -->", "<!-- end of figures -->"
# Name, what it is, unit, bound ("<" at most, ">" at least); in the order of the table.
HEADLINES = [
    ("deformation.B.steps_per_s", "deformation alone, case B", "1/s", "> 4000"),
    ("boxes.1500.steps_per_s", "deformation alone, box of 1,500 tetrahedra", "1/s", "> 4000"),
    ("boxes.1500.error", "its error", "", "< 0.001"),
    ("deformation.B.vs_bullet", "Bullet's time on it over ours", "", "> 25"),
    ("boxes.1500.vs_framework", "the paper's framework's time on it over ours", "", "> 6"),
    ("boxes.10800.steps_per_s", "box of 10,800", "1/s", "> 450"),
    ("boxes.10800.error", "its error", "", "< 0.001"),
    ("boxes.10800.vs_bullet", "Bullet's time on it over ours", "", "> 25"),
    ("boxes.10800.vs_framework", "the paper's framework's time on it over ours", "", "> 4.5"),
    ("deformation.E.steps_per_s", "deformation alone, case E", "1/s", "> 270"),
    ("boxes.49152.steps_per_s", "box of 49,152", "1/s", "> 60"),
    ("boxes.49152.vs_framework", "the paper's framework's time on it over ours", "", "> 3.5"),
    ("boxes.202800.steps_per_s", "box of 202,800", "1/s", "> 14"),
    ("boxes.202800.vs_framework", "the paper's framework's time on it over ours", "", "> 3.5"),
    ("deformation.200k.steps_per_s", "liver of 200,000", "1/s", "> 8.4"),
    ("boxes.202800.memory_mb", "memory of a process that solves a box of 202,800", "MB", "< 400"),
    ("price.1500.over_unbound", "time over that without the determinism contract, 1,500", "", "< 1.1"),
    ("price.10800.over_unbound", "the same, 10,800", "", "< 1.1"),
    ("price.49152.over_unbound", "the same, 49,152", "", "< 1.1"),
    ("price.202800.over_unbound", "the same, 202,800", "", "< 1.1"),
    ("step.B.hz", "whole steps, case B", "1/s", "> 1000"),
    ("paper.B.hz", "whole steps of a dissection, case B", "1/s", "> 1000"),
    ("paper.B.minimum_hz", "its slowest step", "1/s", "> 500"),
    ("step.E.hz", "whole steps of it, case E", "1/s", "> 250"),
    ("paper.E.minimum_hz", "its slowest step", "1/s", "> 125"),
    ("scene.operation.step_ms", "a step of the whole operation", "ms", "< 2.5"),
    ("skip.cholecystectomy.rest.step_ms", "a step of it while nobody is near", "ms", "< 0.1"),
    ("replay.cholecystectomy.x_realtime", "replay of the operation over real time", "", "> 10"),
    ("replay.cholecystectomy.x_realtime_2", "the same in segments on two threads", "", "> 10"),
    ("replay.cholecystectomy.speedup_2", "over one thread", "", "> 1.8"),
    ("replay.cholecystectomy.path_32", "segments of an operation over the longest of 32 workers", "", "> 28"),
    ("record.operation_mb", "recording of an operation", "MB", "< 25"),
    ("contact.B.vs_deformation", "contact over deformation, case B", "", "< 3"),
    ("contact.max_depth_mm", "deepest point of an instrument", "mm", "< 0.2"),
    ("haptics.tick_mean_ms", "a tick with 30 contacts, mean", "ms", "< 0.015"),
    ("haptics.tick_p999_ms", "the same, 99.9th percentile", "ms", "< 0.1"),
    ("carve.64.median_ms", "a stroke in 64^3", "ms", "< 0.2"),
    ("carve.128.median_ms", "a stroke in 128^3", "ms", "< 0.5"),
    ("carve.64.adaptive_ms", "the adaptive surface after it", "ms", "< 1.0"),
    ("carve.128.adaptive_ms", "the same in 128^3", "ms", "< 1.5"),
    ("cpt.20k_128.ms", "closest point transform", "ms", "< 50"),
    ("cpt.20k_128.vs_openvdb", "OpenVDB's time on it over ours", "", "> 10"),
    ("record.overhead_percent", "recording, of the loop's time", "%", "< 3"),
    ("record.period_percent", "recording, of a step's period", "%", "< 1"),
    ("seek.max_ms", "longest of 40 seeks", "ms", "< 300"),
    ("render.cholecystectomy.fps", "interactive pictures of the operation", "1/s", "> 30"),
    ("checkpoints.motion_10min_ms", "motion checkpoints of ten minutes", "ms", "< 300"),
    ("cohort.import_ms", "an import among 10,000 attempts", "ms", "< 20"),
    ("cohort.study_ms", "a study of them", "ms", "< 1000"),
    ("cohort.list_ms", "the dashboard's list of them", "ms", "< 50"),
]


def shown(value):
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def meets(value, bound):
    kind, limit = bound.split()
    return value <= float(limit) if kind == "<" else value >= float(limit)


def machine():
    text = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8") if pathlib.Path("/proc/cpuinfo").exists() else ""
    name = re.search(r"model name\s*: (.*)", text)
    cores = text.count("processor\t")
    return f"{name.group(1).strip() if name else platform.machine()}, {cores} processors"


def table(runs):
    lines = [f"Two runs on {machine()}; one thread each. A bound that a run misses is marked.", "",
             "| | run 1 | run 2 | bound |", "| --- | --- | --- | --- |"]
    for name, what, unit, bound in HEADLINES:
        values = [run.get(name) for run in runs]
        if None in values:
            continue
        cells = [shown(v) + ("" if meets(v, bound) else " **missed**") for v in values]
        limit = bound.replace("<", "at most").replace(">", "at least")
        lines.append(f"| {what} (`{name}`){', ' + unit if unit else ''} | {cells[0]} | {cells[1]} | {limit} |")
    return "\n".join(lines)


def diagram(run, out):
    points = {}
    for name, value in run.items():
        match = re.fullmatch(r"precision\.(\d+)\.(ours|bullet)\S*\.(ms|error)", name)
        if match:
            key = name.rsplit(".", 1)[0]
            points.setdefault((int(match.group(1)), match.group(2)), {}).setdefault(key, {})[match.group(3)] = value
    if not points:
        return False
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "calot"
    import matplotlib.pyplot as plot
    figure, axes = plot.subplots(figsize=(7, 4.2), layout="constrained")
    marks = {"ours": ("o", "#0072b2"), "bullet": ("s", "#d55e00")}
    for size, who in sorted(points):
        line = sorted((p["ms"], p["error"]) for p in points[size, who].values())
        mark, colour = marks[who]
        axes.loglog([p[0] for p in line], [p[1] for p in line], mark, color=colour, linestyle="-" if size < 2000 else "--",
                    label=f"{'Calot' if who == 'ours' else 'Bullet, neo-Hookean'}, {size:,} tetrahedra")
    axes.set_xlabel("CPU time of a step (ms)")
    axes.set_ylabel("error of the solver (relative)")
    axes.grid(True, which="major", alpha=0.3)
    figure.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2)
    figure.savefig(out, bbox_inches="tight", metadata={"Date": None})
    return True


def grade_diagram(run, out):
    """A panel a figure: error against its extrapolated limit over cost, a mark a mesh, joined over steps."""
    points = {}
    for name, value in run.items():
        match = re.fullmatch(r"grade\.([\w-]+)\.m([\d.]+)\.h(\d+)\.t([\d.]+)\.error\.(.*)", name)
        if match:
            scene, mesh, step, tolerance, figure = match.groups()
            cost = run.get(f"grade.{scene}.m{mesh}.h{step}.t{tolerance}.ms")
            points.setdefault((scene, figure), []).append((float(mesh), int(step), float(tolerance), cost, value))
    if not points:
        return False
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "calot"
    import matplotlib.pyplot as plot
    columns = 4
    rows = -(-len(points) // columns)
    figure, axes = plot.subplots(rows, columns, figsize=(12, 2.5 * rows), layout="constrained", squeeze=False, sharex=True)
    colours = {0.5: "#56b4e9", 1.0: "#0072b2", 2.0: "#009e73", 4.0: "#d55e00"}
    for panel, ((scene, name), data) in zip(axes.flat, sorted(points.items())):
        for mesh in sorted({p[0] for p in data}):
            line = sorted((p[3], 100 * p[4]) for p in data if p[0] == mesh and p[2] == 1)
            panel.semilogx([p[0] for p in line], [p[1] for p in line], "o-", markersize=4, color=colours.get(mesh),
                           label=f"{mesh:g} times the elements" if panel is axes.flat[0] else None)
        others = [(p[3], 100 * p[4]) for p in data if p[2] != 1]
        panel.semilogx([p[0] for p in others], [p[1] for p in others], "x", color="#999999", markersize=5,
                       label="other tolerances" if panel is axes.flat[0] else None)
        chosen = [p for p in data if p[:3] == (1.0, 10, 1.0)]
        panel.semilogx([p[3] for p in chosen], [100 * p[4] for p in chosen], "o", markersize=9, fillstyle="none", color="black",
                       label="the scene's default" if panel is axes.flat[0] else None)
        panel.axhline(10, color="black", linewidth=0.6, linestyle=":")
        panel.set_title(f"{scene}: {name}", fontsize=8)
        panel.set_ylim(0, min(100, 110 * max(p[4] for p in data)))  # beyond 100 %: another attempt
        panel.tick_params(labelsize=7)
        panel.grid(True, which="major", alpha=0.3)
    for panel in list(axes.flat)[len(points):]:
        panel.set_visible(False)
    figure.supxlabel("CPU time for 10 ms of the attempt (ms)")
    figure.supylabel("error against the extrapolated limit (%)")
    figure.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=6, fontsize=8)
    figure.savefig(out, bbox_inches="tight", metadata={"Date": None})
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", nargs=2, type=pathlib.Path)
    parser.add_argument("--root", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    page = arguments.root / "docs/explanation/performance.md"
    text = page.read_text(encoding="utf-8")
    if BEGIN not in text or END not in text:
        sys.exit(f"{page}: the marks of the table are not there: {BEGIN} and {END}")
    kept = pathlib.Path(arguments.run[0]).parent / "figures.json"
    earlier = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else [{}, {}]
    runs = [{**old, **json.loads(new.read_text(encoding="utf-8"))} for old, new in zip(earlier, arguments.run)]
    kept.write_text(json.dumps(runs, indent=1, sort_keys=True), encoding="utf-8")
    before, rest = text.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    page.write_text(f"{before}{BEGIN}\n\n{table(runs)}\n\n{END}{after}", encoding="utf-8")
    diagram(runs[1], arguments.root / "docs/pictures/performance-precision.svg")
    grade_diagram(runs[1], arguments.root / "docs/pictures/performance-grade.svg")
    missed = [name for name, _, _, bound in HEADLINES if any(name in run and not meets(run[name], bound) for run in runs)]
    print(f"performance: {page.name} written; bounds missed: {', '.join(missed) if missed else 'none'}")


if __name__ == "__main__":
    main()
