# SPDX-License-Identifier: GPL-3.0-or-later
"""calot import: motion without a scene. Figures against an independent calculation, identity, and files that are none."""

import csv
import json
import math
import sqlite3
import unittest
from contextlib import closing

import numpy
import program
from cohort_content import edited, query
from program import calot

try:
    import scipy.signal
    SCIPY = True
except ImportError:
    print("scipy is not installed: no independent calculation")
    SCIPY = False

RATE = 100.0
HANDS = ("left", "right")


def synthetic(seconds, generator):
    """Two hands that reach and rest, 30 rows a second: positions (m), rotation matrices, grippers of masters and slaves."""
    rows = int(seconds * 30)
    t = numpy.arange(rows) / 30.0
    hands = []
    for hand in range(2):
        phase = [generator.uniform(0.0, 2.0 * math.pi) for _ in range(8)]
        slow = [generator.uniform(0.4, 1.6) for _ in range(4)]
        envelope = numpy.clip(0.3 + 1.2 * numpy.sin(0.9 * t + phase[6]), 0.0, 1.0)  # reaches in every 7 s, and rests
        place = numpy.stack([0.05 * envelope * numpy.sin(slow[i] * 2.5 * t + phase[i]) + 0.01 * numpy.sin(0.2 * t + phase[3 + i])
                             for i in range(3)], axis=1) + [0.04 + 0.04 * hand, 0.04, -0.05]
        angle, tilt = 0.6 * numpy.sin(slow[3] * t + phase[6]), 0.3 * numpy.cos(0.7 * t + phase[7])
        ca, sa, cb, sb = numpy.cos(angle), numpy.sin(angle), numpy.cos(tilt), numpy.sin(tilt)
        zero, one = numpy.zeros(rows), numpy.ones(rows)
        about_z = numpy.stack([ca, -sa, zero, sa, ca, zero, zero, zero, one], axis=1).reshape(rows, 3, 3)
        about_x = numpy.stack([one, zero, zero, zero, cb, -sb, zero, sb, cb], axis=1).reshape(rows, 3, 3)
        hands.append((place, about_z @ about_x))
    return hands


def text_of(hands):
    rows = len(hands[0][0])
    table = numpy.zeros((rows, 76))
    for group in range(4):
        table[:, 19 * group + 3:19 * group + 12] = numpy.eye(3).reshape(9)
    for hand, (place, rotation) in enumerate(hands):
        first = 19 * (2 + hand)
        table[:, first:first + 3] = place
        table[:, first + 3:first + 12] = rotation.reshape(rows, 9)
    return "\n".join(" ".join(repr(float(x)) for x in row) for row in table) + "\n"


def read_text(path):
    table = numpy.array([[float(word) for word in line.split()] for line in path.read_text().splitlines() if line.strip()])
    return [(table[:, 19 * g:19 * g + 3], table[:, 19 * g + 3:19 * g + 12].reshape(-1, 3, 3)) for g in (2, 3)]


def quaternions(rotations):
    """w x y z of rotations that are rounded: the eigenvector of the greatest eigenvalue (Bar-Itzhack 2000) is a fit; Shepperd's rule is
    what the documentation names, and what is normalised."""
    out = numpy.empty((len(rotations), 4))
    for i, r in enumerate(rotations):
        trace = numpy.trace(r)
        best = numpy.argmax([trace, r[0, 0], r[1, 1], r[2, 2]])
        if best == 0:
            q = [1 + trace, r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
        else:
            a = best - 1
            b, c = (a + 1) % 3, (a + 2) % 3
            q = [r[c, b] - r[b, c], 0, 0, 0]
            q[1 + a] = 1 + r[a, a] - r[b, b] - r[c, c]
            q[1 + b] = r[a, b] + r[b, a]
            q[1 + c] = r[a, c] + r[c, a]
        out[i] = q / numpy.linalg.norm(q)
    for i in range(1, len(out)):
        if out[i] @ out[i - 1] < 0:
            out[i] *= -1
    return out


class Reference:
    """docs/reference/metrics/samples.md in NumPy and SciPy: nothing of the program's own."""

    def __init__(self, place, rotations, rate=30.0, cutoff=6.0):
        kept = self.samples(place, rotations, rate)
        place, rotations, row = place[kept], rotations[kept], kept.astype(float)
        points = int(math.floor(row[-1] * RATE / rate + 1e-9)) + 1
        at = numpy.arange(points) * rate / RATE
        b, a = scipy.signal.butter(2, cutoff, fs=RATE)

        def smooth(x):
            return scipy.signal.filtfilt(b, a, x, padlen=min(50, len(x) - 1))

        self.p = numpy.stack([smooth(numpy.interp(at, row, place[:, i])) for i in range(3)], axis=1)
        q = quaternions(rotations)
        q = numpy.stack([numpy.interp(at, row, q[:, i]) for i in range(4)], axis=1)  # neighbours are on one side
        q /= numpy.linalg.norm(q, axis=1, keepdims=True)
        q = numpy.stack([smooth(q[:, i]) for i in range(4)], axis=1)
        self.q = q / numpy.linalg.norm(q, axis=1, keepdims=True)
        self.v = numpy.linalg.norm(numpy.gradient(self.p, 1.0 / RATE, axis=0), axis=1)

    @staticmethod
    def samples(place, rotations, rate):
        """Rows that differ from the one before; of a pose that stands for more than 0.1 s the last one, too."""
        moved = (numpy.diff(place, axis=0) != 0).any(axis=1) | (numpy.diff(rotations, axis=0) != 0).any(axis=(1, 2))
        own = [0, *(numpy.flatnonzero(moved) + 1)]
        return numpy.array(sorted({*own, *(b - 1 for a, b in zip(own, [*own[1:], len(place)]) if (b - 1 - a) / rate > 0.1)}))

    def stretches(self, mask, least):
        edges = numpy.flatnonzero(numpy.diff(numpy.concatenate([[0], mask.astype(int), [0]])))
        return [(a, b) for a, b in zip(edges[::2], edges[1::2]) if b - a >= least]

    def path(self, first=0, last=None):
        return numpy.linalg.norm(numpy.diff(self.p[first:last], axis=0), axis=1).sum()

    def movements(self):
        return self.stretches(self.v >= max(numpy.quantile(self.v, 0.95) / 2, 0.005), 20)

    def widened(self, movement):
        a, b = movement
        while a > 0 and 0.005 <= self.v[a - 1] < self.v[a]:
            a -= 1
        while b < len(self.v) and 0.005 <= self.v[b] < self.v[b - 1]:
            b += 1
        return a, b

    @staticmethod
    def sparc(v):
        size = 2 ** (math.ceil(math.log2(len(v))) + 4)
        f = numpy.arange(size) * (RATE / size)
        m = numpy.abs(numpy.fft.fft(v, size))
        m /= m.max()
        f, m = f[f <= 10.0], m[f <= 10.0]
        above = numpy.flatnonzero(m >= 0.05)
        f, m = f[above[0]:above[-1] + 1], m[above[0]:above[-1] + 1]
        return -numpy.sqrt((numpy.diff(f) / (f[-1] - f[0])) ** 2 + numpy.diff(m) ** 2).sum()

    @staticmethod
    def ldlj(v):
        dt = 1.0 / RATE
        jerk = numpy.diff(v, 2) / dt ** 2
        return -math.log((len(v) * dt) ** 3 / v.max() ** 2 * (jerk ** 2).sum() * dt)

    def values(self):
        movements = self.movements()
        z = numpy.stack([2 * (self.q[:, 1] * self.q[:, 3] + self.q[:, 0] * self.q[:, 2]),
                         2 * (self.q[:, 2] * self.q[:, 3] - self.q[:, 0] * self.q[:, 1]),
                         1 - 2 * (self.q[:, 1] ** 2 + self.q[:, 2] ** 2)], axis=1)
        turn = numpy.linalg.norm(numpy.diff(self.q, axis=0), axis=1)
        out = {
            "path-length": self.path(),
            "depth-path": numpy.abs((numpy.diff(self.p, axis=0) * (z[1:] + z[:-1]) / 2).sum(axis=1)).sum(),
            "angular-path": (4 * numpy.arcsin(turn / 2)).sum(),
            "speed-mean": self.v.mean(),
            "speed-p95": numpy.quantile(self.v, 0.95),
            "movements": len(movements),
            "idle-time": sum(b - a for a, b in self.stretches(self.v < 0.005, 50)) / RATE,
            "sparc": self.sparc(self.v),
            "log-dimensionless-jerk": self.ldlj(self.v),
            "working-volume": 4 / 3 * math.pi * 7.814727903251179 ** 1.5 * math.sqrt(numpy.linalg.det(numpy.cov(self.p.T))),
        }
        if movements:
            out["movement-jerk"] = numpy.mean([self.ldlj(self.v[a:b]) for a, b in map(self.widened, movements)])
            out["movement-straightness"] = (sum(numpy.linalg.norm(self.p[b - 1] - self.p[a]) for a, b in movements) /
                                            sum(self.path(a, b) for a, b in movements))
        return out


def values_of(rows):
    return {(v["name"], v["subject"]): v["value"] for v in rows}


def content(path):
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as database:
        return {table: database.execute(f"SELECT * FROM {table} ORDER BY 1, 2").fetchall()
                for table in ("attempt", "recording", "verification", "checkpoint_value", "participant", "audit")}


class Figures(program.ProgramTest):
    def compare(self, path, cutoff=6):
        rows = json.loads(self.well("import", path, "--cutoff", cutoff, "--json").out)["files"]
        values = values_of(rows[0]["checkpoints"])
        references = [Reference(*hand, cutoff=cutoff) for hand in read_text(path)]
        for hand, reference in zip(HANDS, references):
            for name, expected in reference.values().items():
                with self.subTest(f"{path.name} {name} {hand} at {cutoff} Hz"):
                    self.assertLessEqual(abs(values[name, hand] - expected), 1e-9 * abs(expected))
            self.assertAlmostEqual(values["motion-rate", hand], 30.0, delta=1e-9)
        left, right = references
        expected = {
            "bimanual-correlation": numpy.corrcoef(left.v, right.v)[0, 1],
            "hand-ratio": right.path() / (left.path() + right.path()),
            "idle-time-both": sum(b - a for a, b in left.stretches((left.v < 0.005) & (right.v < 0.005), 50)) / RATE,
            "attempt-duration": (len(read_text(path)[0][0]) - 1) / 30.0,
        }
        n = len(left.v)
        lags = {lag: numpy.corrcoef(left.v[max(0, -lag):n - max(0, lag)], right.v[max(0, lag):n + min(0, lag)])[0, 1]
                for lag in range(-100, 101)}
        best = max(lags, key=lags.get)  # the edge of the search may only be on the way to it
        expected["bimanual-lag"] = best / RATE if lags[best] > 0 and abs(best) < 100 else None
        for name, value in expected.items():
            with self.subTest(f"{path.name} {name} at {cutoff} Hz"):
                if value is None:
                    self.assertIsNone(values[name, ""])
                else:
                    self.assertLessEqual(abs(values[name, ""] - value), 1e-9 * abs(value))
        self.assertTrue(all(f"at {cutoff} Hz" in v["filter"] for v in rows[0]["checkpoints"] if "Butterworth" in v["filter"]))
        return values

    @unittest.skipUnless(SCIPY, "scipy is not installed")
    def test_made_motion_against_numpy_and_scipy(self):
        generator = program.seeded("import")
        for seconds in (7.0, 33.4, 60.1):
            path = self.path(f"{int(seconds)}.txt")
            path.write_text(text_of(synthetic(seconds, generator)))
            for cutoff in (3, 6, 10):
                self.compare(path, cutoff)

    @unittest.skipUnless(SCIPY, "scipy is not installed")
    def test_real_motion_against_numpy_and_scipy(self):
        files = sorted((program.SHARED / "kinematics").glob("Knot_Tying_*.txt"))
        if not files:
            self.skipTest(f"no real motion in {program.SHARED}/kinematics (CALOT_SHARED_DATA names another folder)")
        for path in files:
            self.compare(path)

    def test_the_same_motion_as_text_and_as_csv(self):
        hands = synthetic(20.0, program.seeded("import"))
        text, table, columns = self.path("k.txt"), self.path("k.csv"), self.path("map.json")
        text.write_text(text_of(hands))
        # Other names, order, units and form: millimetres, milliseconds, quaternions, the shaft along -y.
        turned = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)  # maps z onto -y
        quats = [quaternions(rotation @ turned.T) for _, rotation in hands]
        with table.open("w", newline="") as out:
            writer = csv.writer(out, delimiter=";")
            writer.writerow(["comment", "ms"] + [f"{h}{c}" for c in ("z", "y", "x", "qw", "qx", "qy", "qz") for h in "RL"])
            for i in range(len(hands[0][0])):
                cells = ["x", repr(500 + i * 1000 / 30)]
                for k, c in enumerate(("z", "y", "x", "qw", "qx", "qy", "qz")):
                    for hand in (1, 0):
                        cells.append(repr(float(hands[hand][0][i, 2 - k] * 1000 if k < 3 else quats[hand][i, k - 3])))
                writer.writerow(cells)
        columns.write_text(json.dumps({
            "format": "calot-columns", "formatVersion": 1, "frame": "robot-base", "device": "tracker", "length": "mm",
            "delimiter": ";", "time": {"column": "ms", "unit": "ms"},
            **{hand: {"position": [f"{h}x", f"{h}y", f"{h}z"], "quaternion": [f"{h}qw", f"{h}qx", f"{h}qy", f"{h}qz"], "axis": "-y"}
               for hand, h in zip(HANDS, "LR")}}))
        one = values_of(json.loads(self.well("import", text, "--cutoff", 6, "--json").out)["files"][0]["checkpoints"])
        two = values_of(json.loads(self.well("import", table, "--columns", columns, "--cutoff", 6, "--json").out)["files"][0]["checkpoints"])
        self.assertEqual(one.keys(), two.keys())
        for key, value in one.items():
            with self.subTest(key):
                self.assertEqual(value is None, two[key] is None)
                if value is not None:
                    self.assertAlmostEqual(value, two[key], delta=1e-9 * max(1.0, abs(value)))


class Exported(program.ProgramTest):
    """calot export --motion: what checkpoints are computed of gives their values to others, too."""

    def assertGives(self, folder, values):
        """Path length, movements and coverage again, by the tables alone."""
        summary = json.loads((folder / "motion.json").read_text())
        with (folder / "spans.csv").open(newline="") as file:
            spans = list(csv.DictReader(file))
        for hand in HANDS:
            with (folder / f"motion_{hand}.csv").open(newline="") as file:
                rows = list(csv.DictReader(file))
            place = numpy.array([[float(row[f"{axis} (m)"]) for axis in "xyz"] for row in rows])
            segment = numpy.array([int(row["segment"]) for row in rows])
            steps = numpy.linalg.norm(numpy.diff(place, axis=0), axis=1)[segment[1:] == segment[:-1]]
            self.assertAlmostEqual(steps.sum(), values["path-length", hand], delta=1e-12)
            movements = {row["movement"] for row in rows} - {""}
            self.assertEqual(len(movements), values["movements", hand])
            of_hand = [span for span in spans if span["hand"] == hand]
            self.assertEqual(sum(span["kind"] == "movement" for span in of_hand), len(movements))
            self.assertEqual(sum(span["kind"] == "segment" for span in of_hand), len(set(segment)))
            length = {kind: sum(float(s["end (s)"]) - float(s["begin (s)"]) for s in of_hand if s["kind"] == kind) for kind in ("mounted", "lost")}
            self.assertAlmostEqual(summary[hand]["coverage"], 1.0 - length["lost"] / length["mounted"], delta=1e-12)
            self.assertEqual(summary[hand]["points"], len(rows))

    def test_motion_of_a_file(self):
        path = self.path("k.txt")
        path.write_text(text_of(synthetic(20.0, program.seeded("import"))))
        values = values_of(json.loads(self.well("import", path, "--cutoff", 6, "--json").out)["files"][0]["checkpoints"])
        said = self.well("export", path, "--motion", self.path("out")).out.split()
        self.assertEqual(sorted(said), sorted(str(file) for file in self.path("out").iterdir()))
        self.assertGives(self.path("out"), values)
        self.refused(2, "export", path, "--motion", self.path("out"), names=(self.path("out"),))
        self.refused(2, "export", path, "--motion", self.path("new"), "--csv", self.path("csv"), names=("k.txt", "--motion"))

    def test_motion_of_a_recording(self):
        recording = program.skilled()
        values = values_of(json.loads(self.well("assess", recording, "--cutoff", 6, "--json").out)["recordings"][0]["checkpoints"])
        self.well("export", recording, "--motion", self.path("out"))
        self.assertGives(self.path("out"), values)
        self.refused(2, "export", recording, names=("--csv", "--motion"))


class Held(program.ProgramTest):
    def test_a_tracker_of_30_hz_held_on_ticks_of_1_khz(self):
        # The same motion as a file, and as a device that gives it 30 times a second to a recording: the ticks between are held. The device
        # is laid into the scene by a rigid motion, each hand by its own; only its turns are the port's.
        text, recording = self.path("k.txt"), self.path("r.h5")
        text.write_text(text_of(synthetic(12.0, program.seeded("import"))))
        program.calot("record", "--scene", program.SCENE, "--device", f"scripted:{text}", "-o", recording)
        one = values_of(json.loads(self.well("import", text, "--cutoff", 6, "--json").out)["files"][0]["checkpoints"])
        two = values_of(json.loads(self.well("assess", recording, "--cutoff", 6, "--json").out)["recordings"][0]["checkpoints"])
        for hand in HANDS:
            self.assertAlmostEqual(two["motion-rate", hand], 30.0, delta=0.05)
            self.assertAlmostEqual(two["path-length", hand] / one["path-length", hand], 1.0, delta=0.015)
            self.assertAlmostEqual(two["speed-p95", hand] / one["speed-p95", hand], 1.0, delta=0.02)
            # Unfiltered, ticks of a held motion taken as samples move LDLJ by 10 and more.
            self.assertAlmostEqual(two["log-dimensionless-jerk", hand], one["log-dimensionless-jerk", hand], delta=0.2)


class Identity(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.motion = self.path("k.txt")
        self.motion.write_text(text_of(synthetic(6.0, program.seeded("import"))))

    def stored(self, *arguments):
        return json.loads(self.well("import", *arguments, "--cohort", self.cohort, "--json").out)["files"]

    def test_twice_is_once(self):
        first = self.stored(self.motion, "--task", "knots", "--participant", "P1", "--mode", "assessment", "--outcome", "completed")
        self.assertEqual(first[0]["stored"], "added")
        before = content(self.cohort)
        again = self.stored(self.motion, "--task", "knots", "--participant", "P1", "--mode", "assessment", "--outcome", "completed")
        self.assertEqual(again[0]["stored"], "unchanged")
        self.assertEqual(content(self.cohort), before)
        with closing(sqlite3.connect(self.cohort)) as database:
            row = database.execute("SELECT uuid, scene, operator_kind, mode, outcome, simulation_version, comparability_key, synthetic "
                                   "FROM attempt").fetchone()
            self.assertEqual(row[1:], ("knots", 1, 1, 1, 0,
                                       "knots/0 device=kinematics calibration=- simulation=0 results=0 mode=assessment", 0))
            self.assertEqual(row[0][14], "8")
            self.assertEqual(database.execute("SELECT DISTINCT origin FROM checkpoint_value").fetchall(), [(2,)])
            self.assertEqual(database.execute("SELECT hex(chain_head) FROM recording").fetchone()[0].lower(), first[0]["sha256"])
            self.assertEqual(database.execute("SELECT verdict FROM verification").fetchall(), [(3,)])
            self.assertGreater(database.execute("SELECT count(*) FROM checkpoint_value WHERE value IS NOT NULL").fetchone()[0], 20)

    def test_a_copy_is_the_same_attempt_and_another_declaration_a_conflict(self):
        self.stored(self.motion)
        other = self.path("other.txt")
        other.write_bytes(self.motion.read_bytes())
        self.stored(other)
        with closing(sqlite3.connect(self.cohort)) as database:
            self.assertEqual(database.execute("SELECT file_name FROM recording").fetchall(), [("other.txt",)])
        before = content(self.cohort)
        for wrong in (["--task", "needle"], ["--participant", "P2"], ["--mode", "assessment"]):
            with self.subTest(" ".join(wrong)):
                self.refused(3, "import", other, *wrong, "--cohort", self.cohort, names=("other.txt", "conflict"))
        self.assertEqual(content(self.cohort), before)

    def test_the_motion_is_the_identity(self):
        """Line ends, tabs, units and further columns make neither another attempt nor another person's."""
        place = synthetic(6.0, program.seeded("identity"))[0][0]
        def table(name, separator=",", end="\n", more="", unit=1.0):
            rows = [separator.join(("t", "x", "y", "z") + ((more,) if more else ()))]
            rows += [separator.join([f"{i / 100}", *(f"{round(float(v), 6) * unit:.9f}" for v in p)] + (["7"] if more else [])) for i, p in enumerate(place)]
            self.path(name).write_text(end.join(rows) + end, newline="")
            columns = self.path(name + ".json")
            columns.write_text(json.dumps({"format": "calot-columns", "formatVersion": 1, "frame": "world", "length": "m" if unit == 1.0 else "mm",
                                           **({"delimiter": "tab"} if separator == "\t" else {}),
                                           "time": {"column": "t", "unit": "s"}, "left": {"position": ["x", "y", "z"]}}))
            return self.path(name), "--columns", columns
        person = ("--participant", "P1", "--mode", "assessment")
        self.stored(*table("a.csv"), *person)
        uuid = "SELECT uuid FROM attempt"
        (known,) = query(self.cohort, uuid)
        for name, how in (("crlf.csv", {"end": "\r\n"}), ("tabs.csv", {"separator": "\t"}), ("more.csv", {"more": "pedal"}), ("mm.csv", {"unit": 1000.0})):
            with self.subTest(name):
                self.stored(*table(name, **how), *person)
                self.assertEqual(query(self.cohort, uuid), [known])
                self.refused(3, "import", *table(name, **how), "--participant", "P2", "--mode", "assessment", "--cohort", self.cohort,
                             names=(name, "participant"))
        # A map that was wrong is corrected: the bytes are those of the known file.
        fixed = json.loads(self.path("a.csv.json").read_text())
        fixed["left"]["position"] = ["y", "x", "z"]
        self.path("fixed.json").write_text(json.dumps(fixed))
        self.assertEqual(self.stored(self.path("a.csv"), "--columns", self.path("fixed.json"), *person)[0]["stored"], "extended")
        self.assertEqual(query(self.cohort, uuid), [known])
        # Two sites that hold the same motion in other line ends have one attempt.
        other = self.path("o.db")
        self.well("import", *table("crlf.csv", end="\r\n"), *person, "--cohort", other)
        into = self.path("into.db")
        self.well("import", *table("a.csv"), *person, "--cohort", into)
        self.well("cohort", "merge", into, other)
        self.assertEqual(len(query(into, uuid)), 1)
        # Who withdrew does not come back in other line ends.
        self.well("participant", "withdraw", "P1", "--cohort", into, "--scope", "all", "--no-recordings")
        self.refused(3, "import", *table("tabs.csv", separator="\t"), *person, "--cohort", into, names=("withdrawn",))

    def test_a_file_that_an_earlier_version_took_in(self):
        """There the bytes were the identity."""
        first = self.stored(self.motion)
        digest = first[0]["sha256"]
        earlier = f"{digest[:8]}-{digest[8:12]}-8{digest[13:16]}-{int(digest[16:18], 16) & 0x3f | 0x80:02x}{digest[18:20]}-{digest[20:32]}"
        with edited(self.cohort) as database:
            database.execute("UPDATE attempt SET uuid = ?", (earlier,))
        self.assertEqual(self.stored(self.motion)[0]["stored"], "unchanged")
        self.assertEqual(query(self.cohort, "SELECT uuid FROM attempt"), [(earlier,)])

    def test_gaps_in_one_group_are_not_its_skill(self):
        # The same motion in both groups; a tracker that loses a sixth of the time in one of them, then a sixtieth.
        columns = self.path("map.json")
        columns.write_text(json.dumps({"format": "calot-columns", "formatVersion": 1, "frame": "world", "length": "m",
                                       "time": {"column": "t", "unit": "s"}, "left": {"position": ["x", "y", "z"]}}))
        for every, shown in ((60, 0), (600, 6)):
            cohort = self.path(f"gaps{every}.db")
            generator = program.seeded("gaps")
            for person in range(12):
                group = "expert" if person % 2 else "novice"
                if person % 2 == 0:
                    place = synthetic(40.0, generator)[0][0]
                path = self.path(f"{every}-{person}.csv")
                with path.open("w", newline="") as out:
                    out.write("t,x,y,z\n")
                    for i, p in enumerate(place):
                        if group == "novice" or i % every < every - 10:
                            out.write(f"{i / 30!r},{float(p[0])!r},{float(p[1])!r},{float(p[2])!r}\n")
                self.well("participant", "add", f"P{person}", "--group", group, "--cohort", cohort)
                self.well("import", path, "--columns", columns, "--participant", f"P{person}", "--mode", "assessment", "--cohort", cohort)
            answer = json.loads(self.well("study", cohort, "--json").out)
            rows = {(r["checkpoint"], r["subject"]): r for r in answer["rows"]}
            path = rows["path-length", "left"]
            self.assertEqual([g["n"] for g in path["groups"]], [shown, 6])
            self.assertEqual(path["groups"][0]["missing_kinds"], {} if shown else {"too little coverage": 6})
            self.assertEqual(rows["path-length", "right"]["groups"][0]["missing_kinds"], {"absent hand": 6})
            left = next(c for c in answer["coverage"] if c["subject"] == "left")
            self.assertTrue(left["differs"])
            self.assertAlmostEqual(left["mann_whitney"]["p"], 2 / 924, delta=1e-12)
            text = self.well("study", cohort, "--all").out
            self.assertIn("Warning: coverage differs (left hand)", " ".join(text.split()))
            for name in ("path-length", "sparc", "log-dimensionless-jerk"):
                if shown:
                    self.assertGreater(rows[name, "left"]["mann_whitney"]["p"], 0.05, name)

    def test_a_study_over_imported_motion(self):
        generator = program.seeded("study")
        for group, people in (("expert", "AB"), ("novice", "CD")):
            for person in people:
                self.well("participant", "add", person, "--group", group, "--cohort", self.cohort)
                path = self.path(f"{person}.txt")
                path.write_text(text_of(synthetic(6.0 + ord(person) % 7, generator)))
                self.well("import", path, "--participant", person, "--mode", "assessment", "--cohort", self.cohort)
        rows = json.loads(self.well("study", self.cohort, "--json").out)["rows"]
        self.assertEqual([[g["n"] for g in row["groups"]] for row in rows if row["checkpoint"] == "path-length"], [[2, 2]] * 2)


MAP = {"format": "calot-columns", "formatVersion": 1, "frame": "world", "length": "mm", "rate": 100,
       "left": {"position": ["x", "y", "z"]}}


class BadFiles(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort = self.path("c.db")
        self.good = text_of(synthetic(2.0, program.seeded("import"))).splitlines(keepends=True)
        self.columns = self.path("map.json")
        self.columns.write_text(json.dumps(MAP))

    def bad(self, name, text, *arguments, names=()):
        path = self.path(name)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        self.refused(4, "import", path, *arguments, "--cohort", self.cohort, names=(name, *names))
        self.assertFalse(self.cohort.exists(), "a file that cannot be read makes no database")

    def test_kinematics_files(self):
        good = self.good

        def with_word(column, word):
            words = good[4].split()
            words[column] = word
            return "".join(good[:4] + [" ".join(words) + "\n"] + good[5:])

        self.bad("empty.txt", "", names=("empty",))
        self.bad("one.txt", good[0], names=("1 row", "2"))
        self.bad("nan.txt", with_word(40, "NaN"), names=("line 5", "column 41"))
        self.bad("text.txt", with_word(57, "left"), names=("line 5", "column 58"))
        self.bad("cut.txt", "".join(good)[:-300], names=("line 60", "76"))
        self.bad("metres.txt", with_word(38, "41.5"), names=("line 5", "metres"))
        self.bad("binary.txt", bytes(range(256)) * 50)
        self.refused(4, "import", self.path("none.txt"), "--cohort", self.cohort, names=("none.txt",))
        self.assertFalse(self.cohort.exists())

    def test_huge_files(self):
        huge = self.path("huge.txt")
        with huge.open("wb") as out:
            out.truncate((1 << 30) + 1)  # a hole: no disk
        self.refused(4, "import", huge, "--cohort", self.cohort, names=("huge.txt",))
        rows = self.path("rows.csv")
        rows.write_text("x,y,z\n" + "1,2,3\n" * 1000001)
        self.refused(4, "import", rows, "--columns", self.columns, "--cohort", self.cohort, names=("line 1000002", "1000000"))
        self.assertFalse(self.cohort.exists())

    def test_csv_files_and_maps(self):
        csv_of = lambda *rows: "x,y,z\n" + "".join(row + "\n" for row in rows)
        with_map = ("--columns", self.columns)
        self.bad("zero.csv", csv_of(), *with_map, names=("0 rows",))
        self.bad("column.csv", "x,y\n1,2\n3,4\n", *with_map, names=("line 1", '"z"', "x, y"))
        self.bad("nan.csv", csv_of("1,2,3", "1,nan,3"), *with_map, names=("left", "1 of 2"))
        self.bad("text.csv", csv_of("1,2,3", "1,2,three"), *with_map, names=("line 3", "three"))
        self.bad("cut.csv", csv_of("1,2,3", "1,2,3") + "1,2", *with_map, names=("line 4", "2 cells"))
        self.bad("unit.csv", csv_of("1,2,3", "1,2,9000"), *with_map, names=("line 3", "5 m"))
        for change, words in (({"length": "foot"}, ("/length", "cm, inch, m, mm")), ({"rate": 0}, ("/rate",)), ({"more": 1}, ("/more",)),
                              ({"left": {"position": ["x", "y"]}}, ("/left/position",)), ({"rate": "fast"}, ("/rate",))):
            self.columns.write_text(json.dumps({**MAP, **change}))
            path = self.path("well.csv")
            path.write_text(csv_of("1,2,3", "1,2,4"))
            self.refused(4, "import", path, *with_map, "--cohort", self.cohort, names=("map.json", *words))
        self.columns.write_text("{")
        self.refused(4, "import", path, *with_map, "--cohort", self.cohort, names=("map.json", "line 1"))

    def test_good_files_beside_bad_ones_are_taken_in(self):
        good, bad = self.path("good.txt"), self.path("bad.txt")
        good.write_text("".join(self.good))
        bad.write_text("1 2 3\n")
        answer = calot("import", bad, good, "--cohort", self.cohort, "--json")
        self.assertEqual(answer.code, 4, answer)
        self.assertOneLine(answer, "bad.txt", "line 1")
        self.assertEqual([row["stored"] for row in json.loads(answer.out)["files"]], ["not stored", "added"])

    def test_wrong_usage(self):
        good, table = self.path("good.txt"), self.path("good.csv")
        good.write_text("".join(self.good))
        table.write_text("x,y,z\n1,2,3\n1,2,4\n")
        self.refused(2, "import", good, names=("--cohort",))
        self.refused(2, "import", good, "--cohort", self.cohort, "--cutoff", 3, names=("--cutoff",))
        self.refused(2, "import", good, "--cutoff", 7, names=("3, 6 or 10",))
        self.refused(2, "import", table, "--cohort", self.cohort, names=("good.csv", "--columns"))
        self.refused(2, "import", good, "--cohort", self.cohort, "--task", "two words", names=("--task",))
        self.refused(2, "import", good, "--cohort", self.cohort, "--start", "yesterday", names=("--start",))
        self.assertFalse(self.cohort.exists())
        text = self.path("no.db")
        text.write_text("no database at all, but long enough to be looked at as one\n" * 20)
        self.refused(4, "import", good, "--cohort", text, names=("no.db",))


if __name__ == "__main__":
    program.main()
