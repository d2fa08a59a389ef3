# SPDX-License-Identifier: GPL-3.0-or-later
"""Recordings in Python: arrays against h5py, re-simulation against what is recorded, messages against the command line's."""

import calot
import h5py
import numpy as np
import program
import recording_file


class Arrays(program.ProgramTest):
    def test_all_data_sets_are_those_of_the_file(self):
        r = calot.open(program.skilled())
        seen = 0
        with h5py.File(program.skilled(), "r") as file:
            for path, array in r.items():
                if path == "/events":
                    continue
                stored = file[path][:]
                self.assertEqual((array.dtype, array.shape, array.tobytes()), (stored.dtype, stored.shape, stored.tobytes()), path)
                self.assertFalse(array.flags.writeable)
                seen += 1
            paths = []
            file.visititems(lambda name, o: paths.append("/" + name) if isinstance(o, h5py.Dataset) else None)
            wanted = [p for p in paths if p.startswith(("/ticks", "/camera", "/observables")) or p in ("/steps/lateness", "/steps/state_digest")]
            self.assertEqual([p for p in wanted if p not in r], [])
            self.assertEqual(r.events.tobytes(), file["/events"][:].tobytes())
            self.assertEqual(list(r.keyframe_steps), list(file["/keyframes/index"]["step"]))
            self.assertEqual(r.chain_head, file["/status"][-1]["chain"].tobytes())
        self.assertGreater(seen, 60)

    def test_what_it_is(self):
        r = calot.open(program.skilled())
        self.assertEqual((r.scene, r.seed, r.duration, r.steps, r.ticks, r.outcome), ("touch-liver", 7, 5.0, 500, 5000, "stopped"))
        self.assertEqual((r.operator, r.synthetic, r.complete, r.chain_intact, r.signature), ("performer skilled", True, True, True, None))
        self.assertEqual(r.units["/ticks/left/force"], "N")
        self.assertEqual(r.units["/observables/organs/volume"], "m^3")
        self.assertEqual(r.parts("/observables/organs/volume"), ["liver", "gallbladder"])
        self.assertEqual(r.tools["left"].pose.shape, (5000, 7))
        self.assertTrue(np.array_equal(r.forces["right"], r["/ticks/right/force"]))
        self.assertTrue(np.array_equal(r.observables["left/jaw"], r["/observables/left/jaw"]))
        self.assertEqual((r.time[-1], r.step_time[-1]), (4.999, 5.0))
        self.assertEqual(set(calot.result_units()) - set(r.observables), {n for n in calot.result_units() if n.startswith(("connective/", "vessels/", "fat/"))})

    def test_beside_h5py(self):
        with h5py.File(program.skilled(), "r") as file:
            r = calot.open(program.skilled())
            self.assertEqual(r["/ticks/left/jaw"].tobytes(), file["/ticks/left/jaw"][:].tobytes())
        moment, replay = r.seek(1.0), r.replay()
        next(replay)
        with h5py.File(program.skilled(), "r") as file:
            self.assertEqual(file.attrs["seed"], 7)
            self.assertEqual(next(replay).step, 1)
        self.assertEqual(moment.step, 100)

    def test_first_format_version(self):
        file = program.SOURCE / "tests/recorder/recording/data/format-1.h5"
        r = calot.open(file)
        self.assertEqual(r.header["format_version"], 1)
        with h5py.File(file, "r") as stored:
            self.assertEqual(r["/ticks/left/force"].tobytes(), stored["/ticks/left/force"][:].tobytes())


class Replays(program.ProgramTest):
    def test_every_result_is_what_is_recorded(self):
        r = calot.open(program.skilled())
        rows = list(r.replay())
        self.assertEqual([x.step for x in rows], list(range(500)))
        for name, recorded in r.observables.items():
            self.assertEqual(np.array([x[name] for x in rows]).tobytes(), recorded.tobytes(), name)
        forces = np.concatenate([x.forces for x in rows])
        rounded = np.floor(forces / 2.0**-14 + 0.5) * 2.0**-14
        for h, hand in enumerate(("left", "right")):
            self.assertTrue(np.array_equal(rounded[:, h], r.forces[hand]))
        self.assertEqual(sum(len(x.events) for x in rows), len(r.events))

    def test_golden_digests(self):
        r = calot.open(program.SOURCE / "assets/golden/touch-liver.h5")
        digests = np.array([x.digest for x in r.replay()])
        self.assertEqual(digests.tobytes(), r["/steps/component_digest"].tobytes())
        self.assertGreater(len(digests), 100)
        with self.assertRaisesRegex(calot.InvalidError, "golden"):
            r.forces

    def test_many_steps_at_once(self):
        replay = calot.open(program.skilled()).replay()
        self.assertEqual(replay.advance(400).step, 399)
        self.assertEqual(replay.advance(400).step, 499)
        self.assertRaises(StopIteration, replay.advance, 1)

    def test_what_differs_is_the_command_lines(self):
        changed = self.copy(program.skilled())
        with h5py.File(changed, "r+") as file:
            file["/ticks/left/position"][1009, 1] += 1e-3
            recording_file.reseal(file)
        said = self.refused(3, "replay", changed)
        for again in (lambda: list(calot.open(changed).replay()), lambda: calot.replay(changed), lambda: calot.assess(changed)):
            with self.assertRaises(calot.ReplayError) as caught:
                again()
            self.assertEqual(f"calot: {caught.exception}\n", said.err)
            self.assertEqual((caught.exception.step, caught.exception.exit_code, caught.exception.file), (100, 3, str(changed)))

    def test_broken_chain(self):
        changed = self.copy(program.skilled())
        with h5py.File(changed, "r+") as file:
            file.attrs.modify("participant", np.bytes_("X"))
        said = self.refused(3, "replay", changed)
        r = calot.open(changed)
        self.assertFalse(r.chain_intact)
        seen = []
        with self.assertRaises(calot.ReplayError) as caught:
            for x in r.replay():
                seen.append(x.step)
        self.assertEqual((f"calot: {caught.exception}\n", caught.exception.step, len(seen)), (said.err, None, 500))

    def test_what_cannot_be_read(self):
        missing, text, damaged, other = self.path("none.h5"), self.path("text.h5"), self.copy(program.skilled(), "d.h5"), self.copy(program.skilled(), "o.h5")
        text.write_text("nothing\n")
        recording_file.flip_stored_byte(damaged, "/ticks/left/force", 0)
        recording_file.set_attribute(other, "simulation_version", 999)
        for file, error in ((missing, calot.DamagedError), (text, calot.DamagedError), (damaged, calot.DamagedError), (other, calot.UndecidedError)):
            said = self.refused(error.exit_code, "replay", file)
            with self.assertRaises(error) as caught:
                calot.open(file).verify()
            # The command line's line, with arguments in place of its options.
            self.assertEqual(f"calot: {caught.exception}\n", said.err.replace("--anyway repeats it all the same, and says so", "anyway=True repeats it all the same"))


class Moments(program.ProgramTest):
    def test_state_is_the_command_lines(self):
        self.well("state", program.skilled(), "--step", 321, "-o", self.path("s.h5"))
        state = calot.open(program.skilled()).moment(321).state
        with h5py.File(self.path("s.h5"), "r") as file:
            names, count = list(state), 0
            for number in sorted(file):
                file[number].visititems(lambda name, o: names_match(self, names, state, name, o) if isinstance(o, h5py.Dataset) else None)
                count += 1
            self.assertEqual(count, len(names))

    def test_backwards_and_forwards(self):
        r = calot.open(program.skilled())
        late, early, again = r.seek(4.0), r.seek(0.5), r.seek(4.0)
        self.assertEqual((late.step, early.step, again.step), (400, 50, 400))
        self.assertTrue(all(np.array_equal(late.state[n], again.state[n]) for n in late.state))
        self.assertFalse(np.array_equal(late.instruments["left"].position, early.instruments["left"].position))
        tip = r.observables["left/tip_simulated"][400]
        self.assertTrue(np.array_equal(late.instruments["left"].position, tip))
        surface = late.surfaces["liver"]
        self.assertTrue(surface.triangles.max() < len(surface.position) == len(surface.rest))
        with self.assertRaisesRegex(calot.InvalidError, "5.00 s long"):
            r.seek(5.1)
        with self.assertRaisesRegex(calot.InvalidError, "500 steps"):
            r.moment(500)

    def test_picture_is_the_command_lines(self):
        # The command line writes the mark of a synthetic attempt into the lower margin; all else is equal to the last bit.
        import struct
        import zlib
        self.well("render", program.skilled(), "--at", "2", "--size", "320x180", "--quality", "interactive", "-o", self.path("p.png"))
        picture = calot.open(program.skilled()).seek(2.0).render(320, 180, quality="interactive")
        drawn = png(self.path("p.png").read_bytes(), struct, zlib)[:, :, :3]
        self.assertEqual(drawn.shape, picture.shape)
        different = np.argwhere((drawn != picture).any(axis=2))
        self.assertGreater(len(different), 0, "the mark")
        extent = different.max(axis=0) - different.min(axis=0) + 1
        self.assertLess(extent[0], 30)
        self.assertGreater(np.ptp(picture[60:120, 100:220]), 50)

    def test_another_camera(self):
        moment = calot.open(program.skilled()).seek(1.0)
        same = calot.Camera(moment.camera.position, moment.camera.orientation, moment.camera.field_of_view)
        self.assertTrue(np.array_equal(moment.render(96, 54), moment.render(96, 54, camera=same)))
        above = calot.Camera.looking([0.0, 0.25, -0.02], [0.0, 0.0, 0.0], up=[0, 0, 1])
        free = moment.render(96, 54, camera=above, mask=False, cavity=False, alpha=True)
        self.assertTrue((free[..., 3] == 0).any() and (free[..., 3] == 255).any())
        for wrong in (dict(quality="best"), dict(camera="drone"), dict(width=4)):
            with self.assertRaises(calot.InvalidError):
                moment.render(**wrong)


def names_match(test, names, state, name, stored):
    test.assertIn(name, names)
    test.assertEqual(stored[:].tobytes(), state[name].tobytes(), name)


def png(data, struct, zlib):
    """Pixels of an 8-bit PNG with 3 or 4 channels."""
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    channels = {2: 3, 6: 4}[colour]
    assert depth == 8
    rows, stride = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels), width * channels
    out = np.zeros((height, stride), np.int64)
    for y in range(height):
        kind, line, above = rows[y, 0], rows[y, 1:].astype(np.int64), out[y - 1] if y else np.zeros(stride, np.int64)
        for x in range(stride):
            a, b, c = (out[y, x - channels] if x >= channels else 0), above[x], (above[x - channels] if x >= channels else 0)
            guess = a + b - c
            paeth = min(((abs(guess - v), i, v) for i, v in enumerate((a, b, c))))[2]
            out[y, x] = (line[x] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
    return out.reshape(height, width, channels).astype(np.uint8)


if __name__ == "__main__":
    program.main()
