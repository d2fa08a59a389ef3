#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes manual pages and the completion of shells from the help of programs.

  manual.py PROGRAM... --output DIR --date DATE --version V

A program tells its commands and options by --help-json; one without options tells a sentence by --help. DIR gets man1/*.1.gz, a page a
program and a page a command, and bash/, zsh/, fish/. The same programs and date give the same bytes. DATE is that of a Debian changelog.
"""
import argparse
import email.utils
import gzip
import json
import pathlib
import re
import shutil
import subprocess

import completion

# Files and variables that every program knows; the help of single options names further ones.
FILES = (("$XDG_CACHE_HOME/calot, ~/.cache/calot", "what is kept so that scenes start sooner (calot cache)"),
         ("$XDG_DATA_HOME/calot/engines, ~/.local/share/calot/engines", "a user's own kept engines (calot engine)"),
         ("/usr/share/calot", "scenes, organs, performers, forms, protocols"))
VARIABLES = (("CALOT_ASSETS", "folder of scenes, organs, performers, forms and protocols, in the place of the installed one"),
             ("CALOT_ENGINES", "folders of kept engines, a colon between two"),
             ("CALOT_CACHE", "folder of the cache, or off"))
EXITS = (("0", "success"), ("1", "internal failure: disk full, out of memory, no screen"), ("2", "wrong usage"),
         ("3", "the answer is no: diverged, different, refused"), ("4", "damaged, unreadable or missing input"),
         ("5", "cannot be decided: made by another simulation version, whose engine is not installed"))


def described(program):
    """A program's commands and options; None for one that has neither, with the sentence that it says."""
    answer = subprocess.run([program, "--help-json"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False)
    if answer.returncode == 0:
        return json.loads(answer.stdout)
    text = subprocess.run([program, "--help"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=True)
    name, _, sentence = " ".join((text.stdout + text.stderr).split()).partition(": ")
    return {"name": name, "help": sentence, "notes": "", "options": None, "commands": []}


def roff(text):
    """Text as a macro's argument or a line of its own."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def value_of(option):
    """What help shows as an option's value, without the name of a type where the words say more."""
    kind, _, words = option["value"].partition(":")
    if words.startswith("{"):
        return words.strip("{}").replace(",", "|")
    return kind


def syntax(option):
    """The names of an option, bold, with its value in italics."""
    value = value_of(option)
    if option["positional"] and not option["names"]:
        return f"\\fI{roff(option['positional'])}\\fR"
    names = ", ".join(f"\\fB{roff(n)}\\fR" for n in option["names"])
    return f"{names} \\fI{roff(value)}\\fR" if value else names


def meaning(option):
    """The help of an option as sentences: range, default, what it needs and excludes."""
    text = option["help"].strip()
    text = text if not text or text.endswith((".", "?")) else text + "."
    text = text[:1].upper() + text[1:]
    span = re.search(r"in \[(.*?)\]", option["value"])
    if span:
        text += f" Range: {span.group(1)}."
    if option["default"]:
        text += " Default: the current folder." if option["default"] == "." else f" Default: {option['default']}."
    if option["many"]:
        text += " Takes several."
    for word in ("needs", "excludes"):
        if option[word]:
            text += f" {word.capitalize()} {', '.join(option[word])}."
    return roff(text.strip())


def options_part(options, heading):
    lines = []
    for option in options or ():
        lines += [".TP", syntax(option), meaning(option)]
    return [heading, *lines] if lines else []


def usage(words, command):
    """The line of a synopsis: what is required, then what may be there."""
    parts = [f"\\fB{roff(words)}\\fR"]
    options = command["options"] or []
    for option in options:
        if option["required"] and not option["positional"]:
            parts.append(f"\\fB{roff(option['names'][-1])}\\fR \\fI{roff(value_of(option))}\\fR")
    if any(not o["required"] and o["names"] for o in options):
        parts.append("[\\fIoptions\\fR]")
    for option in options:
        if option["positional"]:
            name = f"\\fI{roff(option['positional'])}\\fR" + (" ..." if option["many"] else "")
            parts.append(name if option["required"] else f"[{name}]")
    if command["commands"]:
        parts.append("\\fIcommand\\fR ...")
    return " ".join(parts)


def synopses(words, command):
    lines = []
    for below in command["commands"]:
        inner = f"{words} {below['name']}"
        lines += [".br", usage(inner, below), *synopses(inner, below)]
    return lines


def sections(words, command):
    """The commands below a command, each with its options."""
    lines = []
    for below in command["commands"]:
        inner = f"{words} {below['name']}"
        lines += [f'.SH "{roff(inner).upper()}"', roff(below["help"]), *options_part(below["options"], ""), *notes_part(below, ".PP")]
        lines += sections(inner, below)
    return lines


def notes_part(command, heading=".SH NOTES"):
    if not command["notes"].strip():
        return []
    return [heading, ".nf", *(roff(line) for line in command["notes"].strip("\n").splitlines()), ".fi"]


def table(heading, rows):
    return [heading, *(line for name, text in rows for line in (".TP", f".B {roff(name)}", roff(text[:1].upper() + text[1:] + ".")))]


def page(name, command, words, version, date, extra=(), others=()):
    """One page: `words` is what a user types."""
    first = re.split(r"(?<=[a-z])[.;:] ", command["help"].strip().rstrip("."))[0]
    lines = [f'.TH {name.upper()} 1 "{date:%Y-%m-%d}" "Calot {version}" "Calot"', ".SH NAME",
             f"{roff(name)} \\- {roff(first[:1].lower() + first[1:])}", ".SH SYNOPSIS", usage(words, command)]
    lines += [] if others and command["commands"] else synopses(words, command)
    help_text = command["help"].strip()
    lines += [".SH DESCRIPTION", roff(help_text if help_text.endswith(".") else help_text + ".")]
    lines += options_part(command["options"], ".SH OPTIONS")
    if command["commands"] and others:
        lines += [".SH COMMANDS"]
        for below in command["commands"]:
            lines += [".TP", f"\\fB{roff(words + ' ' + below['name'])}\\fR(1)".replace(" ", "\\-", 1), roff(below["help"])]
    elif command["commands"]:
        lines += sections(words, command)
    lines += notes_part(command) + list(extra)
    lines += table(".SH ENVIRONMENT", VARIABLES) + table(".SH FILES", FILES) + table('.SH "EXIT STATUS"', EXITS)
    also = sorted({"calot", *others} - {name})
    if also:
        lines += ['.SH "SEE ALSO"', *(f".BR {roff(a)} (1){'' if a == also[-1] else ','}" for a in also)]
    return "\n".join(line for line in lines if line) + "\n"


def pages(programs, version, date):
    """Name and text of every page."""
    trees = {p["name"]: p for p in programs}
    made = {}
    names = list(trees)
    for name, tree in trees.items():
        if tree["options"] is None:
            continue
        others = [f"{name}-{c['name']}" for c in tree["commands"]]
        made[name] = page(name, tree, name, version, date, others=others + [n for n in names if n != name])
        for command in tree["commands"]:
            below = f"{name}-{command['name']}"
            # A program may have the name that a command's page has: they share it.
            program = trees.get(below)
            extra = [f'.SH "THE PROGRAM {roff(below).upper()}"', roff(program["help"])] if program else []
            made[below] = page(below, command, f"{name} {command['name']}", version, date, extra)
    for name, tree in trees.items():
        if name not in made:
            made[name] = page(name, tree, name, version, date)
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--date", required=True)
    parser.add_argument("--version", required=True)
    arguments = parser.parse_args()
    programs = [described(p) for p in arguments.programs]
    shutil.rmtree(arguments.output, ignore_errors=True)
    for folder in ("man1", *completion.SHELLS):
        (arguments.output / folder).mkdir(parents=True)
    date = email.utils.parsedate_to_datetime(arguments.date)
    for name, text in pages(programs, arguments.version, date).items():
        with open(arguments.output / "man1" / f"{name}.1.gz", "wb") as file:
            file.write(gzip.compress(text.encode(), 9, mtime=0))
    for program in programs:
        if program["options"] is None:
            continue
        for shell, (name, write) in completion.SHELLS.items():
            (arguments.output / shell / name.format(program["name"])).write_text(write(program), encoding="utf-8")


if __name__ == "__main__":
    main()
