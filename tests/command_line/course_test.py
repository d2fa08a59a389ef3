# SPDX-License-Identifier: GPL-3.0-or-later
"""calot course: from motion of people on several days and a norm to who is proficient, who is behind, and what is missing."""

import datetime
import json
import math

import program

TODAY = datetime.datetime.now(datetime.timezone.utc).date()
GOOD, BAD = 0.03, 0.09  # m: how far hands reach


def motion(seed, reach, seconds=2):
    """Two hands that reach to and fro, as 76 columns of text."""
    lines = []
    for row in range(30 * seconds + 1):
        t = row / 30
        cells = []
        for group in range(4):
            place = [0.04 + 0.03 * (group % 2) + reach * math.sin(2.5 * t + 0.1 * seed + axis) for axis in range(3)]
            cells += [*place, 1, 0, 0, 0, 1, 0, 0, 0, 1, *[0] * 7]
        lines.append(" ".join(f"{c:.6g}" for c in cells))
    return "\n".join(lines) + "\n"


class Trainees(program.ProgramTest):
    """A norm on each of two tasks, and trainees."""

    def setUp(self):
        super().setUp()
        self.cohort, self.rows, self.made = self.path("c.db"), [], 0
        for task in ("reaching", "knots"):
            for person in range(6):
                for group, reach in (("expert", GOOD), ("novice", BAD)):
                    self.attempt(f"{group}{person}", group, task, reach * (1 + person / 40), "2025-12-01")

    def attempt(self, who, group, task, reach, day, **more):
        self.made += 1
        name = f"m{self.made}.txt"
        self.path(name).write_text(motion(self.made, reach))
        self.rows.append({"file": name, "participant": who, "group": group, "task": task, "start": f"{day}T09:{self.made % 60:02}:00Z",
                          "outcome": "completed", "mode": "assessment", **more})

    def store(self):
        """All attempts, and the norms by experts and novices."""
        table = self.path("m.csv")
        table.write_text("\n".join(",".join(cells) for cells in [list(self.rows[0]), *[list(r.values()) for r in self.rows]]) + "\n")
        self.well("import", "--manifest", table, "--cohort", self.cohort)
        attempts = json.loads(self.well("attempt", "list", "--cohort", self.cohort, "--json").out)["attempts"]
        keys = {a["scene"]: a["key"] for a in attempts if a["mode"] == "assessment"}
        for task, key in keys.items():
            self.well("norm", "create", self.cohort, task, "--by", "A. Instructor", "--rule", "all", "--checkpoints", "path-length",
                      "--groups", "expert,novice", "--better", "expert", "--key", key)

    def course(self, **more):
        file = self.path("course.json")
        tasks = [{"scene": "reaching", "title": "Reach", "goal": "Reach.", "criterion": {"norm": "reaching"}},
                 {"scene": "knots", "title": "Tie", "goal": "Tie.", "criterion": {"norm": "knots"}}]
        for number, criterion in more.pop("criteria", {}).items():
            tasks[number]["criterion"].update(criterion)
        file.write_text(json.dumps({"format": "calot-course", "formatVersion": 1, "name": "c", "title": "C", "tasks": tasks, **more}))
        return file


class Course(Trainees):
    def progress(self, *arguments, **more):
        said = json.loads(self.well("course", self.cohort, "--course", self.course(**more), "--json", *arguments).out)
        self.assertEqual((said["schema"], said["version"], said["day"]), ("calot-course-progress", 1, str(TODAY)))
        return {p["participant"]: p for p in said["participants"]}

    def test_a_trainee_who_passes_at_the_third_try(self):
        for day, reach in ((5, BAD), (6, GOOD), (7, GOOD)):
            self.attempt("T1", "trainee", "reaching", reach, f"2026-01-{day:02}")
        self.attempt("T2", "trainee", "reaching", GOOD, "2026-01-05")
        self.attempt("T2", "trainee", "reaching", BAD, "2026-01-06")
        self.store()
        people = self.progress(groups=["trainee"])
        self.assertEqual(list(people), ["T1", "T2"])
        reach, tie = people["T1"]["tasks"]
        self.assertEqual((reach["state"], reach["tries"], reach["missing"]), ("proficient", 3, None))
        self.assertEqual([a["effect"] for a in reach["attempts"]], ["failed", "counted", "proficient"])
        self.assertEqual(reach["proficient_utc"], reach["attempts"][2]["start_utc"])
        self.assertIn("path-length", reach["attempts"][0]["failure"])
        self.assertEqual((tie["state"], tie["open"], tie["due_day"]), ("not begun", True, None))
        other = people["T2"]["tasks"]
        self.assertEqual((other[0]["state"], other[0]["passes_in_row"], other[1]["open"]), ("practising", 0, False))
        # The grade agrees with every attempt.
        for attempt in reach["attempts"]:
            graded = json.loads(self.well("grade", self.cohort, "--attempt", attempt["attempt"], "--norm", "reaching", "--json").out)
            self.assertEqual(graded["passed"], attempt["passed"])
        shown = self.well("course", self.cohort, "--course", self.course(groups=["trainee"]), environment={"COLUMNS": "80"}).out
        rows = [line.split() for line in shown.splitlines()]
        self.assertIn(["T1", "proficient", "-"], rows)
        self.assertIn(["T2", "0/2", "-"], rows)
        self.assertLessEqual(max(map(len, shown.splitlines())), 80)
        person = self.well("course", self.cohort, "--course", self.course(), "--participant", "T2").out
        self.assertIn(other[0]["missing"], " ".join(person.split()))
        everybody = [line.split() for line in self.well("course", self.cohort, "--course", self.course()).out.splitlines()]
        self.assertIn(["T1", "trainee", "proficient", "-"], everybody, "groups, where they differ")
        self.assertLessEqual(max(map(len, person.splitlines())), 80)

    def test_days_decide_too(self):
        ago = lambda days: str(TODAY - datetime.timedelta(days))  # noqa: E731
        for days, reach in ((50, GOOD), (49, GOOD), (43, GOOD), (5, BAD)):
            self.attempt("T1", "trainee", "reaching", reach, ago(days))
        for days in (50, 43):
            self.attempt("T2", "trainee", "reaching", GOOD, ago(days))
        self.attempt("T3", "trainee", "reaching", BAD, ago(20))
        self.store()
        people = self.progress("--group", "trainee", daysBetween=7, criteria={0: {"retentionDays": 30, "dueDays": 15}})
        first, second, third = (people[who]["tasks"][0] for who in ("T1", "T2", "T3"))
        self.assertEqual([a["effect"] for a in first["attempts"]], ["counted", "too soon", "proficient", "lapsed"])
        self.assertEqual((first["state"], first["behind"]), ("lapsed", True))
        self.assertEqual((second["state"], second["retention_day"], second["behind"]), ("retention due", ago(13), False))
        self.assertEqual((third["state"], third["due_day"], third["behind"]), ("practising", ago(5), True))
        self.assertEqual([p["behind"] for p in people.values()], [True, False, True])
        shown = self.well("course", self.cohort, "--course", self.path("course.json"), "--group", "trainee").out
        behind = [line for line in shown.splitlines() if line.startswith("Behind: ")]
        self.assertEqual([line.split()[1] for line in behind], ["T1,", "T3,"])
        self.assertIn(f"Retention test: T2, Reach (due since {ago(13)}).", shown)

    def test_what_does_not_count_is_said(self):
        self.attempt("T1", "trainee", "reaching", GOOD, "2026-01-05", mode="practice")
        self.attempt("T1", "trainee", "reaching", GOOD, "2026-01-06", outcome="abandoned")
        self.attempt("T1", "trainee", "reaching", GOOD, "2026-01-07")
        self.store()
        last = self.progress()["T1"]["tasks"][0]
        self.assertEqual([a["passed"] for a in last["attempts"]], [False, True])
        self.assertEqual([n["attempts"] for n in last["not_counted"]], [1])
        self.assertIn("mode practice", last["not_counted"][0]["reason"])
        self.well("attempt", "exclude", last["attempts"][1]["attempt"], "--cohort", self.cohort, "--reason", "wrong person", "--by", "me")
        self.assertEqual(self.progress()["T1"]["tasks"][0]["passes_in_row"], 0)

    def test_what_is_refused(self):
        self.store()
        before = self.cohort.read_bytes()
        ask = ("course", self.cohort, "--course")
        self.refused(3, *ask, self.course(criteria={1: {"norm": "hospital"}}), names=("course.json: /tasks/1/criterion/norm", '"hospital"', "knots 1"))
        self.refused(3, *ask, self.course(criteria={1: {"norm": "reaching"}}), names=("course.json: /tasks/1/criterion/norm", "reaching", "knots"))
        self.refused(3, *ask, self.course(groups=["expert", "residents"]), names=("course.json: /groups/1", '"residents"', "novice"))
        self.refused(4, *ask, self.course(criteria={0: {"passes": 0}}), names=("course.json: /tasks/0/criterion/passes",))
        self.refused(4, *ask, self.course(begins="2026-02-30"), names=("course.json: /begins",))
        self.refused(4, *ask, self.path("none.json"), names=("none.json",))
        self.refused(2, *ask, "nothing", names=("nothing", "basic"))
        self.refused(4, "course", self.path("none.db"), "--course", self.course(), names=("none.db",))
        self.refused(3, *ask, self.course(), "--participant", "T9", names=("T9",))
        self.refused(3, *ask, self.course(groups=["expert"]), "--group", "novice", names=("novice", "expert"))
        self.assertEqual(self.cohort.read_bytes(), before)


if __name__ == "__main__":
    program.main()
