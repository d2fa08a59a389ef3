#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the engine of a simulation version, as a program or as a WebAssembly module, from the source of that version.

  engine.py build N [--module] -o FILE   from the history of this clone, as assets/engines/engines.json names it
  engine.py build here [--module] -o F   from this tree as it is
  engine.py keep N [--calot PROGRAM]     makes the module of this tree's version the kept one, and notes it; its transcript
                                         and the golden recordings go beside it
  engine.py measure [--calot PROGRAM]    makes what the next version would add in a scratch clone; fails above 2 MB

An old version's source may lack the engine's protocol: then assets/engines/N/source.patch is applied to it. A kept module
is built anew with the same bytes wherever clang is the same. Needs clang 14 with wasi-libc and libc++ for wasm32 (a
module), or g++ with fmt and libseccomp (a program).
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
ENGINES = ROOT / "assets/engines"
MANIFEST = ENGINES / "engines.json"
# The flags of the contract (CMakeLists.txt, target calot_flags).
CONTRACT = ["-std=c++20", "-O3", "-DNDEBUG", "-ffp-contract=off", "-fno-fast-math", "-fno-math-errno", "-fno-trapping-math",
            "-DEIGEN_DONT_VECTORIZE", "-DEIGEN_MPL2_ONLY", "-DFMT_HEADER_ONLY"]
MODULE = ["--target=wasm32-wasi", "-msimd128", "-fignore-exceptions", "-DJSON_HAS_FILESYSTEM=0", "-DJSON_HAS_EXPERIMENTAL_FILESYSTEM=0"]
STACK = 8 << 20
# What a simulation version may add to a clone (bytes): engine, transcript, goldens.
MOST_ADDED = 2_000_000
FOREIGN = {"Eigen": "eigen3/Eigen", "xxhash.h": "xxhash.h", "fmt": "fmt", "nlohmann": "nlohmann"}


def fail(text):
    raise SystemExit(f"{pathlib.Path(sys.argv[0]).stem}: {text}")


def run(command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        fail(f"{' '.join(map(str, command[:4]))}: {(done.stderr or done.stdout).strip()[-2000:]}")
    return done.stdout


def manifest():
    return json.loads(MANIFEST.read_text()) if MANIFEST.exists() else {"engines": []}


def version_of(source):
    return int(re.search(r"simulationVersion = (\d+);", (source / "sim/scene/version.h").read_text()).group(1))


def check_out(version, folder):
    """The source of a kept version."""
    entry = next((e for e in manifest()["engines"] if e["version"] == version), None)
    if entry is None:
        fail(f"{MANIFEST.name} knows no engine {version}: there are {', '.join(str(e['version']) for e in manifest()['engines']) or 'none'}")
    if subprocess.run(["git", "-C", ROOT, "cat-file", "-e", entry["commit"] + "^{commit}"], capture_output=True, check=False).returncode != 0:
        fail(f"{ROOT} is no clone that holds commit {entry['commit'][:12]}: fetch its whole history (git fetch --unshallow)")
    archive = subprocess.run(["git", "-C", ROOT, "archive", entry["commit"]], capture_output=True, check=True).stdout
    subprocess.run(["tar", "-x", "-C", folder], input=archive, check=True)
    patch = ENGINES / str(version) / "source.patch"
    if patch.exists():
        # As plain files, whatever clone the folder may lie in.
        run(["git", "apply", patch], cwd=folder, env={**os.environ, "GIT_CEILING_DIRECTORIES": str(folder.resolve().parent)})
    if version_of(folder) != version:
        fail(f"commit {entry['commit'][:12]} is of simulation version {version_of(folder)}")


def matching(folder, patterns):
    """Files of these patterns below `folder`; those of a pattern after "- " are left out."""
    found = []
    for pattern in patterns:
        matched = sorted(folder.glob(pattern.removeprefix("- ")))
        if not matched:
            fail(f"{pattern} is no file")
        found = [f for f in found if f not in matched] if pattern.startswith("- ") else found + matched
    return sorted(set(found))


def source_patterns(folder, kind):
    """What an engine of this kind consists of, by apps/calot-engine/sources.txt."""
    patterns = []
    for line in (folder / "apps/calot-engine/sources.txt").read_text().splitlines():
        words = line.split()
        if not words or words[0].startswith("#") or words[0] in {"native", "module"} - {kind}:
            continue
        patterns.append(" ".join(words[words[0] == kind:]))
    return patterns


def link_headers(include, names):
    """Other people's headers alone, apart from this machine's own C library."""
    include.mkdir(parents=True, exist_ok=True)
    for name, place in names.items():
        if not (include / name).is_symlink():
            (include / name).symlink_to(f"/usr/include/{place}")


# Comparisons with 0 in LLVM's form whose either zero clang 14 loses in WebAssembly, where its maximum and minimum order -0 below 0 and
# keep what is no number: x < 0 ? 0 : x, and !(x >= 0) ? x : 0. Source that uses sim/math/linear.h has none.
ZERO = r"(?:0\.0+e\+00|zeroinitializer)"
BELOW_ZERO = re.compile(rf"(%\S+) = fcmp ([uo])lt (?:<\d+ x )?(?:double|float)>? (%\S+), {ZERO}")
SELECT = re.compile(r"= select (?:<\d+ x )?i1>? (%\S+), (?:<\d+ x )?(?:double|float)>? (\S+), (?:<\d+ x )?(?:double|float)>? (\S+)$")


def zeros_lost(listing):
    """Selects in LLVM's text that may lose which zero their result is."""
    found, compared = [], {}
    for line in listing.splitlines():
        text = line.split(", !")[0].strip()
        if text.startswith("define "):
            compared = {}
        comparison = BELOW_ZERO.match(text)
        if comparison:
            compared[comparison[1]] = (comparison[2], comparison[3])
        choice = SELECT.search(text)
        if choice and choice[1] in compared:
            ordered, number = compared[choice[1]]
            zero, other = (choice[2], choice[3]) if ordered == "o" else (choice[3], choice[2])
            if re.fullmatch(ZERO, zero) and other == number:
                found.append(text)
    return found


def check_zeros(work, objects):
    lost = [f"{name}: {what}" for name in objects if name.startswith("sim/")
            for what in zeros_lost(run(["llvm-dis-14", "-o", "-", work / f"{name}.bc"]))]
    if lost:
        fail("clang would lose which zero a number is (sim/math/linear.h):\n" + "\n".join(lost[:20]))


def self_test():
    lost = ("%2 = fcmp olt double %1, 0.000000e+00\n%3 = select i1 %2, double 0.000000e+00, double %1",
            "%2 = fcmp ult double %1, 0.000000e+00\n%3 = select i1 %2, double %1, double 0.000000e+00",
            "%2 = fcmp olt <2 x double> %1, zeroinitializer\n%3 = select <2 x i1> %2, <2 x double> zeroinitializer, <2 x double> %1")
    kept = ("%2 = fcmp oge double %1, 0.000000e+00\n%3 = select i1 %2, double %1, double 0.000000e+00",
            "%2 = fcmp ogt double %1, 0.000000e+00\n%3 = select i1 %2, double %1, double 0.000000e+00",
            "%2 = fcmp olt double %1, 0.000000e+00\n%3 = select i1 %2, double %4, double %1",
            "%2 = fcmp olt double %1, 1.000000e+00\n%3 = select i1 %2, double %1, double 1.000000e+00")
    assert all(len(zeros_lost(text)) == 1 for text in lost), lost
    assert not any(zeros_lost(text) for text in kept)
    print("engine: finds the comparisons that lose a zero")


def program_version(folder):
    return re.search(r"project\(calot VERSION (\S+)", (folder / "CMakeLists.txt").read_text()).group(1)


def build(folder, kind, output, work, jobs):
    """Compiles and links an engine of the source in `folder`."""
    module = kind == "module"
    include = work / "include"
    link_headers(include, FOREIGN)
    compiler = "clang++-14" if module else "g++"
    flags = [*CONTRACT, *(MODULE if module else []), f'-DCALOT_VERSION=\\"{program_version(folder)}\\"', f"-I{folder}",
             f"-ffile-prefix-map={folder}=."]
    compat = folder / "apps/calot-engine/wasm/compat"
    if module and compat.is_dir():
        flags.append(f"-I{compat}")
    flags.append(f"-isystem {include}")
    link = [f"--target=wasm32-wasi -mexec-model=reactor -O2 -Wl,-s -Wl,-z,stack-size={STACK} -Wl,--max-memory={4 << 30}"
            if module else "-O2 -s", "$in"] + ([] if module else ["-lseccomp"])
    # A module goes by LLVM's own form, which is looked at afterwards.
    compiling = (f"{compiler} {' '.join(flags)} -MMD -MF $out.d -MT $out -emit-llvm -c $in -o $out.bc && {compiler} {MODULE[0]} {MODULE[1]} -O3 -Xclang -disable-llvm-passes -c "
                 "$out.bc -o $out" if module else f"{compiler} {' '.join(flags)} -MMD -MF $out.d -c $in -o $out")
    lines = ["rule compile", f"  command = {compiling}", "  depfile = $out.d", "  deps = gcc", "rule link", f"  command = {compiler} {' '.join(link)} -o $out"]
    objects = []
    for source in matching(folder, source_patterns(folder, kind)):
        objects.append(str(source.relative_to(folder).with_suffix(".o")))
        lines.append(f"build {objects[-1]}: compile {source}")
    lines.append(f"build engine: link {' '.join(objects)}")
    (work / "build.ninja").write_text("\n".join(lines) + "\n")
    done = subprocess.run(["ninja", "-C", str(work), f"-j{jobs}", "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        fail(f"does not build:\n{done.stdout[-4000:]}")
    if module:
        check_zeros(work, objects)
    temporary = output.with_name(output.name + ".part")
    shutil.copy(work / "engine", temporary)
    os.replace(temporary, output)


def keep(version, calot, jobs, built):
    """Notes the module of the last commit as that of its version. Golden recordings are copied: git stores them once."""
    if run(["git", "-C", ROOT, "status", "--porcelain", "sim", "recorder", "apps/calot-engine"]).strip():
        fail("the source has changes that are in no commit: an engine is kept of a commit")
    if version_of(ROOT) != version:
        fail(f"this tree is of simulation version {version_of(ROOT)}")
    known = manifest()
    if any(e["version"] == version for e in known["engines"]):
        fail(f"engine {version} is kept already, and never changes")
    file = ENGINES / f"engine-{version}.wasm"
    if built:
        shutil.copy(built, file)
    else:
        with tempfile.TemporaryDirectory() as folder:
            build(ROOT, "module", file, pathlib.Path(folder), jobs)
    beside = ENGINES / str(version)
    beside.mkdir(exist_ok=True)
    for recording in sorted((ROOT / "assets/golden").glob("*.h5")):
        shutil.copy(recording, beside)
        run([calot, "engine", "transcript", recording, "--engine", file, "-o", beside / f"{recording.stem}.transcript"])
    known["engines"].append(entry_of(version, run(["git", "-C", ROOT, "rev-parse", "HEAD"]).strip(), file))
    MANIFEST.write_text(json.dumps(known, indent=2) + "\n")


def entry_of(version, commit, file):
    return {"version": version, "commit": commit, "module": file.name, "sha256": hashlib.sha256(file.read_bytes()).hexdigest(),
            "compiler": run(["clang++-14", "--version"]).splitlines()[0],
            "libraries": run(["dpkg-query", "-W", "-f", "${Package} ${Version}\\n", "wasi-libc", "libc++-14-dev-wasm32", "libeigen3-dev",
                              "libxxhash-dev", "libfmt-dev", "nlohmann-json3-dev"]).split("\n")[:-1]}


def measure(calot, jobs, built):
    """Bytes that the next version adds to a clone. Other seeds stand for its other digests: they are as many."""
    with tempfile.TemporaryDirectory() as folder:
        clone = pathlib.Path(folder) / "clone"
        run(["git", "clone", "--quiet", "--no-local", ROOT, clone])

        def commit(what):
            run(["git", "-C", clone, "add", "-A"])
            run(["git", "-C", clone, "-c", "user.name=measure", "-c", "user.email=measure@example.org", "commit", "--quiet", "-m", what])

        def stored():
            run(["git", "-C", clone, "gc", "--quiet"])
            return sum(f.stat().st_size for f in (clone / ".git").rglob("*") if f.is_file())

        before = stored()
        listed = clone / "assets/golden/golden.json"
        goldens = json.loads(listed.read_text())
        for golden in goldens["recordings"]:
            (listed.parent / golden["file"]).unlink()
            golden["seed"] += 1000
        listed.write_text(json.dumps(goldens, indent=1) + "\n")
        header = clone / "sim/scene/version.h"
        version = version_of(clone)
        header.write_text(header.read_text().replace(f"simulationVersion = {version};", f"simulationVersion = {version + 1};"))
        commit("The next version")
        run([calot, "golden", "update", "--folder", listed.parent, "--reason", "measured"], env={**os.environ, "CALOT_ASSETS": str(clone / "assets")})
        commit("Its goldens")
        run([sys.executable, clone / "scripts/engine.py", "--jobs", jobs, "keep", version + 1, "--calot", calot,
             *(["--built", built] if built else [])])
        changed = run(["git", "-C", clone, "status", "--porcelain", "--untracked-files=all"]).splitlines()
        commit("Its engine")
        after = stored()
        for name in sorted({line[3:] for line in changed} | set(run(["git", "-C", clone, "ls-files", "assets/golden"]).split())):
            print(f"{(clone / name).stat().st_size:>10} {name}")
        print(f"engine: .git has {before} bytes, and {after} after the next version: {after - before} more; at most {MOST_ADDED}")
        if after - before > MOST_ADDED:
            fail("a simulation version adds too much: docs/how-to/golden.md, \"Size\"")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("build")
    one.add_argument("version", help="a simulation version, or here")
    one.add_argument("--module", action="store_true", help="WebAssembly")
    one.add_argument("-o", "--output", type=pathlib.Path, required=True)
    one.add_argument("--work", type=pathlib.Path, help="keeps what was compiled")
    two = commands.add_parser("keep")
    two.add_argument("version", type=int)
    three = commands.add_parser("measure")
    for command in (two, three):
        command.add_argument("--calot", type=pathlib.Path, default=ROOT / "build/release/bin/calot", help="of this tree's version")
        command.add_argument("--built", type=pathlib.Path, help="the module, where it is built already (of the next version, to measure)")
    commands.add_parser("self-test")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    arguments = parser.parse_args()
    if arguments.command == "self-test":
        self_test()
        return 0
    if arguments.command == "keep":
        keep(arguments.version, arguments.calot.resolve(), arguments.jobs, arguments.built)
        return 0
    if arguments.command == "measure":
        measure(arguments.calot.resolve(), arguments.jobs, arguments.built and arguments.built.resolve())
        return 0
    kind = "module" if arguments.module else "native"
    output = arguments.output.resolve()
    if not output.parent.is_dir():
        fail(f"{output.parent} is no folder")
    with tempfile.TemporaryDirectory() as temporary:
        work = (arguments.work or pathlib.Path(temporary) / "work").resolve()
        folder = ROOT
        if arguments.version != "here":
            if not arguments.version.isdigit():
                fail(f"'{arguments.version}' is no simulation version")
            folder = pathlib.Path(temporary) / "source"
            folder.mkdir()
            check_out(int(arguments.version), folder)
        build(folder, kind, output, work, arguments.jobs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
