# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a user's metric in a process of its own (docs/how-to/own-metrics.md).

usage: run_metric.py SCRIPT SHOWN_NAME [FOLDER]

Without FOLDER the script's declarations are read; with it, compute() is called on the attempt that lies there. What is found is one line of
JSON on file descriptor 3: {"name": ...}, {"value": ...}, {"missing": REASON}, or {"fault": TEXT, "line": N}.
"""
import difflib
import json
import math
import os
import sys


class Faulty(Exception):
    """What is wrong with the script, in words."""


class Columns(dict):
    """Columns by name, each read when it is first asked for."""

    def __init__(self, folder, table, names, why):
        super().__init__()
        self._folder, self._table, self._names, self._why = folder, table, names, why

    def __missing__(self, name):
        import numpy
        if name not in self._names:
            if not self._names:
                raise KeyError(f"there are no {self._table}: {self._why}")
            near = difflib.get_close_matches(str(name), self._names, 3, 0.5) or self._names[:3] + ["..."]
            raise KeyError(f"{self._table} have no {name!r}; there are {len(self._names)}, such as {', '.join(near)}")
        self[name] = column = numpy.load(os.path.join(self._folder, self._table, name + ".npy"), mmap_mode="r")
        return column

    def __contains__(self, name):
        return name in self._names

    def __iter__(self):
        return iter(self._names)

    def __len__(self):
        return len(self._names)

    def keys(self):
        return list(self._names)


class Attempt:
    """What a script sees of an attempt."""

    def __init__(self, folder):
        with open(os.path.join(folder, "attempt.json"), encoding="utf-8") as file:
            described = json.load(file)
        self.header = described["attempt"]
        self.structures = described["structures"]
        self.columns = described["columns"]
        for table, why in (("results", "the motion is without a scene"), ("samples", "the attempt is empty"), ("events", "the motion is without a scene")):
            names = [c["name"] for c in self.columns if c["table"] == table]
            setattr(self, table, Columns(folder, table, names, why))


def declared(space):
    found = {}
    for key, kind, what in (("NAME", str, "a text"), ("VERSION", int, "a whole number"), ("UNIT", str, "a text"), ("BETTER", str, "\"lower\", \"higher\" or \"none\"")):
        if key not in space:
            raise Faulty(f"declares no {key}; {what} is expected")
        value = space[key]
        if not isinstance(value, kind) or isinstance(value, bool):
            raise Faulty(f"{key} is a {type(value).__name__}; {what} is expected")
        found[key.lower()] = value
    title = space.get("TITLE", found["name"])
    if not isinstance(title, str):
        raise Faulty(f"TITLE is a {type(title).__name__}; a text is expected")
    found["title"] = title
    if not callable(space.get("compute")):
        raise Faulty("defines no function compute(attempt)")
    return found


def computed(result):
    """What compute() returned, as an answer."""
    reason = None
    if isinstance(result, tuple) and len(result) == 2 and result[0] is None and isinstance(result[1], str):
        result, reason = result
    if result is None:
        return {"missing": reason or "compute returned None"}
    import numbers
    if hasattr(result, "item") and getattr(result, "ndim", None) == 0:
        result = result.item()
    if isinstance(result, bool) or not isinstance(result, numbers.Real):
        raise Faulty(f"compute returned a {type(result).__name__}; a number, None or (None, \"reason\") is expected")
    value = float(result)
    if math.isnan(value):
        return {"missing": "compute returned NaN"}
    if math.isinf(value):
        raise Faulty("compute returned infinity; a finite number, None or (None, \"reason\") is expected")
    return {"value": value}


def line_of(error, shown):
    """The newest line of the script itself that the error passed through."""
    line = error.lineno if isinstance(error, SyntaxError) and error.filename == shown else None
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == shown:
            line = trace.tb_lineno
        trace = trace.tb_next
    return line


def answer(script, shown, folder):
    try:
        import numpy  # noqa: F401  (its absence is no fault of the script)
    except Exception as error:
        return {"setup": f"{sys.executable} has no usable numpy ({type(error).__name__}: {error})"}
    try:
        with open(script, "rb") as file:
            code = compile(file.read(), shown, "exec")
        space = {"__name__": "calot_metric", "__file__": shown}
        exec(code, space)
        found = declared(space)
        return found if folder is None else computed(space["compute"](Attempt(folder)))
    except Faulty as error:
        return {"fault": str(error)}
    except MemoryError as error:
        return {"memory": True, "line": line_of(error, shown)}
    except BaseException as error:  # the script's own exit as well
        text = error.args[0] if isinstance(error, KeyError) and error.args else error
        if isinstance(error, SyntaxError):
            text = error.msg
        return {"fault": f"{type(error).__name__}: {text}".strip(": "), "line": line_of(error, shown)}


def main():
    os.set_inheritable(3, False)
    owner = os.getpid()
    sys.path[:] = sys.path[1:]  # the folder of this file is nobody's module
    found = answer(sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else None)
    if os.getpid() == owner:  # not what a script forked and forgot
        os.write(3, json.dumps(found).encode() + b"\n")
    sys.stdout.flush()
    os._exit(0)


main()
