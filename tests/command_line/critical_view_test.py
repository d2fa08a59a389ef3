# SPDX-License-Identifier: GPL-3.0-or-later
"""The rated critical view: doublets of recordings in a pack, their answers, and the agreement of computed and rated view as a study."""

import json
import re
import sqlite3
import struct
from contextlib import closing

import program

# The performer sets its first clip in the sixth second or soon after.
SCORES = ((2, 2, 2), (2, 2, 1), (2, 1, 1))  # of the three attempts that set a clip, by order of their uuids


_made = {}


def clipping(test, seed, seconds=8):
    """Made once for all tests."""
    if seed not in _made:
        file = program.short().with_name(f"clipping{seed}.h5")
        test.well("record", "--scene", "clip-and-cut", "--performer", "skilled", "--seed", seed, "--seconds", seconds, "--mode", "assessment", "-o", file)
        _made[seed] = file
    return _made[seed]


class Doublets(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.cohort, self.pack, self.films = self.path("c.db"), self.path("pack"), self.path("films")
        self.films.mkdir()
        for file in (clipping(self, 1), clipping(self, 2), clipping(self, 3), clipping(self, 4, 2)):
            (self.films / file.name).write_bytes(file.read_bytes())
        self.well("assess", *sorted(self.films.iterdir()), "--cohort", self.cohort)
        with closing(sqlite3.connect(self.cohort)) as database:
            self.computed = dict(database.execute("SELECT a.uuid, v.value FROM attempt a JOIN checkpoint_value v ON v.attempt = a.id "
                                                  "WHERE v.name = 'critical-view' AND v.value IS NOT NULL ORDER BY a.uuid"))

    def data(self, rater):
        return json.loads(re.search(r'id="data">(.*?)</script>', (self.pack / rater / "rate.html").read_text()).group(1))

    def test_from_recordings_to_agreement(self):
        self.assertEqual(len(self.computed), 3, "the fourth sets no clip in two seconds")
        said = self.well("rate", "pack", self.cohort, "--form", "doublet-view", "--films", self.films, "--raters", "R1,R2", "-o", self.pack).out
        self.assertIn("3 doublets for 2 raters", said)
        with closing(sqlite3.connect(self.cohort)) as database:
            attempt_of = dict(database.execute("SELECT name, a.uuid FROM rating_pack_film f JOIN attempt a ON a.id = f.attempt"))
        score_of = dict(zip(self.computed, SCORES))
        for rater in ("R1", "R2"):
            data = self.data(rater)
            self.assertEqual((data["doublets"], data["least"], data["most"], len(data["items"])), (True, 0, 2, 3))
            self.assertTrue(all(len(item["anchors"]) == 3 for item in data["items"]))
            pictures = [self.pack / rater / "films" / f"{name}.png" for name in data["films"]]
            self.assertEqual(sorted(pictures), sorted((self.pack / rater / "films").iterdir()))
            for picture in pictures:
                content = picture.read_bytes()
                self.assertEqual(struct.unpack(">II", content[16:24]), (1600, 600))
                self.assertGreater(len(content), 100000, "something is to be seen")
            films = [{"film": f, "scores": {item["key"]: str(s) for item, s in zip(data["items"], score_of[attempt_of[f]])}} for f in data["films"]]
            answers = {"format": "calot-answers", "formatVersion": 1, "pack": data["pack"], "rater": rater, "films": films}
            self.path("answers.json").write_text(json.dumps(answers))
            self.well("rate", self.cohort, "--take", self.path("answers.json"))
        said = json.loads(self.well("study", self.cohort, "--design", "agreement", "--family", "critical-view", "--against", "rating doublet-view sum",
                                    "--include-synthetic", "--json").out)
        result = said["results"][0]
        differences = [self.computed[uuid] - sum(scores) for uuid, scores in score_of.items()]
        self.assertEqual((result["pairs"], result["first"], result["second"]), (3, "critical-view", "rating doublet-view sum"))
        self.assertAlmostEqual(result["bias"], sum(differences) / 3, delta=1e-12)

    def test_a_form_of_doublets_wants_recordings(self):
        self.refused(4, "rate", "pack", self.cohort, "--form", "doublet-view", "--films", self.path("empty"), "--raters", "R1", "-o", self.pack,
                     names=("empty",))


if __name__ == "__main__":
    program.main()
