#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuses retired words (docs/glossary.md): old names of functions and types anywhere, most/least/largest/smallest in names of the mechanics,
words with several meanings in its comments and in the documents; and in the comments and messages of every module, fragments that begin with a
relative word ("What it does", "Of a mouse alone") and phrases that no engineer writes. Refuses assertions that pin a sentence, so that messages
can be mended: a test checks an error's kind, place and values (tests/support/fault.h). Only what can be detected reliably is listed.

usage: words_test.py ROOT | --self-test
"""
import ast
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

# Comments and messages of every module: a subject, a verb, an object.
MODULES = ("sim", "recorder", "analytics", "gui", "apps", "python", "packaging")
FRAGMENT = re.compile(r"(?:Of|What|Whether|Why|Who|Which|Where)\b(?![^.:;]*\?)")
PHRASES = ((re.compile(r"(?<!\bthere )\b(?:is|are) none\b"), "is not one, is invalid, is unknown"),
           (re.compile(r"\btell(?:s|ing)? of\b"), "report, contain"), (re.compile(r"\btold\b"), "reported, counted, distinguished"),
           (re.compile(r"\b(?:takes?|taking|taken|took) up\b(?! to\b)"), "gather, continue, adopt"),
           (re.compile(r"\bso many\b"), "this number of, at most N"), (re.compile(r"\bsuch as there (?:is|are)\b"), "all of them"),
           (re.compile(r"\banew\b"), "again"))
WHOLE_COMMENT = re.compile(r"\s*//[/!]?<?(?: |$)(.*)")
TRAILING_COMMENT = re.compile(r"///?< ?(.*)|[;{},)\\]\s*// (.*)")
# A statement that prints, throws or describes an option.
MESSAGE_SITE = re.compile(r"\b(?:throw|Error|print\w*|cout|cerr|fail\w*|refuse\w*|fault|warn\w*|add_option|add_flag|add_subcommand"
                          r"|addChoice|addNumber|addList|addThreads|addCommand|addGroup)\b")

# Assertions of tests. Two neighbouring words, one of them here, are part of a sentence.
PROSE = ("a|an|the|of|to|in|is|are|was|were|be|has|have|had|no|not|cannot|can|must|than|with|without|there|this|that|it|its|by|at|from|for|on|as|"
         "already|only|another|more|before|after|which|who|and|or|neither|both|does|did|would|such")
SENTENCE = re.compile(rf"(?<![\w-])(?:(?:{PROSE}),? [a-z]{{2,}}|[a-z]{{2,}},? (?:{PROSE}))(?![\w-])", re.IGNORECASE)
SQL = re.compile(r"\s*(?:SELECT|INSERT|UPDATE|DELETE|PRAGMA|CREATE|DROP|ALTER)\b")
ASSERTION = re.compile(r"\b(?:EXPECT|ASSERT)_\w+\(|\bexpect\w+\(|\bfault\(|\brefused\(|[.>](?:find|rfind|contains|startsWith|starts_with)\($")
# Files whose subject is the text itself.
TEXTS = {
    "tests/gui/words/attempt_summary_test.cpp",  # sentences of a summary
    "tests/analytics/checkpoints/replay_words_test.cpp",  # sentences of replays and runs
    "tests/analytics/report/page_test.cpp",  # layout of text
    "tests/analytics/report/study_report_test.cpp",  # sections of the report
    "tests/apps/common/errors_test.cpp",  # advice of the programs
    "tests/sim/geometry/organs_test.cpp",  # titles of the files
    "tests/recorder/sources/devices/camera/tracker_accuracy_test.cpp",  # names of conditions
    "tests/cluster/snakemake_test.py",  # Snakemake's own words
    "tests/gui/trainer/attempt_report_test.cpp", "tests/gui/trainer/controls_tutorial_test.cpp",
    "tests/gui/trainer/trainer_texts_test.cpp", "tests/gui/words/event_words_test.cpp", "tests/gui/words/problem_words_test.cpp",
}


def pins_of_cpp(text):
    """(line number, literal) of each assertion of a C++ test that pins a sentence."""
    code = cpp_text.code_only(text)
    asserted, data = [], set()
    for start, literal in cpp_text.strings(text):
        prose = literal.strip('"')
        statement = re.split(r";|[{}]\s*\n", code[max(0, start - 600):start])[-1]
        if "<<" in statement or not SENTENCE.search(prose) or SQL.match(prose) or literal.startswith("R"):
            continue
        if ASSERTION.search(statement.strip()):
            asserted.append((text.count("\n", 0, start) + 1, prose))
        else:
            data.add(prose)
    return [pin for pin in asserted if pin[1] not in data]


def pins_of_python(text):
    """(line number, literal) of each sentence that a Python test expects on standard error."""
    def spoken(node):
        for part in ast.walk(node):
            if isinstance(part, ast.Constant) and isinstance(part.value, str) and SENTENCE.search(part.value):
                yield part.lineno, part.value

    def is_error(node):
        return re.search(r"\.(?:err|stderr)\b|\b(?:declined|refused)\(", ast.unparse(node)) is not None
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Compare) and any(map(is_error, node.comparators)):
            yield from spoken(node.left)
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
            continue
        name = node.func.attr
        if name == "assertOneLine":
            for argument in node.args[1:]:
                yield from spoken(argument)
        elif name.startswith("assert") and len(node.args) > 1 and any(map(is_error, node.args[:2])):
            yield from (pin for argument in node.args[:2] if not is_error(argument) for pin in spoken(argument))
        for keyword in node.keywords:
            if keyword.arg == "names":
                yield from spoken(keyword.value)


def prose_faults(text):
    """(line number, message) of each fault of the comments and messages of a C++ file."""
    def phrases(number, prose):
        for pattern, better in PHRASES:
            for m in pattern.finditer(prose):
                yield number, f'"{m.group()}": say {better}'
    code = cpp_text.code_only(text)
    follows = False
    for number, (line, rest) in enumerate(zip(text.split("\n"), code.split("\n")), 1):
        whole = WHOLE_COMMENT.match(line)
        trailing = None if whole or "//" not in line or "//" in rest else TRAILING_COMMENT.search(line)
        prose = whole.group(1) if whole else (trailing.group(1) or trailing.group(2) or "") if trailing else ""
        if prose and not follows and (m := FRAGMENT.match(prose)):
            yield number, f'a comment that begins with "{m.group()}": begin with the subject'
        yield from phrases(number, prose)
        follows = whole is not None
    for start, literal in cpp_text.strings(text):
        prose = literal.strip('"')
        if " " not in prose:
            continue
        number = text.count("\n", 0, start) + 1
        yield from phrases(number, prose)
        statement = code[max(code.rfind(c, 0, start) for c in ";{}") + 1:start]
        if not re.search(r'"\s*$', text[:start]) and MESSAGE_SITE.search(statement) and (m := FRAGMENT.match(prose)):
            yield number, f'a message that begins with "{m.group()}": begin with the subject'


def is_document(path):
    return path.suffix == ".md" and (path.parts[0] == "docs" or len(path.parts) == 1)


def faults_of(root, path):
    """(line number, message) of each fault of one file."""
    found = []
    name = path.as_posix()
    cpp = path.suffix in (".h", ".cpp")
    document = is_document(path) and path.name not in ("glossary.md", "CHANGELOG.md")
    test = path.parts[0] == "tests" and path.suffix in (".cpp", ".py") and path.parts[1] != "structure"
    if not cpp and not document and not test:
        return found
    text = (root / path).read_text(encoding="utf-8")
    if test and name not in TEXTS:
        for number, prose in pins_of_cpp(text) if cpp else pins_of_python(text):
            found.append((number, f"an assertion pins the words {prose[:60]!r}: check kind, place and values"))
    if not cpp and not document:
        return found
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
    if cpp and path.parts[0] in MODULES:
        found.extend(prose_faults(text))
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
        "recorder/e.cpp": ["/// Whether it may be used.", "int a;  ///< Of a mouse alone", "// What is released moves.", "// a name that is none",
                           "// so many steps", "// nobody is told", "// takes up the topology", 'throw Error(kind, "What was written is lost");',
                           'throw Error(kind, fmt::format("{} is none", name));', 'command->add_option("--by", by, "Who decides");'],
        "docs/c.md": ["the room to its left", "a lean recording", "`forceRest` decays"],
        "tests/f.cpp": ['EXPECT_EQ(e.what(), "a.csv: the file is empty");', 'expectFault(kind, "a", {"is not a number"}, call);',
                        'EXPECT_NE(text.find("was not found"), npos);'],
        "tests/g.py": ['self.refused(2, "x", names=("no such file",))', 'self.assertIn("is empty", answer.err)', 'assert "not there" in done.stderr'],
    }
    allowed = {
        "sim/contact/a.h": ["double maxSwept = 0.0;", 'visit("largestDisplacement", self.largestDisplacement);', "// at most, at least, the rest of it",
                            "std::size_t room = 0;"],
        "sim/step/b.cpp": ["// tells the world", "double largestSpeed = 0.0;"],
        "recorder/e.cpp": ["// empty where there is none", "// What does a step cost?", "// The file,\n// of which only part is read.", "// takes up to ten",
                           'label("Where it stands");', 'const char* title = "Who finishes sooner";', "// https://example.org/so/many"],
        "analytics/cohort/d.cpp": ["withdraw(participant);"],
        "docs/c.md": ["a classroom of trainees, `room()`", "the operating-room lights"],
        "docs/glossary.md": ["room: not used"],
        "tests/f.cpp": ['EXPECT_EQ(name, "path-length left");', 'EXPECT_TRUE(closed) << "it is closed";',
                        'put("by the window");\nEXPECT_EQ(note, "by the window");', 'EXPECT_EQ(db.exec("SELECT a FROM b"), 1);'],
        "tests/g.py": ['self.refused(2, "x", names=("a.h5", "--force"))', 'self.assertIn("is empty", answer.out)'],
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
