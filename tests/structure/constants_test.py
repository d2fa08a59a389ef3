#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps docs/reference/materials.md complete: each numeric constant of each scene, each named floating-point constant of sim/ and each default of a
description, with the value that it has, and no other. A message gives the row to add or to mend.

usage: constants_test.py ROOT | --self-test
"""
import ast
import fnmatch
import json
import operator
import pathlib
import re
import sys
import tempfile

import cpp_text

PAGE = "docs/reference/materials.md"
FOLDER = "docs/reference/materials"  # further pages of the same tables
SCENE_TABLE = "| scene constant | scenes | value | unit | basis | larger; smaller |"
CODE_TABLE = "| code constant | file | value | unit | basis | larger; smaller |"

# Of a scene: where things are and how they are drawn (docs/explanation/organs.md, docs/reference/scenes.md), and what identifies the file.
DRAWN = ("formatVersion", "version.*", "workspace.*", "camera.*", "hands.*.port", "hands.*.home", "vessels.*.path.*", "fat.*.triangle.corners.*",
         "organs.*.anchors.*.centre", "retraction.*.centre")
# Of the code: elementary functions, whose coefficients follow from their errors, and what only pictures show.
NOT_LISTED = ("sim/math/*", "sim/tissue/*_view.cpp", "sim/fat/fat_picture.cpp", "sim/bullet/*")
# Structures whose defaults are constants.
DEFAULTS = re.compile(r"\w*Description|JudgementRules|HapticModel|ConnectiveMaterial")
# Its defaults are where things are.
PLACES = {"SceneDescription"}

CONSTANT = re.compile(r"\bconstexpr\s+(?:static\s+)?(std::array<[^>]*>|[\w:]+)\s+(\w+)\s*(?:=\s*([^;]*)|\{([^;]*)\})\s*;")
FLOATING = re.compile(r"double|float|std::array<(?:double|float)\b.*")
STRUCT = re.compile(r"\bstruct\s+(\w+)[^;{()]*\{")
MEMBER = re.compile(r"^\s*(double|float|int|std::u?int\d+_t)\s+(\w+)\s*=\s*([^;]*);", re.MULTILINE)
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.USub: operator.neg}


def number(text):
    """A list of numbers of an expression of literals, or the text itself where it names something else."""
    plain = re.sub(r"(?<=[\d.])[FfUuLl]+\b|(?<=\d)'(?=\d)", "", text.strip().strip("{}[]`").strip())

    def value(node):
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return float(node.value)
        if isinstance(node, ast.BinOp):
            return OPERATORS[type(node.op)](value(node.left), value(node.right))
        if isinstance(node, ast.UnaryOp):
            return OPERATORS[type(node.op)](value(node.operand))
        raise ValueError
    try:
        tree = ast.parse(f"({plain},)", mode="eval").body
        return [value(e) for e in tree.elts]
    except (ValueError, SyntaxError, KeyError, TypeError, ZeroDivisionError):
        return " ".join(plain.split())


def same(a, b):
    if isinstance(a, str) or isinstance(b, str):
        return a == b
    return len(a) == len(b) and all(abs(x - y) <= 1e-12 * max(abs(x), abs(y)) for x, y in zip(a, b))


def matches(path, patterns):
    return any(fnmatch.fnmatchcase(path, p) for p in patterns)


def scene_constants(root):
    """{(scene, path): value} of every number and list of numbers that is not drawn; parts of a list are called by their names."""
    found = {}

    def walk(scene, path, value):
        if isinstance(value, bool):
            return
        if isinstance(value, (int, float)) or (isinstance(value, list) and value and all(isinstance(v, (int, float)) for v in value)):
            name = ".".join(path)
            if not matches(name, DRAWN):
                found[scene, name] = [float(v) for v in (value if isinstance(value, list) else [value])]
        elif isinstance(value, dict):
            for key, part in value.items():
                walk(scene, path + [key], part)
        elif isinstance(value, list):
            for i, part in enumerate(value):
                named = part if isinstance(part, dict) else {}
                part_name = named.get("name") or named.get("vessel") or named.get("organ") or named.get("to")
                walk(scene, path + [part_name if isinstance(part_name, str) else str(i)], part)
    for file in sorted((root / "assets/scenes").glob("*.json")):
        walk(file.stem, [], json.loads(file.read_text(encoding="utf-8")))
    return found


def body(text, start):
    """The text between the brace at start - 1 and its end, functions and inner braces blanked."""
    depth, out = 1, []
    for c in text[start:]:
        depth += (c == "{") - (c == "}")
        if depth == 0:
            break
        out.append(c if depth == 1 or c == "\n" else " ")
    return "".join(out)


def code_constants(root):
    """{(file, name): (values, must be listed)} of named constants and defaults."""
    found = {}
    for path in cpp_text.files(root):
        name = path.as_posix()
        if not name.startswith("sim/") or path.suffix not in (".h", ".cpp") or matches(name, NOT_LISTED):
            continue
        text = cpp_text.code_only((root / path).read_text(encoding="utf-8"))
        for kind, constant, assigned, braced in CONSTANT.findall(text):
            floating = FLOATING.fullmatch(kind) is not None
            values, listed = found.get((name, constant), ([], False))
            found[name, constant] = (values + [number(assigned or braced)], listed or floating)
        for match in STRUCT.finditer(text):
            if DEFAULTS.fullmatch(match.group(1)) is None or match.group(1) in PLACES:
                continue
            for _, member, value in MEMBER.findall(body(text, match.end())):
                found[name, f"{match.group(1)}::{member}"] = ([number(value)], True)
    return found


def rows_of(page):
    """(line number, table, cells) of each row of the two kinds of tables."""
    table = None
    for line_number, line in enumerate(page.splitlines(), 1):
        if not line.startswith("|"):
            table = None
        elif line in (SCENE_TABLE, CODE_TABLE):
            table = line
        elif table is not None and not line.startswith("| ---"):
            yield line_number, table, [c.strip() for c in re.split(r"(?<!\\)\|", line.strip()[1:-1])]


def shown(value):
    return value if isinstance(value, str) else ", ".join(f"{v:.12g}" for v in value)


def faults(root):
    """What is wrong, one message a constant."""
    scenes, code = scene_constants(root), code_constants(root)
    all_scenes = sorted({scene for scene, _ in scenes})
    listed_scene, listed_code, out = set(), set(), []
    pages = [root / PAGE] + sorted((root / FOLDER).glob("*.md"))
    for page, (line, table, cells) in ((p, row) for p in pages for row in rows_of(p.read_text(encoding="utf-8"))):
        at = f"{page.relative_to(root)}:{line}:"
        if len(cells) != 6 or not re.fullmatch(r"`[^`]+`", cells[0]):
            out.append(f"{at} not a row of {table}")
            continue
        if not all(cells):
            out.append(f"{at} an empty cell")
        name, value = cells[0].strip("`"), number(cells[2])
        if table == SCENE_TABLE:
            wanted = all_scenes if cells[1] == "all" else [s.strip(" `") for s in cells[1].split(",")]
            for scene in wanted:
                here = [k for k in scenes if k[0] == scene and fnmatch.fnmatchcase(k[1], name)]
                if not here and cells[1] != "all":
                    out.append(f"{at} `{name}`: no such constant in {scene}.json: take {scene} out of the row")
                for key in here:
                    if key in listed_scene:
                        out.append(f"{at} {key[1]} of {scene}.json is in an earlier row too: narrow one of them")
                    listed_scene.add(key)
                    if not same(value, scenes[key]):
                        out.append(f"{at} `{name}` is {shown(value)} here, {key[1]} is {shown(scenes[key])} in {scene}.json: mend the row")
            if cells[1] == "all" and not any(fnmatch.fnmatchcase(k[1], name) for k in scenes):
                out.append(f"{at} `{name}`: no scene has such a constant: remove the row")
        else:
            key = (cells[1].strip("`"), name)
            if key not in code:
                out.append(f"{at} `{name}`: no such constant in {key[0]}: remove the row")
                continue
            listed_code.add(key)
            if not any(same(value, v) for v in code[key][0]):
                out.append(f"{at} `{name}` is {shown(value)} here, {shown(code[key][0][0])} in {key[0]}: mend the row")
    for key in sorted(scenes.keys() - listed_scene):
        out.append(f"{PAGE}: missing {key[1]} of {key[0]}.json: add | `{key[1]}` | {key[0]} | {shown(scenes[key])} | unit | basis | larger; smaller |")
    for key in sorted(code.keys() - listed_code):
        if code[key][1]:
            out.append(f"{PAGE}: missing {key[1]} of {key[0]}: add | `{key[1]}` | `{key[0]}` | {shown(code[key][0][0])} | unit | basis | larger; smaller |")
    return out, len(scenes), sum(listed for _, listed in code.values())


def self_test():
    scene = {"organs": [{"name": "liver", "friction": 0.2, "sleeping": True}], "gravity": [0, 0, 0], "camera": {"up": [0, 1, 0]}}
    source = ("// constexpr double commented = 3.0;\nconstexpr double reach = 5.0 * 1e-3;\nconstexpr int passes = 6;\n"
              "struct ClipDescription {\n  double width = 0.0012;\n  void f() { double inner = 3.0; }\n};\n")
    rule = "| --- | --- | --- | --- | --- | --- |"
    good = [SCENE_TABLE, rule, "| `organs.*.friction` | all | 0.2 | 1 | assumed | a; b |", "| `gravity` | a | 0, 0, 0 | m/s^2 | assumed | a; b |", "",
            CODE_TABLE, rule, "| `reach` | `sim/a.cpp` | 0.005 | m | assumed | a; b |", "| `passes` | `sim/a.cpp` | 6 | 1 | assumed | a; b |",
            "| `ClipDescription::width` | `sim/a.cpp` | 1.2e-3 | m | assumed | a; b |"]
    cases = (
        (good, None), (good[:2] + good[3:], "missing organs.liver.friction of a.json"), (good[:7] + good[8:], "missing reach of sim/a.cpp"),
        (good[:9], "missing ClipDescription::width"), (good[:8] + good[9:], None),
        ([r.replace("| 0.2 |", "| 0.3 |") for r in good], "is 0.3 here, organs.liver.friction is 0.2 in a.json"),
        ([r.replace("0.005", "0.004") for r in good], "is 0.004 here, 0.005 in sim/a.cpp"),
        (good + ["| `gone` | `sim/a.cpp` | 1 | m | assumed | a; b |"], "no such constant in sim/a.cpp: remove"),
        (good[:4] + ["| `organs.spleen.friction` | a | 1 | 1 | assumed | a; b |"] + good[4:], "no such constant in a.json"),
        (good[:4] + [good[2]] + good[4:], "in an earlier row too"), ([r.replace("assumed", "") for r in good], "an empty cell"),
        ([r.replace(" | a; b |", " |") for r in good], "not a row"),
    )
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for folder in ("docs", "sim", "assets/scenes"):
            (root / folder).mkdir(parents=True)
        (root / "assets/scenes/a.json").write_text(json.dumps(scene))
        (root / "sim/a.cpp").write_text(source)
        for rows, expected in cases:
            (root / PAGE).parent.mkdir(parents=True, exist_ok=True)
            (root / PAGE).write_text("\n".join(rows) + "\n")
            found, scenes, code = faults(root)
            assert (scenes, code) == (2, 2), (scenes, code)
            assert bool(found) == (expected is not None) and all(expected in f for f in found[:1]), (expected, found)
    assert same(number("2.5e-7F"), [2.5e-7]) and same(number("{0.005, 0.01}"), [0.005, 0.01]) and number("2.5 * mm") == "2.5 * mm"
    print(f"constants: {len(cases)} cases judged as they must be")


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if sys.argv[1] == "--self-test":
        self_test()
        return 0
    found, scenes, code = faults(pathlib.Path(sys.argv[1]))
    for message in found:
        print(message)
    print(f"constants: {scenes} of scenes, {code} of code, {len(found)} faults")
    return 1 if found or scenes == 0 or code == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
