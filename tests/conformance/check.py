#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds what a reader printed of a recording of the conformance set against expected.json, and names the first difference.

usage: check.py NAME OUTPUT [EXPECTED]

NAME: of a recording ("whole"). OUTPUT: JSON of the reader, or - for the standard input. Exit code 0: as expected, 1: not. What the reader prints beyond that is
ignored; parts that are optional may be missing, and are named.
"""
import json
import pathlib
import sys

EXPECTED = pathlib.Path(__file__).resolve().parent / "expected.json"


def difference(wanted, got, place=""):
    """Where the first difference lies and what it is, or None."""
    if isinstance(wanted, dict):
        if not isinstance(got, dict):
            return f"{place or 'the output'}: an object is wanted"
        for key, value in wanted.items():
            below = f"{place}.{key}" if place else key
            if key not in got:
                return f"{below}: missing"
            if (found := difference(value, got[key], below)) is not None:
                return found
        return None
    if isinstance(wanted, list):
        if not isinstance(got, list) or len(got) != len(wanted):
            return f"{place}: a list of {len(wanted)} is wanted, not {len(got) if isinstance(got, list) else json.dumps(got)}"
        return next((d for i, (a, b) in enumerate(zip(wanted, got)) if (d := difference(a, b, f"{place}[{i}]")) is not None), None)
    same = wanted == got and isinstance(wanted, bool) == isinstance(got, bool)
    return None if same else f"{place}: {json.dumps(wanted)} is wanted, not {json.dumps(got)}"


def check(name, output, expected):
    """The difference, and the optional parts that the reader leaves out."""
    wanted, left_out = json.loads(json.dumps(expected["recordings"][name])), []
    for part in expected["optional"]:
        *above, last = part.split(".")
        a, b = wanted, output
        for key in above:
            a, b = (a or {}).get(key), (b or {}).get(key) if isinstance(b, dict) else None
        if isinstance(a, dict) and last in a and not (isinstance(b, dict) and last in b):
            del a[last]
            left_out.append(part)
    return difference(wanted, output), left_out


def main():
    name, source = sys.argv[1:3]
    expected = json.loads(pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else EXPECTED).read_text(encoding="utf-8"))
    if name not in expected["recordings"]:
        sys.exit(f"check: there is no recording {name!r}; there are {', '.join(expected['recordings'])}")
    text = sys.stdin.read() if source == "-" else pathlib.Path(source).read_text(encoding="utf-8")
    try:
        output = json.loads(text)
    except json.JSONDecodeError as e:
        sys.exit(f"check: {name}: no JSON: {e}")
    found, left_out = check(name, output, expected)
    if found is not None:
        sys.exit(f"check: {name}: {found}")
    print(f"{name}: as expected" + (f"; not given: {', '.join(left_out)}" if left_out else ""))


if __name__ == "__main__":
    main()
