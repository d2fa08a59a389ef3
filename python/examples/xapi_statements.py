# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Attempts as statements for a learning record store
#
# `xapi_statements.py C.db HOME OUT.json [--include-synthetic]` writes a statement of the Experience API (IEEE 9274.1.1, "xAPI 2.0") for each
# attempt of a cohort, as an array that a learning record store takes by POST /statements. HOME is the begin of the site's identifiers, such as
# https://training.example.org. Without arguments it makes a cohort of two performers in a folder that goes away.
#
# A statement's id is the attempt's uuid: sent twice, it is stored once. The actor is the participant's pseudonym as an account at HOME. Left
# out are excluded attempts, those of withdrawn participants, those without participant, and, unless asked for, those of performers. The file
# is registered in the cohort, so that a withdrawal lists it. Whether an attempt was passed is a matter of a norm: success and score are not
# stated.

# %%
import json
import pathlib
import re
import sys
import tempfile

import calot


def fail(text: str) -> None:
    sys.exit(f"xapi_statements: {text}")


# %%
def value_of(row: dict) -> dict:
    """A checkpoint in its SI unit, or why there is none."""
    one = {"checkpoint": row["name"], "version": row["version"]}
    if row["subject"]:
        one["subject"] = row["subject"]
    if row["value"] is not None:
        one |= {"value": row["value"], "unit": row["unit"]}
    else:
        one |= {"unavailable": row["availability"], "reason": row["reason"]}
    return one | {"origin": row["origin"]}


def statement_of(attempt: dict, values: list[dict], home: str) -> dict:
    completed = attempt["outcome"] == "completed"
    verb = "completed" if completed else "attempted"
    statement = {
        "id": attempt["attempt"],
        "actor": {"objectType": "Agent", "account": {"homePage": home, "name": attempt["participant"] or attempt["profile"]}},
        "verb": {"id": f"http://adlnet.gov/expapi/verbs/{verb}", "display": {"en": verb}},
        "object": {"objectType": "Activity", "id": f"{home}/scenes/{attempt['scene']}/{attempt['scene_major']}",
                   "definition": {"type": "http://adlnet.gov/expapi/activities/simulation",
                                  "name": {"en": f"{attempt['scene']} {attempt['scene_major']}.{attempt['scene_minor']}"}}},
        "result": {"completion": completed, "duration": f"PT{attempt['seconds']:.2f}S",
                   "extensions": {f"{home}/extensions/checkpoints": [value_of(v) for v in values]}},
        "context": {"platform": f"calot {calot.__version__}",
                    "extensions": {f"{home}/extensions/attempt": {
                        "outcome": attempt["outcome"], "mode": attempt["mode"], "device": attempt["device"], "comparability_key": attempt["key"],
                        "simulation_version": attempt["simulation_version"], "verification": attempt["verdict"], "synthetic": attempt["synthetic"]}}}}
    if attempt["start_utc"]:
        statement["timestamp"] = attempt["start_utc"]
    return statement


def rows(table: dict) -> list[dict]:
    """A table of columns as a list of rows of plain Python values."""
    plain = {name: column.tolist() for name, column in table.items()}
    return [dict(zip(plain, row)) for row in zip(*plain.values())]


def write_statements(database: pathlib.Path, home: str, out: pathlib.Path, synthetic: bool) -> int:
    home = home.rstrip("/")
    if not re.fullmatch(r"https?://[^\s\"<>\\^`{|}?#/][^\s\"<>\\^`{|}?#]*", home):
        fail(f"\"{home}\" is not a home page: give the site's own, such as https://training.example.org")
    cohort = calot.Cohort(database)
    attempts = [a for a in rows(cohort.attempts(frame=False, analysed=False))
                if not a["excluded"] and (a["participant"] or (a["synthetic"] and a["profile"])) and (synthetic or not a["synthetic"])]
    if not attempts:
        fail(f"{database}: no attempt is of a participant and neither excluded nor synthetic")
    values: dict[str, list[dict]] = {}
    for row in rows(cohort.values(frame=False, analysed=False)):
        row["value"] = None if row["value"] is None or row["value"] != row["value"] else row["value"]
        values.setdefault(row["attempt"], []).append(row)
    with open(out, "x", encoding="utf-8") as file:
        json.dump([statement_of(a, values.get(a["attempt"], []), home) for a in attempts], file, indent=2)
        file.write("\n")
    calot.record_export(database, "xapi", out, [a["attempt"] for a in attempts])
    return len(attempts)


# %%
if len(sys.argv) in (4, 5) and sys.argv[4:] in ([], ["--include-synthetic"]):
    try:
        count = write_statements(pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3]), len(sys.argv) == 5)
    except (calot.Error, OSError) as error:
        fail(str(error))
    print(f"{sys.argv[3]}: {count} statements")
elif len(sys.argv) > 1:
    fail("usage: xapi_statements.py C.db HOME OUT.json [--include-synthetic]")
else:
    with tempfile.TemporaryDirectory(prefix="calot-") as name:
        folder = pathlib.Path(name)
        for performer in ("skilled", "unskilled"):
            calot.record(folder / f"{performer}.h5", "touch-liver", performer, seconds=1)
            calot.assess(folder / f"{performer}.h5", cohort=folder / "c.db")
        write_statements(folder / "c.db", "https://training.example.org", folder / "statements.json", True)
        print((folder / "statements.json").read_text(encoding="utf-8")[:600])
