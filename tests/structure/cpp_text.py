# SPDX-License-Identifier: GPL-3.0-or-later
"""What the structure tests share: the project's files, and C++ without its comments and strings."""
import pathlib
import re

_SKIPPED = {".git", "build", "demo", "__pycache__", ".cache", ".vscode", ".idea"}

_TOKEN = re.compile(
    r"""//(?:\\\n|[^\n])*          # line comment
      | /\*.*?\*/                  # block comment
      | R"([^()\\\s]{0,16})\(.*?\)\1"   # raw string
      | "(?:\\.|[^"\\\n])*"        # string
      | (?<![0-9A-Za-z_])'(?:\\.|[^'\\\n])*'   # character, not a digit separator
    """,
    re.DOTALL | re.VERBOSE)


def files(root):
    """Every file of the tree that is meant to be committed, as paths relative to root."""
    def walk(folder):
        for entry in sorted(folder.iterdir()):
            if entry.name in _SKIPPED or entry.is_symlink():
                continue
            if entry.is_dir():
                yield from walk(entry)
            else:
                yield entry.relative_to(root)
    return list(walk(pathlib.Path(root)))


def code_only(text, keep_includes=False):
    """The text with comments and strings blanked, line numbers kept; quoted includes too where asked for."""
    def blank(match):
        start = text.rfind("\n", 0, match.start()) + 1
        if keep_includes and re.match(r'\s*#\s*include\s*$', text[start:match.start()]):
            return match.group()
        return re.sub(r"[^\n]", " ", match.group())
    return _TOKEN.sub(blank, text)


def includes(text):
    """(line number, name, is quoted) of every include directive that is not commented out."""
    for number, line in enumerate(code_only(text, keep_includes=True).splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)")', line)
        if match:
            yield number, match.group(1) or match.group(2), match.group(2) is not None


def strings(text):
    """(offset, literal with its quotes) of every string literal outside of comments; no include's name."""
    for match in _TOKEN.finditer(text):
        start = text.rfind("\n", 0, match.start()) + 1
        if match.group().startswith(('"', 'R"')) and not re.match(r"\s*#\s*include\s*$", text[start:match.start()]):
            yield match.start(), match.group()
