#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion files as trackers, robots and spreadsheets write them: one motion in many forms, read to one set of figures or refused with a
line that says what to do."""

import json
import random
import unittest

import h5py
import numpy
import program
from program import calot

NAMES = ["t", "lx", "ly", "lz", "rx", "ry", "rz"]
MAP = {"format": "calot-columns", "formatVersion": 1, "device": "optical-tracker", "frame": "world", "length": "mm",
       "time": {"column": "t", "unit": "s"}, "left": {"position": NAMES[1:4]}, "right": {"position": NAMES[4:]}}


def hand(seed, rate=100, seconds=20):
    """Minimum-jerk strokes of 2 s between points drawn at random (mm)."""
    generator, points = random.Random(seed), [(0.0, 0.0, 100.0)]
    while len(points) < seconds // 2 + 2:
        a = points[-1]
        points.append((a[0] + generator.uniform(-40, 40), a[1] + generator.uniform(-40, 40), 100 + generator.uniform(-20, 20)))
    places = []
    for i in range(rate * seconds + 1):
        stroke, s = divmod(i, 2 * rate)
        s /= 2 * rate
        share = 10 * s**3 - 15 * s**4 + 6 * s**5
        places.append([a + share * (b - a) for a, b in zip(points[stroke], points[stroke + 1])])
    return places


LEFT, RIGHT = hand(1), hand(2)
ROWS = [(i / 100, left, right) for i, (left, right) in enumerate(zip(LEFT, RIGHT))]
LOST = [*range(500, 530), *range(900, 903)]


def words(row):
    return [f"{row[0]:.6f}"] + [f"{v:.6f}" for v in row[1] + row[2]]


def table(rows=ROWS, separator=",", form=lambda cell: cell, names=None, end="\n", tail=""):
    lines = [separator.join(form(name) for name in names or NAMES)] + [separator.join(form(c) for c in words(row)) + tail for row in rows]
    return end.join(lines) + end


class MotionFiles(program.ProgramTest):
    def write(self, name, content):
        path = self.path(name)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def columns(self, **changes):
        whole = {key: value for key, value in {**MAP, **changes}.items() if value is not None}
        return self.write("map.json", json.dumps(whole))

    def figures(self, path, *arguments):
        """Figures by name and hand; the notes under "notes"."""
        row = json.loads(self.well("import", path, "--cutoff", 6, "--json", *arguments).out)["files"][0]
        return {**{(v["name"], v["subject"]): v for v in row["checkpoints"]}, "notes": row.get("notes", []), "rows": row["rows"]}

    def mapped(self, content, **changes):
        return self.figures(self.write("m.csv", content), "--columns", self.columns(**changes))

    def assertMotion(self, figures, hands=("left", "right"), jerk=0.05):
        truth = {"left": (378.95, 9, -13.71), "right": (356.24, 7, -13.89)}
        for side in hands:
            path, movements, smoothness = truth[side]
            self.assertAlmostEqual(figures["path-length", side]["value"], path / 1000, delta=0.0002, msg=side)
            self.assertEqual(figures["movements", side]["value"], movements)
            self.assertAlmostEqual(figures["log-dimensionless-jerk", side]["value"], smoothness, delta=jerk, msg=side)

    def refusedWith(self, code, path, *arguments, names=()):
        return self.refused(code, "import", path, "--cutoff", 6, *arguments, names=names)

    def test_spreadsheets(self):
        comma = lambda cell: cell.replace(".", ",")
        for name, content, changes in (
                ("plain", table(), {}),
                ("byte order mark, CRLF", "\ufeff" + table(end="\r\n"), {}),
                ("UTF-16", ("\ufeff" + table(separator="\t", end="\r\n")).encode("utf-16-le"), {}),
                ("UTF-16 from the big end", ("\ufeff" + table(separator="\t")).encode("utf-16-be"), {"delimiter": "tab"}),
                ("decimal comma", table(separator=";", form=comma, end="\r\n"), {"delimiter": ";"}),
                ("decimal comma, separator found", table(separator="\t", form=comma), {}),
                ("decimal comma in quotes", table(form=lambda cell: f'"{comma(cell)}"'), {"decimal": ","}),
                ("quotes", table(form=lambda cell: f'"{cell}"'), {}),
                ("separators that end rows", table(tail=",") + ",,,,,,,\n", {}),
                ("lines above and units below the names", "Exportiert,2026\n\n" + table().replace("\n", "\ns,mm,mm,mm,mm,mm,mm\n", 1), {}),
                ("lines that are skipped", table().replace("\n", "\nnote one\nnote two\n", 1), {"skip": 2}),
                ("Latin-1", table(names=["Zeit für t", *NAMES[1:]]).encode("latin-1"), {"time": {"column": "Zeit für t", "unit": "s"}})):
            with self.subTest(name):
                self.assertMotion(self.mapped(content, **changes))
        path = self.write("m.csv", table(names=["Zeit é", *NAMES[1:]]))
        self.refusedWith(4, path, "--columns", self.columns(), names=("line 1", "Zeit é"))

    def test_what_was_not_measured(self):
        for name, cells, changes in (("blank", ["", "", ""], {}), ("NaN", ["NaN"] * 3, {}), ("words", ["lost", "-", "n/a"], {}),
                                     ("number", ["-9999"] * 3, {"missing": ["-9999"]}), ("NDI", ["-3.697314E28"] * 3, {}),
                                     ("zeros", ["0.0"] * 3, {})):
            with self.subTest(name):
                lines = table().splitlines()
                for i in LOST:
                    old = lines[i + 1].split(",")
                    lines[i + 1] = ",".join([old[0], *cells, *old[4:]])
                figures = self.mapped("\n".join(lines) + "\n", **changes)
                self.assertMotion(figures, ("right",))
                self.assertAlmostEqual(figures["path-length", "left"]["value"], 0.37895, delta=0.002)
                self.assertAlmostEqual(figures["path-length", "left"]["coverage"], 1 - 0.33 / 20, delta=0.001)
                self.assertTrue(any("left" in note and "33 rows" in note for note in figures["notes"]), figures["notes"])
                self.assertFalse(any("right" in note for note in figures["notes"]), figures["notes"])
        lines = table().replace(RIGHT and words(ROWS[500])[4], "-9999").splitlines()
        self.refusedWith(4, self.write("m.csv", "\n".join(lines) + "\n"), "--columns", self.columns(), names=("line 502", '"missing"'))

    def test_clocks(self):
        def timed(form, **changes):
            rows = table().splitlines()
            return self.mapped("\n".join([rows[0]] + [",".join([form(i), *row.split(",")[1:]]) for i, row in enumerate(rows[1:])]) + "\n",
                               **changes)

        clock = lambda unit, **more: {"column": "t", "unit": unit, **more}
        lengths = set()
        for start in (1753000000123456789, 1753000099876543211):
            figures = timed(lambda i: str(start + i * 10_000_000), time=clock("ns"))
            self.assertMotion(figures)
            lengths.add(figures["attempt-duration", ""]["value"])
        self.assertEqual(lengths, {20.0})
        day = lambda i, form: form.format(58 + (5000 + i) // 6000, (5000 + i) % 6000 / 100)
        for unit, form, more in (("iso", "2026-10-25T00:{:02d}:{:06.3f}+02:00", {}), ("iso", "2026-10-25 00:{:02d}:{:06.3f}", {"zone": "Z"}),
                                 ("time-of-day", "00:{:02d}:{:06.3f}", {})):
            with self.subTest(form):
                self.assertMotion(timed(lambda i: day(i, form), time=clock(unit, **more)))
        self.assertMotion(timed(lambda i: str((65000 + 10 * i) % 65536), time=clock("ms", wraps=65536)))
        self.assertMotion(timed(lambda i: str(7 + i), time=clock("frame"), rate=100))
        path = self.write("m.csv", "t,lx,ly,lz,rx,ry,rz\n" + "".join(f"2026-10-25T02:59:{i // 100:02d}.{i % 100:02d},1,2,3,4,5,6\n" for i in range(99)))
        self.refusedWith(4, path, "--columns", self.columns(time=clock("iso")), names=("line 2", '"zone"'))
        path = self.write("m.csv", "t,lx,ly,lz,rx,ry,rz\n" + "".join(f"2026-10-25T02:{59 if i < 60 else 0:02d}:{i % 60:02d},1,2,3,4,5,6\n" for i in range(58, 62)))
        self.refusedWith(4, path, "--columns", self.columns(time=clock("iso", zone="+02:00")), names=("line 4", "autumn", "UTC"))

    def test_rows_out_of_order(self):
        twice = [row for i, row in enumerate(ROWS) for row in [row] * (2 if i % 97 == 50 else 1)]
        exchanged = [*ROWS[:700], ROWS[701], ROWS[700], *ROWS[702:]]
        for rows, line, dropped in ((twice, 53, 21), (exchanged, 703, 1)):
            path = self.write("m.csv", table(rows))
            self.refusedWith(4, path, "--columns", self.columns(), names=(f"line {line}", '"disorder": "drop"'))
            figures = self.mapped(table(rows), disorder="drop")
            self.assertMotion(figures)
            self.assertTrue(any(note.startswith(f"{dropped} row") for note in figures["notes"]), figures["notes"])

    def test_units(self):
        scaled = lambda factor: [(t, [v * factor for v in left], [v * factor for v in right]) for t, left, right in ROWS]
        self.assertMotion(self.mapped(table(scaled(1 / 25.4)), length="inch"), jerk=0.06)
        for rows, changes in ((scaled(1 / 25.4), {}), (scaled(0.001), {}), (scaled(0.1), {})):
            path = self.write("m.csv", table(rows))
            self.refusedWith(4, path, "--columns", self.columns(**changes), names=("mm/s", "inch", '"verified"'))
        checked = self.mapped(table(scaled(1 / 25.4)), verified=True)
        self.assertAlmostEqual(checked["path-length", "left"]["value"], 0.0149, delta=0.0001)
        path = self.write("m.csv", table([(t * 1000, *rest) for t, *rest in ROWS]))
        self.refusedWith(4, path, "--columns", self.columns(), names=("m.csv", "10 s"))
        self.assertMotion(self.mapped(table([(t * 1000, *rest) for t, *rest in ROWS]), time={"column": "t", "unit": "ms"}))

    def test_samples_that_no_hand_gives(self):
        # A tracker of 50 Hz that is logged at 500 Hz.
        slow = [(i / 500, *ROWS[min(int(i / 500 * 50) * 2, 2000)][1:]) for i in range(10001)]
        figures = self.mapped(table(slow))
        self.assertMotion(figures)
        self.assertAlmostEqual(figures["motion-rate", "left"]["value"], 50, delta=0.05)

        def changed(rows, place):
            return [(t, place(left) if i in rows else left, right) for i, (t, left, right) in enumerate(ROWS)]

        truth = self.mapped(table())
        for name, rows, lost, idle in (("glitch", changed([1000], lambda p: [v + 300 for v in p]), 1, 0.02),
                                       ("glitches", changed([10, 12, 1500], lambda p: [p[0] - 90, *p[1:]]), 3, 0.02),
                                       ("zeros", changed([700, 701, 702], lambda p: [0, 0, 0]), 3, 0.02),
                                       ("held", changed(range(500, 600), lambda p: LEFT[499]), 100, 0.2)):
            with self.subTest(name):
                figures = self.mapped(table(rows))
                self.assertMotion(figures, ("right",))
                path = figures["path-length", "left"]
                self.assertAlmostEqual(path["value"], 0.37895, delta=0.002)
                self.assertIn(f"{lost} sample", path["note"])
                self.assertAlmostEqual(path["coverage"], 1 - lost / 2000, delta=0.001)
                self.assertAlmostEqual(figures["idle-time", "left"]["value"], truth["idle-time", "left"]["value"], delta=idle)
                self.assertTrue(any("left out" in note for note in figures["notes"]), figures["notes"])
        # The file ends in the middle of its last number.
        cut = table().rstrip("\n")
        cut = cut[:cut.rindex(".") - 2]
        figures = self.mapped(cut)
        self.assertAlmostEqual(figures["path-length", "right"]["value"], 0.35624, delta=0.001)
        # Real rest stays rest.
        rest = [(i / 100, *ROWS[i if i < 400 else 400 if i < 500 else i - 100][1:]) for i in range(2101)]
        figures = self.mapped(table(rest))
        self.assertEqual(figures["notes"], [])
        self.assertAlmostEqual(figures["idle-time", "left"]["value"], truth["idle-time", "left"]["value"] + 1.0, delta=0.05)
        # A step that stays: the path of both parts, not the way between them.
        figures = self.mapped(table(changed(range(1000, 2001), lambda p: [v + 300 for v in p])))
        self.assertAlmostEqual(figures["path-length", "left"]["value"], 0.37895, delta=0.002)
        self.assertTrue(any("jump" in note for note in figures["notes"]), figures["notes"])

    MOTIVE = ("Format Version,1.23,Take Name,P1,Export Frame Rate,100.000000,Rotation Type,Quaternion,Length Units,Meters\n\n"
              ",,{0}\n,,{1}\n,,{2}\n{3}\n")

    def motive(self, left="left", right="right"):
        head = self.MOTIVE.format(",".join(["Rigid Body"] * 6 + ["Rigid Body Marker"] * 3),
                                  ",".join([left] * 3 + [right] * 3 + [f"{left}:Marker1"] * 3), ",".join(["Position"] * 9),
                                  "Frame,Time (Seconds)," + ",".join(["X,Y,Z"] * 3))
        return head + "".join(f"{i},{t:.6f}," + ",".join(f"{v / 1000:.6f}" for v in [*a, *b, 0, 0, 0]) + "\n"
                              for i, (t, a, b) in enumerate(ROWS))

    def test_motive_with_rotations(self):
        kinds = [("Rotation", axis) for axis in "XYZW"] + [("Position", axis) for axis in "XYZ"] + [("Mean Marker Error", "")]
        columns = [(name, *kind) for name in ("Left Tool", "Right Tool") for kind in kinds]
        head = self.MOTIVE.format(",".join(["Rigid Body"] * 16), ",".join(c[0] for c in columns), ",".join(c[1] for c in columns),
                                  "Frame,Time (Seconds)," + ",".join(c[2] for c in columns))
        pose = lambda p: "0,0,0,1," + ",".join(f"{v / 1000:.6f}" for v in p) + ",0.0001"
        path = self.write("m.csv", head + "".join(f"{i},{t:.6f},{pose(a)},{pose(b)}\n" for i, (t, a, b) in enumerate(ROWS)))
        self.assertMotion(self.figures(path), jerk=0.2)
        left = json.loads(self.well("import", path, "--guess").out)["left"]
        self.assertEqual(left["position"], [f"Left Tool/Position/{axis}" for axis in "XYZ"])
        self.assertEqual(len(left["quaternion"]), 4)

    def test_recognised_files(self):
        units = ",".join(["mm"] * 6)
        vicon = ("Trajectories\n100\n,,P:L_tip,,,P:R_tip,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,," + units + "\n"
                 + "".join(f"{i + 101},0," + ",".join(f"{v:.6f}" for v in [*a, *b]) + "\n" for i, (t, a, b) in enumerate(ROWS)))
        stamp = lambda t: f"{1700000000 + int(t + 1e-9)},{round((t + 1e-9) % 1 * 1e9) // 10_000_000 * 10_000_000}"
        ros = ("sec,nanosec,left.pose.position.x,left.pose.position.y,left.pose.position.z,right.pose.position.x,right.pose.position.y,"
               "right.pose.position.z\n"
               + "".join(stamp(t) + "," + ",".join(f"{v / 1000:.9f}" for v in [*a, *b]) + "\n" for t, a, b in ROWS))
        for name, text in (("Motive", self.motive()), ("Vicon", vicon), ("ROS", ros)):
            self.assertRecognised(name, text, name, jerk=0.2)

    def test_numbers_without_names_have_no_map(self):
        hand = lambda i: f"{0.01 * i:.6f} 0 0.1  1 0 0  0 1 0  0 0 1  0 0 0  0 0 0  0.5"  # place, rotation, velocities, jaw
        rows = self.write("m.txt", "".join("  ".join(4 * [hand(i)]) + "\n" for i in range(40)))
        self.refused(2, "import", rows, "--guess", names=(rows, "JIGSAWS", "leave --guess out"))
        self.refused(4, "import", self.write("n.txt", "1 2 3\n4 5 6\n"), "--guess", names=("n.txt", "76"))

    def assertRecognised(self, name, content, word, file="m.csv", jerk=0.05):
        """Read without a map, and by the map that --guess prints. @return the map"""
        with self.subTest(name):
            path = self.write(file, content)
            figures = self.figures(path)
            self.assertMotion(figures, jerk=jerk)
            self.assertIn(word, figures["notes"][0])
            guess = json.loads(self.well("import", path, "--guess").out)
            self.assertMotion(self.figures(path, "--columns", self.write("guess.json", json.dumps(guess))), jerk=jerk)
            return guess

    def sequence(self, equals, end, status=lambda i: "OK", target=("Reference", "Reference")):
        """Transforms of two tools as PLUS and Slicer write them into the header of an image."""
        pose = lambda p: f"1 0 0 {p[0]:.6f} 0 0.6 -0.8 {p[1]:.6f} 0 0.8 0.6 {p[2]:.6f} 0 0 0 1"
        lines = []
        for i, (t, a, b) in enumerate(ROWS):
            for tool, place, to in (("LeftTool", a, target[0]), ("RightTool", b, target[1])):
                lines += [f"{tool}To{to}Transform{equals}{pose(place)}", f"{tool}To{to}TransformStatus{equals}{status(i)}"]
            lines += [f"Timestamp{equals}{t:.6f}", f"ImageStatus{equals}OK"]
            lines[-6:] = [f"Seq_Frame{i:04d}_{line}" for line in lines[-6:]]
        return "\n".join(lines) + "\n" + end

    MHA = "ObjectType = Image\nNDims = 3\nDimSize = 0 0 2001\nKinds = domain domain list\n"

    def test_sequences(self):
        guess = self.assertRecognised("PLUS", (self.MHA + self.sequence(" = ", "ElementDataFile = LOCAL\n")).encode() + bytes(range(256)), "PLUS",
                                      file="m.seq.mha")
        self.assertEqual((guess["frame"], guess["length"], len(guess["left"]["matrix"])), ("plus-Reference", "mm", 9))
        self.assertRecognised("Slicer", "NRRD0004\ndimension: 3\nsizes: 0 0 2001\n" + self.sequence(":=", "\n"), "Slicer", file="m.igs.nrrd")
        lost = self.write("lost.mha", self.MHA + self.sequence(" = ", "ElementDataFile = LOCAL\n", lambda i: "INVALID" if i in LOST else "OK"))
        self.assertAlmostEqual(self.figures(lost)["path-length", "left"]["coverage"], 1 - 0.33 / 20, delta=0.001)
        mixed = self.write("mixed.mha", self.MHA + self.sequence(" = ", "ElementDataFile = LOCAL\n", target=("Tracker", "Probe")))
        self.refusedWith(2, mixed, names=("mixed.mha", "PLUS", "frame"))
        broken = self.write("broken.mha", self.MHA + self.sequence(" = ", "ElementDataFile = LOCAL\n").replace("0 0.8 0.6", "0 0.8 0.7", 1))
        self.refusedWith(4, broken, names=("broken.mha", "row 1"))

    def test_polhemus(self):
        number = lambda v: f"{v:10.5f}"
        record = lambda station, place: f"0{station} " + "".join(number(v) for v in [*(v / 25.4 for v in place), -170.25, 20.5, 0.0]) + "\r\n"
        text = "".join(record(1, b) + record(2, a) for t, a, b in ROWS)
        sensors = "marker,sensor,sample,timestamp,position_x,position_y,position_z,orientation_x,orientation_y,orientation_z\n" + "".join(
            f"0,{s},{i},{5000 + 10 * i}," + ",".join(number(v / 25.4) for v in place) + ",-170.25,20.5,0\n"
            for i, (t, a, b) in enumerate(ROWS) for s, place in ((1, b), (2, a)))
        for name, content, rate in (("fastrak.txt", text, {"rate": 100}), ("liberty.csv", sensors, {})):
            with self.subTest(name):
                path = self.write(name, content)
                self.refusedWith(2, path, names=(name, "Polhemus", "--guess"))
                guess = json.loads(self.well("import", path, "--guess").out)
                self.assertEqual(guess["?1"]["order"], "zyx")
                filled = {**{key: value for key, value in guess.items() if "?" not in key}, "length": "inch", "left": guess["?2"], "right": guess["?1"],
                          **rate}
                figures = self.figures(path, "--columns", self.write("filled.json", json.dumps(filled)))
                self.assertMotion(figures)
        self.refusedWith(4, self.write("cut.txt", text + "01   1.0\n"), "--columns", self.path("filled.json"), names=("cut.txt", "line 4003", "six numbers"))

    def test_da_vinci(self):
        kit = "timestamp (ns)," + ",".join(f"PSM{h}_{kind}_{axis}" for h in "LR" for kind, axes in (("position", "xyz"), ("orientation", "xyzw"))
                                           for axis in axes) + ",PSML_gripper_angle,PSMR_gripper_angle\n"
        kit += "".join(f"{1700000000000000000 + round(t * 1e9)}," + ",".join(",".join(f"{v / 1000:.9f}" for v in p) + ",0,0,0,1" for p in (a, b))
                       + ",0.5,-0.1\n" for t, a, b in ROWS)
        guess = self.assertRecognised("da Vinci", kit, "da Vinci", jerk=0.2)
        self.assertEqual((guess["right"]["jaw"], guess["right"]["quaternion"][0]), ("PSMR_gripper_angle", "PSMR_orientation_w"))
        # A first and a second arm are nobody's hands yet.
        numbered = self.write("arms.csv", kit.replace("PSML", "PSM1").replace("PSMR", "PSM2"))
        self.refusedWith(2, numbered, names=("arms.csv", "da Vinci", "hand"))
        self.assertEqual(json.loads(self.well("import", numbered, "--guess").out)["?2"]["position"][0], "PSM2_position_x")

    def test_jigsaws(self):
        rows = [(a, b) for t, a, b in ROWS[::3]]
        group = lambda p: [f"{v / 1000:.9f}" for v in p] + "1 0 0 0 1 0 0 0 1 0 0 0 0 0 0 0.5".split()
        numbers = [[*group(b), *group(a), *group(a), *group(b)] for a, b in rows]  # masters are elsewhere
        names = [f"{arm}_{name}" for arm in ("MTML", "MTMR", "PSML", "PSMR") for name in
                 ["position_x", "position_y", "position_z", *(f"rotation_{i}" for i in range(9)), "velocity_x", "velocity_y", "velocity_z",
                  "velocity_rot0", "velocity_rot1", "velocity_rot2", "gripper_angle"]]
        lines = [separator.join(row) for separator, row in ((s, r) for s in (" ", ",") for r in numbers)]
        text = self.figures(self.write("k.txt", "\n".join(lines[:len(rows)]) + "\n"))
        for name, content in (("commas", lines[len(rows):]), ("names", [",".join(names), *lines[len(rows):]])):
            with self.subTest(name):
                figures = self.figures(self.write("k.csv", "\n".join(content) + "\n"))
                for side in ("left", "right"):
                    self.assertEqual(figures["path-length", side]["value"], text["path-length", side]["value"])
                    self.assertEqual(figures["log-dimensionless-jerk", side]["value"], text["log-dimensionless-jerk", side]["value"])
        self.assertAlmostEqual(text["path-length", "left"]["value"], 0.379, delta=0.002)
        guess = json.loads(self.well("import", self.path("k.csv"), "--guess").out)
        self.assertEqual((guess["rate"], guess["left"]["jaw"], guess["left"]["matrix"][8]), (30, "PSML_gripper_angle", "PSML_rotation_8"))

    def demonstrations(self, name, count=1, arms=("robot0_left", "robot0_right"), arguments='{"env_kwargs": {"control_freq": 100}}'):
        """The structure of robomimic's page "robosuite Datasets"; the last demonstration is the motion."""
        path = self.path(name)
        with h5py.File(path, "w") as file:
            file.create_group("data").attrs["env_args"] = arguments
            for demo in range(count):
                obs = file.create_group(f"data/demo_{demo}/obs")
                for arm, places in zip(arms, (LEFT, RIGHT)):
                    obs[f"{arm}_eef_pos"] = numpy.array(places if demo == count - 1 else places[:50]) / 1000
                    obs[f"{arm}_eef_quat"] = numpy.tile([0.0, 0.0, 0.0, 1.0], (len(obs[f"{arm}_eef_pos"]), 1))
        return path

    def test_robomimic(self):
        one = self.demonstrations("one.hdf5")
        self.refusedWith(2, one, names=("one.hdf5", "robomimic", "length"))
        guess = json.loads(self.well("import", one, "--guess").out)
        self.assertEqual((guess["rate"], guess["left"]["quaternion"][0], guess["length"]), (100, "robot0_left_eef_quat_w", "?"))
        figures = self.figures(one, "--columns", self.write("filled.json", json.dumps({**guess, "length": "m"})))
        self.assertMotion(figures, jerk=0.2)
        several = self.demonstrations("several.hdf5", count=11)
        self.refusedWith(2, several, names=("several.hdf5", "11"))
        guess = json.loads(self.well("import", several, "--guess").out)
        columns = lambda **more: self.write("filled.json", json.dumps({**guess, "length": "m", **more}))
        self.assertMotion(self.figures(several, "--columns", columns(demonstration="demo_10")), jerk=0.2)
        guess.pop("demonstration")
        self.refusedWith(4, several, "--columns", columns(), names=("several.hdf5", "demo_0 to demo_10", '"demonstration"'))
        self.refusedWith(4, several, "--columns", columns(demonstration="demo_11"), names=("several.hdf5", "demo_11"))
        # One arm is nobody's hand yet; a rate that the file does not state.
        self.refusedWith(2, self.demonstrations("arm.hdf5", arms=("robot0",)), names=("arm.hdf5", "hand"))
        self.refusedWith(2, self.demonstrations("slow.hdf5", arguments="{}"), names=("slow.hdf5", "rate"))
        with h5py.File(self.path("bare.hdf5"), "w") as file:
            file.create_group("data/demo_0").create_dataset("states", data=[1.0])
        self.refusedWith(4, self.path("bare.hdf5"), names=("bare.hdf5", "dataset_states_to_obs"))
        whole = several.read_bytes()
        generator = random.Random(program.seeded("robomimic").random())
        for _ in range(12):
            place = generator.randrange(min(len(whole), 8192))
            self.write("bits.hdf5", whole[:place] + bytes([whole[place] ^ 1 << generator.randrange(8)]) + whole[place + 1:])
            answer = calot("import", self.path("bits.hdf5"), "--cutoff", 6, "--columns", columns(demonstration="demo_10"))
            self.assertIn(answer.code, (0, 4), answer)
        self.refusedWith(4, self.write("cut.hdf5", whole[:len(whole) // 2]), names=("cut.hdf5",))

    def test_files_that_leave_something_open(self):
        # Which body is which hand is not in the names; the tool of one port, without a clock; no units.
        ndi = "Tools,Port 1,Frame,State,Q0,Qx,Qy,Qz,Tx,Ty,Tz\n" + "".join(
            f"1,2,{i},{'MISSING' if i in LOST else 'OK'}," + (",,,,,," if i in LOST else "1,0,0,0," + ",".join(f"{v:.3f}" for v in b)) + "\n"
            for i, (t, a, b) in enumerate(ROWS))
        for text, name in ((self.motive("body 1", "body 2"), "Motive"), (ndi, "NDI"), (table(), "unit")):
            path = self.write("m.csv", text)
            self.refusedWith(2, path, names=("m.csv", name, "--guess", "--columns"))
            guess = self.write("guess.json", self.well("import", path, "--guess").out)
            self.refusedWith(4, path, "--columns", guess, names=("guess.json",))
        guess = json.loads(self.well("import", self.write("m.csv", ndi), "--guess").out)
        filled = {**{key: value for key, value in guess.items() if "?" not in key}, "rate": 100, "right": guess["?1"]}
        figures = self.figures(self.path("m.csv"), "--columns", self.write("filled.json", json.dumps(filled)))
        self.assertAlmostEqual(figures["path-length", "right"]["value"], 0.3562, delta=0.002)
        self.assertAlmostEqual(figures["path-length", "right"]["coverage"], 1 - 0.33 / 20, delta=0.001)

    def test_files_that_are_no_tables(self):
        for name, content, word in (("a.csv", b"\x89HDF\r\n\x1a\n" + bytes(99), "HDF5"), ("b.csv", b"PAR1" + bytes(99), "to_csv"),
                                    ("c.csv", b"PK\x03\x04" + bytes(99), "CSV"), ("d.csv", b"some words\nand more\n", "table")):
            self.refusedWith(4, self.write(name, content), names=(name, word))

    def test_orientations(self):
        rows = [f"{i / 100},{i * 0.3},0,0,{i % 90},0,0\n" for i in range(100)]
        text = "t,x,y,z,a,b,c\n" + "".join(rows)
        turned = {"time": {"column": "t", "unit": "s"}, "right": None}
        angles = {"position": ["x", "y", "z"], "angles": ["a", "b", "c"]}
        depth = lambda order, **more: self.mapped(text, left={**angles, "order": order}, **more, **turned)["depth-path", "left"].get("value")
        self.assertGreater(depth("yzx"), 0.005)  # the shaft leans along the way
        self.assertAlmostEqual(depth("zyx"), 0.0, places=9)  # rotates about itself: nothing along it
        self.assertAlmostEqual(depth("yzx", handed="left"), depth("yzx"), places=9)


if __name__ == "__main__":
    program.main()
