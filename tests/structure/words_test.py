#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuses retired words (docs/glossary.md): old names of functions and types anywhere, most/least/largest/smallest in names of the mechanics, and
words with several meanings in its comments and in the documents. Only words that can be detected reliably are listed.

usage: words_test.py ROOT | --self-test
"""
import pathlib
import re
import sys
import tempfile

import cpp_text

# Modules whose names and comments have been revised throughout.
MECHANICS = tuple(f"sim/{m}/" for m in ("math", "geometry", "solid", "vessel", "connective", "carving", "contact", "fat", "haptics"))

# Old name -> term of the glossary. Refused in code, comments and documents.
NAMES = {
    "poseProblem": "buildContactProblem", "recallForces": "loadWarmStart", "keepForces": "storeWarmStart",
    "followChange": "updateComplianceEstimate", "makeAdmissible": "projectOntoFrictionCone", "carryOut": "applyContactImpulses",
    "moveFreely": "solveUnconstrained", "advanceFreely": "solveUnconstrained", "dropLostPlaces": "removeStaleGrasps",
    "tellTear": "emitTear", "tellSmoke": "emitSmoke", "forceRest": "forceResidual", "turnColumns": "rotateColumns",
    "turnTowardsPolar": "rotateTowardsPolar", "SolidPlace": "MaterialPoint", "BeamPlace": "BeamPoint", "SearchRoom": "SearchScratch",
    "RestingTissue": "UndeformedTissue", "deepestOverlap": "maxOverlap", "isWorthIt": "isWorthwhile",
}
NAME = re.compile(r"\b(" + "|".join(NAMES) + r")\b")
WITHDRAW = re.compile(r"\bwithdraw\(")  # in sim: resolvePenetration(); elsewhere a participant withdraws

# Extremes are named maxX and minX. Stored fields keep their names.
EXTREME = re.compile(r"\b(?:most|least|largest|smallest)[A-Z]\w*")
STORED = {"largestDisplacement"}

# Words of comments in the mechanics, and of documents.
COMMENT_WORDS = {"told": "reported, counted, inferred", "tells": "reports, gives", "lean": "minimal", "room": "scratch, capacity, clearance",
                 "rooms": "modules", "anew": "again, rebuilt", "turned": "rotated, transposed, reversed"}
DOCUMENT_WORDS = {"room": "module, scratch, capacity, space", "rooms": "modules", "lean": "minimal", "told apart": "distinguished"}
COMMENT_WORD = re.compile(r"(?<![\w`/-])(" + "|".join(COMMENT_WORDS) + r")(?![\w`(-])")
DOCUMENT_WORD = re.compile(r"(?<![\w`/-])(" + "|".join(DOCUMENT_WORDS) + r")(?![\w`(-])")
COMMENT = re.compile(r"//.*")


def is_document(path):
    return path.suffix == ".md" and (path.parts[0] == "docs" or len(path.parts) == 1)


def faults_of(root, path):
    """(line number, message) of each fault of one file."""
    found = []
    name = path.as_posix()
    cpp = path.suffix in (".h", ".cpp")
    document = is_document(path) and path.name not in ("glossary.md", "CHANGELOG.md")
    if not cpp and not document:
        return found
    text = (root / path).read_text(encoding="utf-8")
    for number, line in enumerate(text.split("\n"), 1):
        for m in NAME.finditer(line):
            found.append((number, f"{m.group(1)}: say {NAMES[m.group(1)]}"))
        if cpp and name.startswith("sim/") and WITHDRAW.search(line):
            found.append((number, "withdraw(: say resolvePenetration("))
        if cpp and name.startswith(MECHANICS):
            comment = COMMENT.search(line)
            for m in COMMENT_WORD.finditer(comment.group() if comment else ""):
                found.append((number, f'"{m.group(1)}" in a comment: say {COMMENT_WORDS[m.group(1)]}'))
        if document:
            for m in DOCUMENT_WORD.finditer(line):
                found.append((number, f'"{m.group(1)}": say {DOCUMENT_WORDS[m.group(1)]}'))
    if cpp and name.startswith(MECHANICS):
        for number, line in enumerate(cpp_text.code_only(text).split("\n"), 1):
            for m in EXTREME.finditer(line):
                if m.group() not in STORED:
                    found.append((number, f"{m.group()}: say max... or min..."))
    return found


def check(root):
    seen, faults = 0, 0
    for path in cpp_text.files(root):
        seen += path.suffix in (".h", ".cpp") or is_document(path)
        for number, message in faults_of(root, path):
            print(f"{path}:{number}: {message}")
            faults += 1
    return seen, faults


def self_test():
    refused = {
        "sim/contact/a.h": ["double mostSwept = 0.0;", "/// Is told of nothing more.", "int n = 0;  // room for what comes", "SolidPlace place;"],
        "sim/step/b.cpp": ["withdraw(state);", "carryOut(problem);", "// see poseProblem()"],
        "docs/c.md": ["the room to its left", "a lean recording", "`forceRest` decays"],
    }
    allowed = {
        "sim/contact/a.h": ["double maxSwept = 0.0;", 'visit("largestDisplacement", self.largestDisplacement);', "// at most, at least, the rest of it",
                            "std::size_t room = 0;"],
        "sim/step/b.cpp": ["// tells the world", "double largestSpeed = 0.0;"],
        "analytics/cohort/d.cpp": ["withdraw(participant);"],
        "docs/c.md": ["a classroom of trainees, `room()`", "the operating-room lights"],
        "docs/glossary.md": ["room: not used"],
    }
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for examples, expected in ((refused, True), (allowed, False)):
            for name, lines in examples.items():
                for line in lines:
                    path = root / name
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_text(line + "\n", encoding="utf-8")
                    if bool(faults_of(root, pathlib.Path(name))) != expected:
                        print(f"{name}: {line!r} should be {'refused' if expected else 'allowed'}")
                        wrong += 1
    return wrong


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if sys.argv[1] == "--self-test":
        return 1 if self_test() else 0
    seen, faults = check(pathlib.Path(sys.argv[1]))
    print(f"words: {seen} files, {faults} faults")
    return 1 if faults or seen == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
