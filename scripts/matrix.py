#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The determinism matrix: builds the core alone for many machines, runs it from stored States, compares every digest.

Each cell is a compiler, an optimisation level and a machine; each runs tests/determinism/matrix_main.cpp, which links sim/
and nothing else, over the same States: 200 steps, a line of digests each. All lines of all cells must be equal.

  --short   gcc at -O3 for x86-64 and for the widest machine that runs here, clang at -O0, 2 threads, a host that flushes
            denormals to zero; with --tree, build trees that hold a calot-matrix stand in for all but the widest machine
  --full    {gcc, clang} x {-O0 .. -O3} x {x86-64, v3, v4, native} x {1, 2 threads}, the same host; aarch64, riscv64, armhf and i386
            under qemu; WebAssembly by node
  --machine M   those of --full that are for this machine, beside the reference

Exit: 0 all equal; 3 some differ; 1 something could not be built or run. Cells that this machine cannot run are printed as
skipped, with the reason, and do not count as equal.
"""
import argparse
import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# The flags of the contract (CMakeLists.txt, target calot_flags), spelled out: the matrix must notice when they change.
CONTRACT = ["-std=c++20", "-ffp-contract=off", "-fno-fast-math", "-DEIGEN_DONT_VECTORIZE", "-DEIGEN_MPL2_ONLY"]
LEVELS = {  # what each level of the x86-64 ABI adds, as /proc/cpuinfo names it
    "x86-64": set(),
    "x86-64-v3": {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"},
    "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "native": set(),
}
# Other processors: the cross compiler of Debian, what runs its programs here, and what clang calls it. i386 computes in SSE2: the x87
# registers of old have other digits.
OTHERS = {
    "aarch64": ("aarch64-linux-gnu-g++", "qemu-aarch64", "aarch64-linux-gnu", []),
    "riscv64": ("riscv64-linux-gnu-g++", "qemu-riscv64", "riscv64-linux-gnu", []),
    "armhf": ("arm-linux-gnueabihf-g++", "qemu-arm", "arm-linux-gnueabihf", ["-Wno-psabi"]),
    "i386": ("i686-linux-gnu-g++", "qemu-i386", "i686-linux-gnu", ["-msse2", "-mfpmath=sse"]),
    "wasm32": ("clang++-14", "node", "wasm32-wasi", ["-msimd128", "-fignore-exceptions"]),
}
# What is recorded to take States from: scene, performer, seed, seconds, and what the State is taken just before: the first
# touch, or the first event of a kind (schemas/recording.md). Together they have contact, fat, beams, springs, clips.
CLIP_IS_SET = 21
SOURCES = (("touch-liver", "skilled", 1, 8, "touch"), ("touch-liver", "unskilled", 2, 8, "touch"),
           ("cholecystectomy", "skilled", 1, 8, "touch"), ("clip-and-cut", "skilled", 2, 30, CLIP_IS_SET))
STEPS, STEPS_BEFORE = 200, 20
LARGE_SOLID = pathlib.Path("--large-solid")  # the program's own, for its solver is one that no scene's organs need


@dataclasses.dataclass(frozen=True)
class Build:
    """One executable of the matrix."""
    compiler: str  # gcc or clang
    level: str  # -O0 .. -O3
    machine: str  # a key of LEVELS or of OTHERS

    @property
    def name(self):
        return f"{self.compiler}{self.level}-{self.machine}"

    def program(self, work):
        return work / self.name / "calot-matrix"

    def command(self):
        if self.machine in OTHERS:
            cross, _, target, options = OTHERS[self.machine]
            return [cross if self.compiler == "gcc" else "clang++-14", *([f"--target={target}"] if self.compiler == "clang" else []), *options]
        return [{"gcc": "g++", "clang": "clang++"}[self.compiler], f"-march={self.machine}"]

    def flags(self):
        # Assertions on at -O0 and off above: they may not change a bit either.
        return [*CONTRACT, self.level, *([] if self.level == "-O0" else ["-DNDEBUG"])]


@dataclasses.dataclass(frozen=True)
class Tree:
    """The program of a build tree of the project: that tree's compiler and flags."""
    folder: pathlib.Path
    machine: str = "as built"

    @property
    def name(self):
        return f"tree {self.folder.name}"

    def program(self, _work):
        return self.folder / "bin" / "calot-matrix"


@dataclasses.dataclass(frozen=True)
class Cell:
    build: Build | Tree
    threads: int = 1
    flush_to_zero: bool = False

    @property
    def name(self):
        return f"{self.build.name}, {self.threads} thread{'s' if self.threads > 1 else ''}" + (
            ", host flushes to zero" if self.flush_to_zero else "")


def cpu_flags():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("flags"):
                return set(line.split(":", 1)[1].split())
    except OSError:
        pass
    return set()


def reason_to_skip(build):
    """Why this machine cannot build or run it, or None."""
    if isinstance(build, Tree):
        return None
    if not shutil.which(build.command()[0]):
        return f"no {build.command()[0]} here"
    if build.machine in OTHERS:
        cross, runner, target, _ = OTHERS[build.machine]
        library = pathlib.Path("/usr/lib/wasm32-wasi/libc.a").exists() if build.machine == "wasm32" else shutil.which(cross)
        if not library:
            return f"no library for {build.machine} here"
        return None if shutil.which(runner) else f"no {runner} here"
    if os.uname().machine != "x86_64":
        return f"this machine is {os.uname().machine}"
    needed = LEVELS[build.machine] | (LEVELS["x86-64-v3"] if build.machine == "x86-64-v4" else set())
    missing = sorted(needed - cpu_flags())
    return f"this processor has no {missing[0]}" if missing else None


def short_cells(trees=()):
    widest = "x86-64-v4" if reason_to_skip(Build("gcc", "-O3", "x86-64-v4")) is None else "x86-64-v3"
    wide = Build("gcc", "-O3", widest)
    base, *others = [Tree(t) for t in trees] or [Build("gcc", "-O3", "x86-64"), Build("clang", "-O0", "x86-64")]
    cells = [Cell(base), Cell(base, 2), Cell(base, 1, True), Cell(wide)]
    # Under the thread sanitizer two threads find races, whatever they print.
    return cells + [Cell(other, 2 if other.name == "tree tsan" else 1) for other in others]


def full_cells():
    cells = []
    for compiler in ("gcc", "clang"):
        for level in ("-O0", "-O1", "-O2", "-O3"):
            for machine in LEVELS:
                cells += [Cell(Build(compiler, level, machine), threads) for threads in (1, 2)]
            cells.append(Cell(Build(compiler, level, "x86-64"), 2, True))
        for level in ("-O0", "-O3"):
            cells += [Cell(Build(compiler, level, "aarch64"), threads) for threads in (1, 2)]
        cells += [Cell(Build(compiler, "-O3", machine)) for machine in ("riscv64", "armhf", "i386")]
    cells.append(Cell(Build("gcc", "-O3", "aarch64"), 1, True))
    cells += [Cell(Build("clang", level, "wasm32")) for level in ("-O1", "-O3")]
    return cells


def headers(work):
    """A folder with the two foreign header libraries of the core: a cross compiler must not see the host's /usr/include."""
    folder = work / "include"
    folder.mkdir(parents=True, exist_ok=True)
    for name, source in (("Eigen", "/usr/include/eigen3/Eigen"), ("xxhash.h", "/usr/include/xxhash.h")):
        link = folder / name
        if not link.is_symlink():
            link.symlink_to(source)
    return folder


def units(sources, work):
    """Sources of a folder of sim/ compiled together, as CMakeLists.txt does it: most of the time is reading headers."""
    folder = work / "units"
    folder.mkdir(exist_ok=True)
    texts = {}
    for source in sources:
        texts.setdefault(source.relative_to(ROOT).parts[1], []).append(f'#include "{source}"\n')
    for name, lines in texts.items():
        unit = folder / f"{name}.cpp"
        if not unit.exists() or unit.read_text() != "".join(lines):
            unit.write_text("".join(lines))
    return [folder / f"{name}.cpp" for name in texts]


def build_all(builds, work, jobs):
    """Writes one ninja file for all executables and runs it; returns the builds that failed."""
    # Bullet only offers pairs: no float of it reaches State, and no cell needs it.
    sources = [*units([s for s in sorted((ROOT / "sim").rglob("*.cpp")) if s.parent.name != "bullet"], work),
               ROOT / "tests/determinism/matrix_main.cpp"]
    include = headers(work)
    launcher = os.environ.get("CMAKE_CXX_COMPILER_LAUNCHER", "")
    lines = ["rule compile", "  command = $compiler $flags -MMD -MF $out.d -c $in -o $out", "  depfile = $out.d",
             "  deps = gcc", "  description = $out", "rule link", "  command = $compiler $in -o $out $options",
             "  description = $out"]
    for build in builds:
        compiler = " ".join(build.command())
        objects = []
        for source in sources:
            target = f"{build.name}/{source.stem}.o"
            objects.append(target)
            flags = " ".join([*build.flags(), f"-I{ROOT}", f"-isystem {include}", *([] if build.machine == "wasm32" else ["-pthread"])])
            lines += [f"build {target}: compile {source}", f"  compiler = {launcher} {compiler}", f"  flags = {flags}"]
        options = "-Wl,-z,stack-size=8388608" if build.machine == "wasm32" else "-static -pthread"
        lines += [f"build {build.name}/calot-matrix: link {' '.join(objects)}", f"  compiler = {compiler}", f"  options = {options}"]
    (work / "build.ninja").write_text("\n".join(lines) + "\n")
    run = subprocess.run(["ninja", "-C", str(work), "--quiet", f"-j{jobs}", "-k0"], check=False)
    if run.returncode == 0:
        return set()
    # Which ones? Only those that are not up to date now.
    failed = set()
    for build in builds:
        state = subprocess.run(["ninja", "-C", str(work), "-n", f"{build.name}/calot-matrix"], capture_output=True, text=True,
                               check=False)
        if "no work to do" not in state.stdout:
            failed.add(build)
    return failed


def step_before(recording, moment):
    """The step a little before the first force, or the first event, so that what follows it lies in the cells' steps."""
    import h5py  # the distribution's; needed here only

    with h5py.File(recording, "r") as file:
        per_step = int(file.attrs["ticks_per_step"])
        if moment == "touch":
            found = [int(force.any(axis=1).argmax()) // per_step
                     for hand in ("left", "right") if (force := file[f"ticks/{hand}/force"][:]).any()]
        else:
            found = [int(step) for step in file["events"]["step"][file["events"]["kind"] == moment]]
        steps = len(file["ticks/left/force"]) // per_step
    step = max(1, min(found, default=0) - STEPS_BEFORE)
    if not found or step + STEPS >= steps:
        raise SystemExit(f"matrix: {recording}: {moment} does not come early enough: no State worth comparing")
    return step


def make_states(calot, work):
    """Records attempts with the release build and takes a State from each."""
    folder = work / "states"
    folder.mkdir(parents=True, exist_ok=True)

    def call(*command):
        run = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise SystemExit(f"matrix: {' '.join(map(str, command))}: exit {run.returncode}: {run.stderr.strip()}")

    states = []
    for scene, performer, seed, seconds, moment in SOURCES:
        recording = folder / f"{scene}-{performer}.h5"
        call(calot, "record", "--scene", scene, "--performer", performer, "--seed", seed, "--seconds", seconds,
             "-o", recording, "--force")
        step = step_before(recording, moment)
        states.append(folder / f"{scene}-{performer}-{step}.flat")
        call(calot, "state", recording, "--step", step, "--flat", "-o", states[-1], "--force")
    return [*states, LARGE_SOLID]


def run_cell(cell, states, work):
    """The lines that the cell prints over all States; raises RuntimeError where it fails."""
    lines = []
    program = [str(cell.build.program(work))]
    if cell.build.machine == "wasm32":
        program[:0] = ["node", "--no-warnings", str(ROOT / "tests/determinism/run_module.mjs")]
    elif cell.build.machine in OTHERS:
        program.insert(0, OTHERS[cell.build.machine][1])
    for state in states:
        command = [*program, str(state), "--threads", str(cell.threads), *(["--flush-to-zero"] if cell.flush_to_zero else [])]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise RuntimeError(f"exit {run.returncode}: {run.stderr.strip().splitlines()[-1:] or ''}")
        lines += [f"{state.name}: {line}" for line in run.stdout.splitlines()]
    if len(lines) < 2 * len(states):
        raise RuntimeError(f"printed {len(lines)} lines only")
    return lines


def judge(lines, reference):
    """'equal', or where the first difference is."""
    if lines == reference:
        return "equal"
    for ours, theirs in zip(lines, reference):
        if ours != theirs:
            return f"DIFFERENT: {ours[:100]} | reference: {theirs[:100]}"
    return f"DIFFERENT: {len(lines)} lines, reference has {len(reference)}"


def self_test():
    assert judge(["a", "b"], ["a", "b"]) == "equal"
    assert judge(["a", "c"], ["a", "b"]).startswith("DIFFERENT: c")
    assert judge(["a"], ["a", "b"]).startswith("DIFFERENT: 1 lines")
    assert len({c.name for c in full_cells()}) == len(full_cells())
    assert {c.build.compiler for c in short_cells()} == {"gcc", "clang"}
    short = short_cells([pathlib.Path("a"), pathlib.Path("b")])
    assert [c.build.name for c in short if isinstance(c.build, Tree)] == ["tree a"] * 3 + ["tree b"] and len(short) == 5
    assert short_cells([pathlib.Path("a"), pathlib.Path("tsan")])[-1].threads == 2
    cmake = (ROOT / "CMakeLists.txt").read_text()
    for flag in CONTRACT[1:]:
        assert flag.removeprefix("-D") in cmake, f"{flag} is not in CMakeLists.txt"
    print("matrix: judges as it must, and has the flags of CMakeLists.txt")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--short", action="store_true", help="the default")
    size.add_argument("--full", action="store_true")
    size.add_argument("--machine", action="append", choices=[*LEVELS, *OTHERS], help="the cells of --full for this machine alone")
    size.add_argument("--self-test", action="store_true")
    parser.add_argument("--calot", type=pathlib.Path, help="release build of calot, which makes the States")
    parser.add_argument("--state", type=pathlib.Path, action="append", help="a stored State (calot state --flat) to use instead")
    parser.add_argument("--tree", type=pathlib.Path, action="append", default=[], help="a build tree with bin/calot-matrix (--short)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/matrix")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--json", type=pathlib.Path, help="write the table to this file too")
    arguments = parser.parse_args()
    if arguments.self_test:
        self_test()
        return 0
    if not arguments.state and not arguments.calot:
        parser.error("give --calot or --state")

    if arguments.tree and arguments.full:
        parser.error("--tree goes with --short: --full builds every cell itself")
    trees = [t.resolve() for t in arguments.tree]
    for tree in trees:
        if not Tree(tree).program(None).is_file():
            parser.error(f"--tree {tree}: no bin/calot-matrix there: build the target calot-matrix")
    cells = full_cells() if arguments.full else short_cells(trees)
    if arguments.machine:
        cells = short_cells(trees)[:1] + [c for c in full_cells() if c.build.machine in arguments.machine]
    work = arguments.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    states = [s.resolve() for s in arguments.state] if arguments.state else make_states(arguments.calot.resolve(), work)
    builds = list(dict.fromkeys(c.build for c in cells))
    skipped = {b: reason for b in builds if (reason := reason_to_skip(b))}
    wanted = [b for b in builds if b not in skipped and isinstance(b, Build)]
    print(f"matrix: {len(wanted)} builds of the core, {len(skipped)} skipped, States {', '.join(s.name for s in states)}", flush=True)
    start = time.monotonic()
    failed = build_all(wanted, work, arguments.jobs)
    print(f"matrix: built in {time.monotonic() - start:.0f} s", flush=True)

    reference, table = None, []
    for cell in cells:
        begin = time.monotonic()
        if cell.build in skipped:
            verdict = f"skipped ({skipped[cell.build]})"
        elif cell.build in failed:
            verdict = "BROKEN: does not build"
        else:
            try:
                lines = run_cell(cell, states, work)
                if reference is None:
                    reference = lines
                verdict = judge(lines, reference)
            except RuntimeError as error:
                verdict = f"BROKEN: {error}"
        table.append({"cell": cell.name, "verdict": verdict, "seconds": round(time.monotonic() - begin, 1)})
        print(f"{cell.name:48} {table[-1]['seconds']:7.1f} s  {verdict}", flush=True)

    count = {word: sum(row["verdict"].startswith(word) for row in table) for word in ("equal", "DIFFERENT", "BROKEN", "skipped")}
    print(f"matrix: {len(reference or [])} lines in each cell; " + ", ".join(f"{n} {word}" for word, n in count.items()))
    if arguments.json:
        arguments.json.write_text(json.dumps({"cells": table, "lines": len(reference or [])}, indent=1))
    if count["DIFFERENT"]:
        return 3
    return 1 if count["BROKEN"] or not count["equal"] else 0


if __name__ == "__main__":
    sys.exit(main())
