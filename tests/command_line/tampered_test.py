# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings that were changed, damaged, cut off or made by another simulation: what each is told to be."""

import hashlib
import json
import re

import h5py
import numpy as np
import program
import recording_file
from program import calot, short, skilled


class Changed(program.ProgramTest):
    def test_pose(self):
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            file["/ticks/right/position"][1239, 2] += 2e-5
        answer = self.refused(3, "replay", r, names=(r, "step 123", "hand.right.input", "reproducible", "chain broken"))
        self.assertEqual(answer.out, "")

    def test_pose_with_the_chain_made_to_fit(self):
        # Whoever can compute digests can make the chain fit; the simulation itself still differs.
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            file["/ticks/right/position"][1239, 2] += 2e-5
            recording_file.reseal(file)
        answer = self.refused(3, "replay", r, names=(r, "step 123", "hand.right.input"))
        self.assertNotIn("chain", answer.err)

    def test_pose_at_a_tick_that_moves_nothing(self):
        # A step moves to its last tick's pose; those before it are felt by the haptic tick alone, and only in contact. The
        # digest of the step's inputs shows them all the same.
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            self.assertFalse(file["/ticks/right/force"][:300].any())
            file["/ticks/right/position"][234, 2] += 2e-5
        self.refused(3, "replay", r, names=(r, "step 23", "hand.right.input samples", "chain broken"))

    def test_force(self):
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            force = file["/ticks/left/force"]
            tick = int(np.flatnonzero(np.abs(force[:]).sum(axis=1))[5])
            was = force[tick, 1]
            force[tick, 1] = 0.123456789  # off the grid of what is stored
        answer = self.refused(3, "replay", r, names=(r, f"step {tick // 10}, tick {tick}", "force.left", "force[1]", "0.123456789"))
        here = re.search(r"here (-?[\d.e+-]+)", answer.err)
        self.assertEqual(float(here[1].rstrip(".")), was)

    def test_observable_event_digest_keyframe(self):
        changes = {
            "observables": ("/observables/organs/volume", lambda d: d.__setitem__((57, 0), d[57, 0] * (1 + 1e-15)), ("step 57", "volume")),
            "digest": ("/steps/state_digest", lambda d: d.__setitem__(58, d[58] ^ np.uint64(1)), ("step 58",)),
            "field": ("/steps/field_digest", lambda d: d.__setitem__((59, 3), d[59, 3] ^ np.uint16(1)), ("step 59",)),
            "keyframe": ("/keyframes/bytes", lambda d: d.__setitem__(1000, d[1000] ^ np.uint64(2)), ("keyframe", "index")),
        }
        for name, (dataset, change, words) in changes.items():
            with self.subTest(name):
                r = self.copy(skilled())
                with h5py.File(r, "r+") as file:
                    change(file[dataset])
                    recording_file.reseal(file)
                self.refused(3, "replay", r, names=(r, *words))
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            event = file["/events"][0]
            event["value"] += 1.0
            file["/events"][0] = event
            recording_file.reseal(file)
        self.refused(3, "replay", r, names=(r, f"step {event['step']}", "events", "value"))

    def test_attribute_and_status(self):
        r = self.copy(short())
        with h5py.File(r, "r+") as file:
            recording_file.put_attribute(file, "participant", b"Q")
        self.refused(3, "replay", r, names=(r, "chain"))
        self.refused(3, "inspect", r, names=(r, "chain"))
        self.assertEqual(json.loads(calot("inspect", "--json", r).out)["chain"], "broken")

    def test_state_names_index_and_values(self):
        r = self.copy(skilled())
        with h5py.File(r, "r+") as file:
            file["/ticks/right/position"][1239, 2] += 2e-5
        for name, source in (("a", skilled()), ("b", r)):
            self.well("state", source, "--step", 123, "-o", self.path(name + ".h5"))
        answer = calot("diff", self.path("a.h5"), self.path("b.h5"))
        self.assertEqual(answer.code, 3, answer)
        self.assertRegex(answer.out, r"^hand\.right\.\w+/\w+ index \d+: \S+ and \S+\n$")


class Damaged(program.ProgramTest):
    def test_byte_of_a_stored_chunk(self):
        for dataset in ("/ticks/left/position", "/ticks/right/force", "/camera/orientation", "/steps/state_digest",
                        "/observables/organs/volume", "/events", "/keyframes/bytes", "/status", "/scene/description"):
            with self.subTest(dataset):
                r = self.copy(skilled())
                recording_file.flip_stored_byte(r, dataset, 0 if dataset in ("/events", "/scene/description") else 3)
                answer = self.refused(4, "replay", r, names=(r, dataset))
                self.assertEqual(answer.out, "")

    def test_flipped_anywhere(self):
        # Wherever a bit turns: an answer in one line, never a crash. Slack bytes belong to nobody, hence 0.
        draw = program.seeded("flipped anywhere")
        content = bytearray(short().read_bytes())
        r = self.path("r.h5")
        seen = {}
        for _ in range(60 if program.HEAVY else 12):
            at, bit = draw.randrange(len(content)), 1 << draw.randrange(8)
            changed = bytearray(content)
            changed[at] ^= bit
            r.write_bytes(changed)
            answer = calot("replay", r)
            with self.subTest(byte=at, bit=bit):
                self.assertIn(answer.code, (0, 3, 4), answer)
                if answer.code != 0:
                    self.assertOneLine(answer, r)
            seen[answer.code] = seen.get(answer.code, 0) + 1
        self.assertGreater(seen.get(4, 0), 0, seen)

    def test_values_that_cannot_be(self):
        for name, dataset, value in (("not a number", "/ticks/left/position", np.nan), ("infinite", "/ticks/right/jaw", np.inf),
                                     ("no unit quaternion", "/ticks/left/orientation", 0.9), ("no instrument", "/ticks/left/instrument", 9),
                                     ("camera", "/camera/position", np.nan), ("camera's quaternion", "/camera/orientation", 2.0),
                                     ("valid", "/ticks/left/valid", 7)):
            with self.subTest(name):
                r = self.copy(short())
                with h5py.File(r, "r+") as file:
                    data = file[dataset]
                    data[(77, 0) if data.ndim == 2 else 77] = value
                    recording_file.reseal(file)
                self.refused(4, "replay", r, names=(r, dataset))

    def test_missing_and_misshapen(self):
        def gone(file):
            del file["/ticks/left/force"]

        def other_type(file):
            del file["/steps/field_digest"]
            file["/steps/field_digest"] = np.zeros((50, 3))

        def too_short(file):
            file["/ticks/left/jaw"].resize(10, axis=0)

        for change, name in ((gone, "/ticks/left/force"), (other_type, "/steps/field_digest"), (too_short, "/ticks/left/jaw")):
            with self.subTest(change.__name__):
                r = self.copy(short())
                with h5py.File(r, "r+") as file:
                    change(file)
                self.refused(4, "replay", r, names=(r, name))

    def test_scene_that_cannot_be_built(self):
        r = self.copy(short())
        with h5py.File(r, "r+") as file:
            text = file["/scene/description"]
            text[:] = np.frombuffer(text[:].tobytes().replace(b'"tetrahedra"', b'"tetraeders"'), dtype="u1")
            recording_file.put_attribute(text, "sha256", hashlib.sha256(text[:].tobytes()).hexdigest().encode())
            recording_file.reseal(file)
        self.refused(4, "replay", r, names=(r,))

    def test_cut_in_half_and_recovered(self):
        r = self.path("half.h5")
        whole = skilled().read_bytes()
        for share in (0.5, 0.75, 0.95):
            with self.subTest(share=share):
                r.write_bytes(whole[: int(len(whole) * share)])
                self.refused(4, "replay", r, names=(r,))
                out = self.path(f"saved-{share}.h5")
                answer = self.well("recover", r, "-o", out)
                saved = int(re.search(r"(\d+) steps", answer.out)[1])
                self.assertIn("incomplete", answer.out)
                self.assertIn("the rest is lost", answer.out)
                # Half the bytes are about half the time, and the head of the file is the scene.
                self.assertGreater(saved, 500 * (share - 0.35), answer)
                self.assertIn(f"bit-exact, incomplete, {saved / 100:.2f} s ({saved} steps)", self.well("replay", out).out)
                with h5py.File(out, "r") as b, h5py.File(skilled(), "r") as a:
                    self.assertEqual(b.attrs["attempt_uuid"], a.attrs["attempt_uuid"])
                    rows = len(b["/status"])
                    self.assertEqual(a["/status"][: rows]["chain"].tobytes(), b["/status"][:]["chain"].tobytes())
                self.assertEqual(r.read_bytes(), whole[: int(len(whole) * share)], "the input was changed")
        self.assertNothingHalfWritten()

    def test_nothing_left_to_save(self):
        r = self.path("r.h5")
        r.write_bytes(short().read_bytes()[:3000])
        self.refused(4, "recover", r, "-o", self.path("o.h5"), names=(r,))
        self.assertFalse(self.path("o.h5").exists())

    def test_recovered_whole_is_the_same_attempt(self):
        self.well("recover", short(), "-o", self.path("o.h5"))
        with h5py.File(short(), "r") as a, h5py.File(self.path("o.h5"), "r") as b:
            self.assertEqual(a["/status"][-1]["chain"].tobytes(), b["/status"][-1]["chain"].tobytes())
            self.assertEqual(b["/status"][-1]["completed"], 1)
        self.assertNotIn("incomplete", self.well("replay", self.path("o.h5")).out)


class OtherVersion(program.ProgramTest):
    def test_cannot_be_decided(self):
        r = self.copy(short())
        recording_file.set_attribute(r, "simulation_version", 999)
        self.refused(5, "replay", r, names=(r, "999"))
        answer = self.refused(5, "replay", "--anyway", r, names=(r, "999"))
        self.assertIn("bit-exact", answer.err)  # it was replayed, and the version is all that differs
        self.assertRegex(self.well("inspect", r).out, r"(?m)^ *simulation_version +999$")

    def test_anyway_reports_the_difference(self):
        r = self.copy(short())
        with h5py.File(r, "r+") as file:
            file["/ticks/left/position"][109, 1] += 1e-4
        recording_file.set_attribute(r, "simulation_version", 999)
        self.refused(5, "replay", "--anyway", r, names=(r, "999", "step 10"))

    def test_broken_chain_goes_before(self):
        r = self.copy(short())
        with h5py.File(r, "r+") as file:
            recording_file.put_attribute(file, "simulation_version", 999)
        self.refused(3, "replay", r, names=(r, "chain"))

    def test_format_of_the_future(self):
        r = self.copy(short())
        recording_file.set_attribute(r, "format_version", 3)
        self.refused(4, "replay", r, names=(r, "format_version"))


if __name__ == "__main__":
    program.main()
