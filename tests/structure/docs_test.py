#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the documentation usable: short pages, lines and tables that fit a screen, a purpose and an example at the head of each page, every
page within reach of the index, links and anchors that exist, excerpts that are those of the file, and no program that names a page of the
source tree.

usage: docs_test.py ROOT | --self-test
"""
import collections
import os
import pathlib
import re
import sys
import tempfile

import cpp_text

LINES = 250  # a page
COLUMNS = 120  # of prose; cells of a table wrap
CELLS = 10  # of a row
HEAD = 40  # lines in which a page shows its example
INDEX = "docs/index.md"
PAGES = ("docs", "schemas")
PROGRAMS = ("apps", "analytics", "recorder", "gui")

LINK = re.compile(r"(?<!`)(!?)\[([^\]\[]*)\]\(([^)\s]+)\)")
HEADING = re.compile(r"(#{1,6}) (.+)")
# The file that the fenced block behind it is an excerpt of.
EXCERPT = re.compile(r"<!-- excerpt of (\S+) -->")
# A page's name in a string of a program: who installed a package has no folder docs.
NAMED = re.compile(r'"[^"\n]*\bdocs/[\w/-]+\.md[^"\n]*"')


def slug(heading):
    """The anchor of a heading, as GitHub and the site make it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
    return re.sub(r"[^\w\- ]", "", text).strip().replace(" ", "-")


def outside_fences(text):
    """(number, line) of what is no code between fences."""
    fence = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fence = not fence
        elif not fence:
            yield number, line


def anchors(text):
    return [slug(m[2]) for _, line in outside_fences(text) if (m := HEADING.fullmatch(line))]


def paragraphs(text):
    """Links may go over the end of a line: the lines of a paragraph as one, with the number of its first."""
    lines, first = [], 0
    for number, line in outside_fences(text):
        if line.strip() and not line.startswith("|"):
            first = first if lines else number
            lines.append(line.strip())
            continue
        if lines:
            yield first, " ".join(lines)
        lines = []
        if line.startswith("|"):
            yield number, line
    if lines:
        yield first, " ".join(lines)


def links(text):
    for number, paragraph in paragraphs(text):
        for image, _, target in LINK.findall(re.sub(r"`[^`]*`", lambda m: "`" * len(m[0]), paragraph)):
            if not re.match(r"[a-z]+:", target):
                yield number, image, target


def length_faults(text):
    """What does not fit a screen."""
    lines = text.splitlines()
    if len(lines) > LINES:
        yield LINES, f"{len(lines)} lines: split the page, {LINES} at most"
    for number, line in outside_fences(text):
        if line.startswith("|"):
            cells = len(re.findall(r"(?<!\\)\|", line)) - 1
            if cells > CELLS:
                yield number, f"a table of {cells} columns: {CELLS} at most"
        elif len(line) > COLUMNS and " " in line.strip()[:COLUMNS] and not line.startswith("    "):
            yield number, f"{len(line)} columns: {COLUMNS} at most"
    inside = dict(enumerate(lines, 1)).keys() - dict(outside_fences(text)).keys()
    for number in sorted(inside):
        if len(lines[number - 1]) > COLUMNS:
            yield number, f"{len(lines[number - 1])} columns of code: {COLUMNS} at most"


def head_faults(text):
    """A page begins with its title, a sentence of what it is for, and an example."""
    lines = text.splitlines()
    if not lines or not lines[0].startswith("# "):
        yield 1, "no title"
        return
    body = [(n, line) for n, line in enumerate(lines[1:], 2) if line.strip()]
    if not body or re.match(r"[#|`!<>-]|    ", body[0][1]) and not re.match(r"`[^`]", body[0][1]):
        yield 2, "no sentence after the title that says what the page is for"
    if not any(re.match(r"```|    \S|!\[|Example: ", line) or "Example: " in line for line in lines[:HEAD]):
        yield 2, f"no example in the first {HEAD} lines: a fenced block, a picture, or a sentence that begins with Example:"
    for anchor, count in collections.Counter(anchors(text)).items():
        if count > 1:
            yield 1, f"two headings with the anchor #{anchor}"


def excerpt_faults(root, text):
    """An excerpt's lines are those of the file, in one piece."""
    for match in EXCERPT.finditer(text):
        number = text.count("\n", 0, match.start()) + 1
        block = re.match(r"\s*```\w*\n(.*?)\n```", text[match.end():], re.DOTALL)
        file = root / match[1]
        if block is None or not file.is_file():
            yield number, f"no fenced block behind it, or no file {match[1]}"
        elif f"\n{block[1]}\n" not in f"\n{file.read_text(encoding='utf-8')}":
            yield number, f"not what {match[1]} says: copy the lines anew"


def link_faults(root, path, text):
    for number, _, target in links(text):
        name, _, anchor = target.partition("#")
        file = pathlib.Path(os.path.normpath(path.parent / name)) if name else path
        if not (root / file).exists():
            yield number, f"link leads nowhere: {target}"
        elif anchor and file.suffix == ".md" and anchor not in anchors((root / file).read_text(encoding="utf-8")):
            yield number, f"no heading with this anchor: {target}"


def pages_of(root):
    return [p for p in cpp_text.files(root) if p.suffix == ".md" and (p.parts[0] in PAGES or len(p.parts) == 1)]


def reached(root, start):
    """Pages within reach of one by links."""
    seen, open_pages = set(), [pathlib.Path(start)]
    while open_pages:
        page = open_pages.pop()
        if page in seen or not (root / page).is_file():
            continue
        seen.add(page)
        for _, _, target in links((root / page).read_text(encoding="utf-8")):
            name = target.partition("#")[0]
            if name.endswith(".md"):
                open_pages.append(pathlib.Path(os.path.normpath(page.parent / name)))
    return seen


def check(root):
    """[(page, line, message)]"""
    faults = []
    pages = pages_of(root)
    within_reach = reached(root, INDEX)
    for path in pages:
        text = (root / path).read_text(encoding="utf-8")
        found = list(link_faults(root, path, text)) + list(excerpt_faults(root, text))
        if path.parts[0] in PAGES:
            found += length_faults(text)
            if path not in within_reach:
                found.append((1, f"no link leads here from {INDEX}"))
        if path.parts[0] == "docs":
            found += head_faults(text)
        faults += [(path, number, message) for number, message in found]
    for path in cpp_text.files(root):
        if path.suffix in (".h", ".cpp") and path.parts[0] in PROGRAMS:
            for number, line in enumerate((root / path).read_text(encoding="utf-8").splitlines(), 1):
                if NAMED.search(line) and not line.lstrip().startswith("//"):
                    faults.append((path, number, "a message names a page of the source tree: say what to type, or leave it out"))
    return len(pages), faults


def self_test():
    good = "# A\n\nFor this.\n\n```\ncalot a\n```\n\n"
    index = good + "[a](a.md) [b](b.md#part-one)\n"
    cases = (
        ({}, 0), ({"docs/a.md": good + "x " * 70 + "\n"}, 1), ({"docs/a.md": good + "x\n" * LINES}, 1), ({"docs/a.md": "# A\n\n## B\n\n```\nx\n```\n"}, 1),
        ({"docs/a.md": "# A\n\nFor this.\n"}, 1), ({"docs/a.md": good + "[x](c.md)\n"}, 1), ({"docs/a.md": good + "[x\ny](b.md#part-two)\n"}, 1),
        ({"docs/a.md": good + "## B\n\n## B\n"}, 1), ({"docs/c.md": good}, 1), ({"docs/a.md": good + "| a " * 11 + "|\n"}, 1),
        ({"docs/a.md": good + "<!-- excerpt of f.py -->\n```python\nb = 1\n```\n", "f.py": "a = 1\nb = 1\n"}, 0),
        ({"docs/a.md": good + "<!-- excerpt of f.py -->\n```python\nb = 2\n```\n", "f.py": "a = 1\nb = 1\n"}, 1),
        ({"apps/a.cpp": 'auto x = "see docs/how-to/a.md";\n'}, 1), ({"apps/a.cpp": "// docs/how-to/a.md\n"}, 0),
        ({"docs/a.md": good + "`[no](link.md)`\n\n```\n[no](link.md)\n```\n"}, 0),
    )
    for files, expected in cases:
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            tree = {INDEX: index, "docs/a.md": good, "docs/b.md": good + "## Part one\n"} | files
            for file, text in tree.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_text(text)
            _, faults = check(root)
            assert len(faults) == expected, (files, faults)
    print(f"docs: {len(cases)} cases judged as they must be")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return 0
    seen, faults = check(pathlib.Path(sys.argv[1]))
    for path, number, message in faults:
        print(f"{path}:{number}: {message}")
    print(f"docs: {seen} pages, {len(faults)} faults")
    return 1 if faults or seen == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
