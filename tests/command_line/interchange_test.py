# SPDX-License-Identifier: GPL-3.0-or-later
"""Results for others: PDF, exports, bundles, and the lines of docs/how-to/reading-results.md that read them."""

import json
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile

import program
from manifest_test import motion
from program import calot, recording


def cohort_at(folder):
    """Four of each profile, recordings beside the database."""
    for profile in ("skilled", "unskilled"):
        for seed in range(4):
            made = recording(f"{profile}{seed}", "--performer", profile, "--seed", seed + 1, "--seconds", 5, "--mode", "assessment")
            shutil.copyfile(made, folder / made.name)
    answer = calot("assess", *sorted(folder.glob("*.h5")), "--cohort", folder / "c.db")
    if answer.code != 0:
        raise AssertionError(answer)
    return folder / "c.db"


def blocks(language):
    text = (program.SOURCE / "docs/how-to/reading-results.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


class Interchange(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = pathlib.Path(tempfile.mkdtemp(prefix="calot-cli-"))
        cls.addClassCleanup(shutil.rmtree, cls.made, ignore_errors=True)
        cohort_at(cls.made)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made, self.folder, dirs_exist_ok=True)
        self.database = self.folder / "c.db"
        self.study = ("study", self.database, "--group-by", "performer", "--include-synthetic")

    def test_paper(self):
        pdf, page = self.path("s.pdf"), self.path("s.html")
        self.well(*self.study, "--pdf", pdf, "--html", page)
        content = pdf.read_bytes()
        self.assertTrue(content.startswith(b"%PDF-") and content.rstrip().endswith(b"%%EOF"))
        pages = lambda paper: len(re.findall(rb"/Type /Page\b(?!s)", paper.read_bytes()))
        self.assertLessEqual(pages(pdf), 2)
        self.well(*self.study, "--all", "--pdf", self.path("all.pdf"))
        self.assertGreater(pages(self.path("all.pdf")), 2)
        self.refused(2, *self.study, "--pdf", pdf, names=(pdf, "--force"))
        self.assertEqual(pdf.read_bytes(), content)
        self.well(*self.study, "--pdf", pdf, "--force")
        self.refused(2, *self.study, "--pdf", self.path("no/where.pdf"), names=("where.pdf",))
        kinds = sqlite3.connect(self.database).execute("SELECT DISTINCT kind FROM export ORDER BY kind").fetchall()
        self.assertEqual(kinds, [("study-html",), ("study-pdf",)])
        reader = shutil.which("pdftotext")
        if reader:
            words = subprocess.run([reader, "-layout", pdf, "-"], capture_output=True, check=True).stdout.decode()
            for word in ("SYNTHETIC: made by performers", "path-length left", "skilled", "Methods.", "page 1 of"):
                self.assertIn(word, words)
        # A plain environment: no display, no settings of Qt's, a locale that writes commas.
        plain = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")}
        done = subprocess.run([program.PROGRAM, *map(str, self.study), "--pdf", self.path("t.pdf"), "--json"], env={**plain, "LC_ALL": "de_DE.UTF-8"},
                              capture_output=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        json.loads(done.stdout)

    def test_a_grade_on_paper(self):
        self.well("norm", "create", self.database, "n", "--by", "test", "--group-by", "performer", "--include-synthetic", "--rule", "at-least:1",
                  "--checkpoints", "all")
        attempt = sqlite3.connect(self.database).execute("SELECT uuid FROM attempt").fetchone()[0]
        sheet = self.path("g.pdf")
        self.well("grade", self.database, "--attempt", attempt, "--pdf", sheet)
        self.assertTrue(sheet.read_bytes().startswith(b"%PDF-"))
        self.refused(2, "grade", self.database, "--attempt", attempt, "--pdf", sheet, names=("g.pdf",))

    def test_a_named_cohort(self):
        for n, person in enumerate(("P1", "P2", "P3", "P4")):
            self.well("participant", "add", person, "--cohort", self.database, "--group", ("expert", "novice")[n % 2])
        self.well("cohort", "name", "pilot", "--cohort", self.database, "--add", "P1", "--add", "P2")
        self.refused(2, *self.study, "--cohort-name", "pilots", names=("pilots", "pilot)"))
        self.refused(3, *self.study, "--cohort-name", "pilot", names=("8", "pilot"))

    def test_tables_and_bundle(self):
        self.assertIn("checkpoint_value", self.well("cohort", "export", self.database, "-o", self.path("tables")).out)
        self.refused(2, "cohort", "export", self.database, "-o", self.path("tables"), names=(self.path("tables"),))
        self.refused(3, "cohort", "bundle", self.database, "-o", self.path("b"), names=("8", "performer"))
        self.assertFalse(self.path("b").exists())
        said = json.loads(self.well("cohort", "bundle", self.database, "-o", self.path("b"), "--include-synthetic", "--json").out)
        self.assertEqual((said["attempts"], said["participants"]), (8, 0))
        manifest = json.loads((self.path("b") / "manifest.json").read_text())
        self.assertEqual(manifest["watermark"], "SYNTHETIC")
        uuids = [row[0] for row in sqlite3.connect(self.database).execute("SELECT uuid FROM attempt")]
        for file in self.path("b").iterdir():
            for uuid in uuids:
                self.assertNotIn(uuid.encode(), file.read_bytes())

    def test_lines_that_read_results(self):
        for person in range(4):  # of whom values are analysed
            self.path("hands.txt").write_text(motion(program.seeded(f"hands {person}"), 0.001))
            self.well("participant", "add", f"P{person}", "--cohort", self.database, "--group", ("expert", "novice")[person % 2])
            self.well("import", self.path("hands.txt"), "--cohort", self.database, "--task", "reaching", "--participant", f"P{person}",
                      "--mode", "assessment", "--outcome", "completed")
        self.well(*self.study, "--csv", self.path("study"))
        self.path("study.json").write_text(self.well(*self.study, "--json").out, encoding="utf-8")
        self.well("cohort", "export", self.database, "-o", self.path("tables"))
        shutil.copyfile(next(self.folder.glob("skilled*.h5")), self.path("r.h5"))
        self.well("export", self.path("r.h5"), "--motion", self.path("motion"))
        python = blocks("python")
        self.assertEqual(len(python), 6)
        for block in python:
            self.assertLessEqual(len(block.splitlines()), 3, block)
            done = subprocess.run([sys.executable, "-c", block], cwd=self.folder, capture_output=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, b""), block)
            self.assertGreater(len(done.stdout), 20, block)
        interpreter = shutil.which("Rscript")
        ran = 0
        for block in blocks("r"):
            self.assertLessEqual(len(block.splitlines()), 3, block)
            if not interpreter:
                continue
            needs = re.findall(r"library\((\w+)\)", block)
            asked = " && ".join(f'requireNamespace("{name}", quietly = TRUE)' for name in needs) or "TRUE"
            if subprocess.run([interpreter, "-e", f"quit(status = if ({asked}) 0 else 1)"], capture_output=True, check=False).returncode != 0:
                print(f"not run, R lacks one of {needs}")
                continue
            done = subprocess.run([interpreter, "-e", block], cwd=self.folder, capture_output=True, check=False)
            self.assertEqual(done.returncode, 0, (block, done.stderr.decode()))
            ran += 1
        print(f"R: {ran} blocks run")


if __name__ == "__main__":
    program.main()
