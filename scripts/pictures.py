#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the documentation, as WebP in docs/pictures.

pictures.py FILE.png...             converts each (what `calot render`, screenshots.sh and tests draw); NAME.png becomes docs/pictures/NAME.webp
pictures.py --operation REC.h5      draws docs/pictures/operation.webp: the attempt in a few seconds, and beneath it its replay as it runs,
                                    with the number of steps whose digests are equal to the recorded ones
Needs python3-pil; --operation needs build/release/bin/calot (or CALOT_PROGRAM).
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw, ImageFont

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/pictures"
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf"
FRAMES, SECONDS = 48, 8.0
SIZE, FOOT = (640, 360), 44
LIMIT = 2_000_000  # bytes


def convert(file: pathlib.Path) -> pathlib.Path:
    out = PICTURES / (file.stem + ".webp")
    Image.open(file).save(out, quality=88, method=6)
    return out


def calot(*words: str) -> str:
    program = os.environ.get("CALOT_PROGRAM", str(ROOT / "build/release/bin/calot"))
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"pictures: {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def operation(recording: str) -> pathlib.Path:
    """The replay is done once, whole, before a frame is drawn: the foot counts what it compared."""
    replayed = json.loads(calot("replay", recording, "--json"))["recordings"][0]
    if replayed["verdict"] != "exact":
        sys.exit(f"pictures: {recording}: {replayed['verdict']}")
    steps = replayed["steps"]
    seconds = json.loads(calot("inspect", recording, "--json"))["seconds"]
    font = ImageFont.truetype(FONT, 13)
    frames = []
    with tempfile.TemporaryDirectory() as folder:
        for k in range(FRAMES):
            share = k / (FRAMES - 1)
            file = f"{folder}/{k}.png"
            calot("render", recording, "--at", f"{share * seconds * 0.995:.3f}", "--size", f"{SIZE[0]}x{SIZE[1]}", "--overlay", "time,phase", "-o", file)
            frame = Image.new("RGB", (SIZE[0], SIZE[1] + FOOT), "#10151a")
            frame.paste(Image.open(file).convert("RGB"), (0, 0))
            draw = ImageDraw.Draw(frame)
            done = round(share * steps)
            draw.text((10, SIZE[1] + 6), f"$ calot replay {pathlib.Path(recording).name}", font=font, fill="#c8d2dc")
            verdict = f"step {done:>7,} of {steps:,}: same bits" if k + 1 < FRAMES else f"{steps:,} steps and every force: same bits"
            draw.text((10, SIZE[1] + 24), verdict, font=font, fill="#7ee787")
            frames.append(frame)
    out = PICTURES / "operation.webp"
    for quality in (70, 55, 40, 25):
        pause = round(1000 * SECONDS / FRAMES)
        frames[0].save(out, save_all=True, append_images=frames[1:], duration=[pause] * (FRAMES - 1) + [2000], loop=0, quality=quality, method=6)
        if out.stat().st_size <= LIMIT:
            return out
    sys.exit(f"pictures: {out} has {out.stat().st_size} bytes, more than {LIMIT}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", type=pathlib.Path, metavar="FILE.png")
    parser.add_argument("--operation", metavar="RECORDING")
    arguments = parser.parse_args()
    for file in arguments.files:
        print(convert(file))
    if arguments.operation:
        print(operation(arguments.operation))


if __name__ == "__main__":
    main()
