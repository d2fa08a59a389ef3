# SPDX-License-Identifier: GPL-3.0-or-later
"""calot render: a picture of the size asked for, with something in it, the same each time, of the moment asked for."""

import struct
import zlib

import numpy as np
import program
from program import short, skilled


def pixels(path):
    """An 8-bit RGB or RGBA picture without interlace as an array (PNG specification, W3C, second edition)."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body)
        header = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else header
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    width, height, depth, colour, _, _, interlace = header
    assert depth == 8 and colour in (2, 6) and interlace == 0
    channels = 3 if colour == 2 else 4
    raw = zlib.decompress(packed)
    rows = np.zeros((height, width * channels), dtype=np.uint8)
    before = np.zeros(width * channels, dtype=np.int32)
    for y in range(height):
        start = y * (width * channels + 1)
        kind = raw[start]
        line = np.frombuffer(raw, np.uint8, width * channels, start + 1).astype(np.int32)
        if kind == 2:
            line = (line + before) & 255
        elif kind != 0:
            for x in range(width * channels):
                left = line[x - channels] if x >= channels else 0
                corner = before[x - channels] if x >= channels else 0
                up = before[x]
                guess = left + up - corner
                nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
                line[x] = (line[x] + {1: left, 3: (left + up) // 2, 4: nearest}[kind]) & 255
        rows[y] = before = line
    return rows.reshape(height, width, channels)[:, :, :3]


class Pictures(program.ProgramTest):
    def picture(self, name, *more, recording=None):
        self.well("render", recording or skilled(), "-o", self.path(name), *more)
        return self.path(name)

    def test_size_and_content(self):
        image = pixels(self.picture("a.png", "--size", "160x90", "--at", "3.5"))
        self.assertEqual(image.shape, (90, 160, 3))
        flat = image.reshape(-1, 3).astype(int)
        self.assertGreater(len(np.unique(flat, axis=0)), 300)
        self.assertGreater(flat.std(axis=0).min(), 8)
        # Liver: redder than green and blue over a good part of the picture.
        red = (flat[:, 0] > 1.3 * flat[:, 1]) & (flat[:, 0] > 1.3 * flat[:, 2]) & (flat[:, 0] > 40)
        self.assertGreater(red.mean(), 0.1)
        # Instruments: grey, lighter than the shadow.
        grey = (np.ptp(flat, axis=1) < 25) & (flat.mean(axis=1) > 60)
        self.assertGreater(grey.mean(), 0.005)

    def test_same_moment_same_picture_another_moment_another(self):
        a, b = self.picture("a.png", "--size", "160x90", "--at", "2"), self.picture("b.png", "--size", "160x90", "--at", "0:02")
        c = self.picture("c.png", "--size", "160x90", "--at", "4s")
        self.assertEqual(a.read_bytes(), b.read_bytes())
        self.assertNotEqual(a.read_bytes(), c.read_bytes())

    def test_ends_of_the_recording(self):
        for time in ("0", "0.5"):
            self.assertTrue(self.picture(f"{time}.png", "--size", "64x48", "--at", time, recording=short()).exists())

    def test_refused(self):
        o = self.path("o.png")
        for arguments in (["--at", "0.51"], ["--at", "-1"], ["--at", "nan"], ["--at", "soon"], ["--at", "1:2:3"], ["--at", ""], ["--size", "0x10"],
                          ["--size", "640"], ["--size", "640x"], ["--size", "-64x48"], ["--size", "1000000x1000000"], ["--size", "64x48x3"],
                          ["--size", "99999999999x1"]):
            with self.subTest(" ".join(arguments)):
                self.refused(2, "render", short(), "-o", o, *arguments)
                self.assertEqual(list(self.folder.iterdir()), [])


class Films(program.ProgramTest):
    def film(self, name, *more, recording=None):
        return self.well("render", recording or short(), "-o", self.path(name), "--size", "64x48", *more)

    def test_frames(self):
        # 0.5 s at 25 frames a second: 12.5 frames' time, so the thirteenth begins before the end.
        self.assertIn("13 frames, 0.52 s", self.film("a.mp4").out)
        self.assertEqual(self.path("a.mp4").read_bytes()[4:8], b"ftyp")
        self.assertIn("3 frames", self.film("c.mkv", "--from", "0.1", "--to", "0.4", "--speed", "2", "--fps", "20").out)
        self.assertEqual(self.path("c.mkv").read_bytes()[:4], b"\x1a\x45\xdf\xa3")
        self.assertEqual(len(list(self.folder.iterdir())), 2)

    def test_overlays_and_two_side_by_side(self):
        self.film("plain.mp4", "--to", "0.2")
        for name, more in (("told.mp4", ["--overlay", "time,phase,checkpoints,events,tools"]), ("two.mp4", ["--beside", short()])):
            self.film(name, "--to", "0.2", *more)
            self.assertNotEqual(self.path(name).read_bytes(), self.path("plain.mp4").read_bytes())

    def test_a_performer_is_marked_synthetic(self):
        self.well("render", short(), "-o", self.path("a.png"), "--size", "640x360")
        corner = pixels(self.path("a.png"))[-40:, -240:].astype(int)
        letters = (np.ptp(corner, axis=2) < 12) & (corner.mean(axis=2) > 120)
        self.assertGreater(letters.sum(), 150)

    def test_refused(self):
        film, picture = self.path("o.mp4"), self.path("o.png")
        for output, arguments in ((film, ["--at", "0.1"]), (picture, ["--from", "0.1"]), (picture, ["--to", "0.1"]), (film, ["--size", "65x48"]),
                                  (film, ["--fps", "0"]), (film, ["--fps", "121"]), (film, ["--speed", "0"]), (film, ["--speed", "nan"]),
                                  (film, ["--from", "0.3", "--to", "0.3"]), (film, ["--to", "0.51"]), (film, ["--overlay", "clock"]),
                                  (film, ["--overlay", ""]), (film, ["--align", "phase"]), (film, ["--quality", "best"]),
                                  (film, ["--beside", short(), "--size", "66x48"])):
            with self.subTest(" ".join(map(str, arguments))):
                self.refused(2, "render", short(), "-o", output, *arguments)
                self.assertEqual(list(self.folder.iterdir()), [])
        film.write_bytes(b"mine")
        self.refused(2, "render", short(), "-o", film)
        self.assertEqual(film.read_bytes(), b"mine")


if __name__ == "__main__":
    program.main()
