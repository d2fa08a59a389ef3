# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Attempts as statements for a learning record store
#
# `xapi_statements.py C.db HOME OUT.json [--include-synthetic] [--course PROGRESS.json]` writes a statement of the Experience API (IEEE
# 9274.1.1, "xAPI 2.0") for each attempt of a cohort, as an array that a learning record store takes by POST /statements. HOME is the begin of
# the site's identifiers, such as https://training.example.org. Without arguments it makes a cohort of two performers in a folder that goes
# away.
#
# A statement's id is the attempt's uuid: sent twice, it is stored once. The actor is the participant's pseudonym as an account at HOME. Left
# out are excluded attempts, those of withdrawn participants, those without participant, and, unless asked for, those of performers. The file
# is registered in the cohort, so that a withdrawal lists it.
#
# Whether an attempt was passed is a matter of a norm: success is stated where a course names it. PROGRESS.json is what `calot course --json`
# prints; each attempt that counts for a task with a criterion then has a second statement, "passed" or "failed", and the one by which its
# participant became proficient a third, "mastered". Their ids follow from what they state: sent twice, they are stored once, and another
# judgement is another statement.

# %%
import argparse
import json
import pathlib
import re
import sys
import tempfile
import urllib.parse
import uuid

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


def activity(address: str, kind: str, name: str) -> dict:
    return {"objectType": "Activity", "id": address, "definition": {"type": f"http://adlnet.gov/expapi/activities/{kind}", "name": {"en": name}}}


def who_did(attempt: dict, verb: str, home: str) -> dict:
    """The part that all statements of an attempt share."""
    shared = {"actor": {"objectType": "Agent", "account": {"homePage": home, "name": attempt["participant"] or attempt["profile"]}},
              "verb": {"id": f"http://adlnet.gov/expapi/verbs/{verb}", "display": {"en": verb}}}
    if attempt["start_utc"]:
        shared["timestamp"] = attempt["start_utc"]
    return shared


def statement_of(attempt: dict, values: list[dict], home: str) -> dict:
    completed = attempt["outcome"] == "completed"
    return {
        "id": attempt["attempt"],
        **who_did(attempt, "completed" if completed else "attempted", home),
        "object": activity(f"{home}/scenes/{attempt['scene']}/{attempt['scene_major']}", "simulation",
                           f"{attempt['scene']} {attempt['scene_major']}.{attempt['scene_minor']}"),
        "result": {"completion": completed, "duration": f"PT{attempt['seconds']:.2f}S",
                   "extensions": {f"{home}/extensions/checkpoints": [value_of(v) for v in values]}},
        "context": {"platform": f"calot {calot.__version__}",
                    "extensions": {f"{home}/extensions/attempt": {
                        "outcome": attempt["outcome"], "mode": attempt["mode"], "device": attempt["device"], "comparability_key": attempt["key"],
                        "simulation_version": attempt["simulation_version"], "verification": attempt["verdict"], "synthetic": attempt["synthetic"]}}}}


def read_course(file: pathlib.Path) -> dict:
    try:
        course = json.loads(file.read_text(encoding="utf-8"))
    except ValueError as error:
        fail(f"{file}: {error}")
    if not isinstance(course, dict) or (course.get("schema"), course.get("version")) != ("calot-course-progress", 1):
        fail(f"{file}: is not what calot course --json prints")
    return course


def course_statements(course: dict, attempts: dict[str, dict], home: str) -> list[dict]:
    """Passed, failed and mastered, of attempts that the course judges."""
    address = f"{home}/courses/{urllib.parse.quote(course['course'], safe='')}"
    statements = []
    for person in course["participants"]:
        for task, standing in zip(course["tasks"], person["tasks"]):
            for judged in standing["attempts"] if task["criterion"] else []:
                attempt = attempts.get(judged["attempt"])
                if attempt is None:
                    continue
                place = f"{address}/tasks/{urllib.parse.quote(task['scene'], safe='')}"
                criterion = {"norm": f"{task['criterion']['norm']} {task['criterion']['norm_version']}", "passes": task["criterion"]["passes"],
                             "passes_in_row": judged["passes_in_row"], "effect": judged["effect"], "failure": judged["failure"],
                             "synthetic": attempt["synthetic"]}
                for verb in ["passed" if judged["passed"] else "failed"] + ["mastered"] * (judged["effect"] == "proficient"):
                    content = json.dumps([place, judged["attempt"], verb, criterion])
                    statements.append({
                        "id": str(uuid.uuid5(uuid.NAMESPACE_URL, content)),
                        **who_did(attempt, verb, home),
                        "object": activity(place, "assessment", task["title"]),
                        "result": {"success": judged["passed"], "extensions": {f"{home}/extensions/criterion": criterion}},
                        "context": {"platform": f"calot {calot.__version__}",
                                    "contextActivities": {"parent": [activity(address, "course", course["title"])]},
                                    "statement": {"objectType": "StatementRef", "id": judged["attempt"]}}})
    return statements


def rows(table: dict) -> list[dict]:
    """A table of columns as a list of rows of plain Python values."""
    plain = {name: column.tolist() for name, column in table.items()}
    return [dict(zip(plain, row)) for row in zip(*plain.values())]


def write_statements(database: pathlib.Path, home: str, out: pathlib.Path, synthetic: bool, course: pathlib.Path | None = None) -> int:
    home = home.rstrip("/")
    if not re.fullmatch(r"https?://[^\s\"<>\\^`{|}?#/][^\s\"<>\\^`{|}?#]*", home):
        fail(f"\"{home}\" is not a home page: give the site's own, such as https://training.example.org")
    progress = read_course(course) if course else None
    cohort = calot.Cohort(database)
    attempts = [a for a in rows(cohort.attempts(frame=False, analysed=False))
                if not a["excluded"] and (a["participant"] or (a["synthetic"] and a["profile"])) and (synthetic or not a["synthetic"])]
    if not attempts:
        fail(f"{database}: no attempt is of a participant and neither excluded nor synthetic")
    values: dict[str, list[dict]] = {}
    for row in rows(cohort.values(frame=False, analysed=False)):
        row["value"] = None if row["value"] is None or row["value"] != row["value"] else row["value"]
        values.setdefault(row["attempt"], []).append(row)
    statements = [statement_of(a, values.get(a["attempt"], []), home) for a in attempts]
    if progress:
        statements += course_statements(progress, {a["attempt"]: a for a in attempts}, home)
    with open(out, "x", encoding="utf-8") as file:
        json.dump(statements, file, indent=2)
        file.write("\n")
    calot.record_export(database, "xapi", out, [a["attempt"] for a in attempts])
    return len(statements)


# %%
if len(sys.argv) > 1:
    parser = argparse.ArgumentParser(prog="xapi_statements")
    parser.error = fail
    parser.add_argument("cohort", type=pathlib.Path)
    parser.add_argument("home")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--include-synthetic", action="store_true")
    parser.add_argument("--course", type=pathlib.Path, metavar="PROGRESS.json")
    asked = parser.parse_args()
    try:
        count = write_statements(asked.cohort, asked.home, asked.out, asked.include_synthetic, asked.course)
    except (calot.Error, OSError) as error:
        fail(str(error))
    print(f"{asked.out}: {count} statements")
else:
    with tempfile.TemporaryDirectory(prefix="calot-") as name:
        folder = pathlib.Path(name)
        for performer in ("skilled", "unskilled"):
            calot.record(folder / f"{performer}.h5", "touch-liver", performer, seconds=1)
            calot.assess(folder / f"{performer}.h5", cohort=folder / "c.db")
        write_statements(folder / "c.db", "https://training.example.org", folder / "statements.json", True)
        print((folder / "statements.json").read_text(encoding="utf-8")[:600])
