#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the attempt in a browser (docs/how-to/page.md): one HTML file with everything in it.

  page.py [--engine FILE] [-o FILE]

Needs clang 14 with wasi-libc and libc++ for wasm32, the headers that the renderer needs, and npm. Without --engine it is
the kept engine of this tree's simulation version. The same sources and packages give the same bytes.
"""
import argparse
import base64
import hashlib
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import zlib

import engine
from engine import fail, link_headers, matching, run, source_patterns

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "gui/page"
LIMIT = 6_000_000  # bytes
FLAGS = [*engine.MODULE, *engine.CONTRACT, f"-ffile-prefix-map={ROOT}=."]
LINK = ["--target=wasm32-wasi", "-mexec-model=reactor", "-O2", "-Wl,-s", f"-Wl,-z,stack-size={engine.STACK}"]
FOREIGN = {**engine.FOREIGN, "GL": "GL", "KHR": "KHR"}
# What each module consists of: patterns of files, "-" leaves some out.
MODULES = {
    "proof": ["gui/page/wasm/thrown.cpp", "gui/page/wasm/proof_module.cpp", "recorder/recording/keyframe_code.cpp", "sim/math/fields.cpp"],
    "judge": ["gui/page/wasm/thrown.cpp", "gui/page/wasm/judge_module.cpp", "gui/words/event_words.cpp",
              "analytics/checkpoints/error_words.cpp", "analytics/checkpoints/phases.cpp", "sim/judgement/*.cpp", "recorder/engine/wire.cpp",
              "sim/instruments/*.cpp", "sim/math/*.cpp", "sim/geometry/*.cpp", "sim/scene/description.cpp", "sim/scene/step_result.cpp", "sim/tissue/structure.cpp", "sim/tissue/*/*_tissue.cpp",
              "sim/tissue/connective/connective_kind.cpp",
              *[p for p in source_patterns(ROOT, "module") if "recorder/formats/" in p or "recorder/base/" in p]],
    "picture": ["gui/page/wasm/thrown.cpp", "gui/page/wasm/picture_module.cpp", "gui/render/*.cpp",
                "- gui/render/graphics.cpp", "- gui/render/image.cpp",
                "- gui/render/renderer.cpp", "recorder/engine/fallen_clips.cpp", "recorder/engine/wire.cpp", "sim/geometry/ground.cpp", "sim/instruments/*.cpp",
                "sim/math/*.cpp"],
}
POLICY = ("default-src 'none'; script-src 'sha256-{script}' 'wasm-unsafe-eval'; style-src 'sha256-{style}'; worker-src blob:; img-src data:; "
          "connect-src 'none'; base-uri 'none'; form-action 'none'")


def write_shaders(file):
    """The renderer's shaders as constants, as CMake makes them."""
    constants = "".join(f'const char* const {shader.stem} = R"~~glsl({shader.read_text()})~~glsl";\n'
                        for shader in sorted((ROOT / "gui/render/shaders").glob("*.glsl")))
    text = (ROOT / "gui/render/shader_sources.cpp.in").read_text().replace("@calot_shaders@", constants)
    if not file.exists() or file.read_text() != text:
        file.write_text(text)


def build_modules(work, jobs):
    """Compiles what changed, and links the modules."""
    include = work / "include"
    link_headers(include, FOREIGN)
    flags = " ".join([*FLAGS, f"-I{ROOT}", f"-isystem {include}"])
    lines = ["rule compile", f"  command = clang++-14 {flags} -MMD -MF $out.d -c $in -o $out", "  depfile = $out.d", "  deps = gcc", "rule link",
             f"  command = clang++-14 {' '.join(LINK)} $in -o $out"]
    shaders = work / "shader_sources.cpp"
    write_shaders(shaders)
    lines.append(f"build shader_sources.o: compile {shaders}")
    made = set()
    for name, patterns in MODULES.items():
        objects = ["shader_sources.o"] if name == "picture" else []
        for source in matching(ROOT, patterns):
            objects.append(str(source.relative_to(ROOT).with_suffix(".o")))
            if objects[-1] not in made:
                lines.append(f"build {objects[-1]}: compile {source}")
                made.add(objects[-1])
        lines.append(f"build {name}.wasm: link {' '.join(objects)}")
    (work / "build.ninja").write_text("\n".join(lines) + "\n")
    done = subprocess.run(["ninja", "-C", str(work), f"-j{jobs}", "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        fail(f"does not build:\n{done.stdout[-4000:]}")


def kept_engine():
    version = engine.version_of(ROOT)
    file = ROOT / f"assets/engines/engine-{version}.wasm"
    if not file.exists():
        fail(f"there is no kept engine of simulation version {version}: name one with --engine (scripts/engine.py builds it)")
    return file


def bundle(work):
    """Scripts of the page and its threads, each in one piece."""
    tree = work / "tree"
    tree.mkdir(parents=True, exist_ok=True)
    wanted = (PAGE / "package.json").read_text()
    if not (tree / "package.json").exists() or (tree / "package.json").read_text() != wanted or not (tree / "node_modules").is_dir():
        (tree / "package.json").write_text(wanted)
        run(["npm", "install", "--no-audit", "--no-fund", "--no-package-lock", "--ignore-scripts"], cwd=tree)
    shutil.rmtree(tree / "src", ignore_errors=True)
    shutil.copytree(PAGE / "src", tree / "src")
    scripts = {}
    for name, entry in {"main": "main.js", "reader": "reader_worker.js", "worker": "worker.js"}.items():
        out = tree / f"{name}.bundle.js"
        run([tree / "node_modules/.bin/esbuild", f"src/{entry}", "--bundle", "--format=iife", "--minify", "--charset=utf8", "--target=es2022",
             "--legal-comments=none", "--define:import.meta.url=\"\"", "--log-level=error", f"--outfile={out}"], cwd=tree)
        scripts[name] = out.read_bytes()
    return scripts


def digest(content):
    return base64.b64encode(hashlib.sha256(content).digest()).decode()


def packed(content):
    return base64.b64encode(zlib.compress(content, 9)).decode()


def assemble(module, scripts, work):
    parts = {"engine": module.read_bytes(), "proof": (work / "proof.wasm").read_bytes(), "picture": (work / "picture.wasm").read_bytes(), "judge": (work / "judge.wasm").read_bytes(),
             "reader": scripts["reader"], "worker": scripts["worker"]}
    texts = {name: packed(content) for name, content in parts.items()}
    script = scripts["main"].decode().strip()
    if "</script" in script.lower():
        fail("the page's script would end its own element")
    style = (PAGE / "page.css").read_text()
    page = (PAGE / "page.html").read_text()
    values = {
        "POLICY": POLICY.format(script=digest(script.encode()), style=digest(style.encode())),
        "STYLE": style,
        "PARTS": "\n".join(f'<script type="application/x-calot-part" id="part-{name}">{text}</script>' for name, text in texts.items()),
        "SCRIPT": script,
        "NOTICE": html.escape((work / "tree/node_modules/h5wasm/LICENSE.txt").read_text().strip()),
    }
    page = re.sub(r"@(POLICY|STYLE|PARTS|SCRIPT|NOTICE)@", lambda m: values[m.group(1)], page)
    return page, {name: len(text) for name, text in texts.items()} | {"page": len(script) + len(style)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engine", type=pathlib.Path, help="WebAssembly module of an engine")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "build/page/calot-page.html")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/page", help="keeps packages and what was compiled")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    arguments = parser.parse_args()
    work = arguments.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    build_modules(work, arguments.jobs)
    page, sizes = assemble(arguments.engine or kept_engine(), bundle(work), work)
    arguments.output.write_text(page)
    size = len(page.encode())
    print(json.dumps({"file": str(arguments.output), "bytes": size, "parts": sizes}, indent=2))
    if size > LIMIT:
        fail(f"{size} bytes are more than {LIMIT}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
