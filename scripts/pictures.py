#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the documentation, as WebP in docs/pictures.

pictures.py FILE.png...             converts each (what `calot render`, screenshots.sh and tests draw); NAME.png becomes docs/pictures/NAME.webp
pictures.py --operation REC.h5      draws docs/pictures/operation.webp: the attempt in a few seconds, and beneath it its replay as it runs,
                                    verified before, with the number of steps that it has come to
Needs python3-pil; --operation needs the Python module of build/release.
"""
import argparse
import pathlib
import sys

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


def operation(file: str) -> pathlib.Path:
    """One replay, step by step: each frame is drawn from it, and its foot counts its steps."""
    sys.path.insert(0, str(ROOT / "build/release/python"))
    import calot  # the build's  # pylint: disable=import-outside-toplevel

    recording = calot.Recording(file)
    recording.verify()  # raises where anything differs
    font = ImageFont.truetype(FONT, 13)
    frames = []
    for k in range(FRAMES):
        step = round(k / (FRAMES - 1) * (recording.steps - 1))
        frame = Image.new("RGB", (SIZE[0], SIZE[1] + FOOT), "#10151a")
        frame.paste(Image.fromarray(recording.moment(step).render(*SIZE)).convert("RGB"), (0, 0))
        draw = ImageDraw.Draw(frame)
        draw.text((10, SIZE[1] + 6), f"$ calot replay {pathlib.Path(file).name}", font=font, fill="#c8d2dc")
        text = f"step {step:>6,} of {recording.steps:,}: bit-exact" if k + 1 < FRAMES else f"bit-exact: {recording.steps:,} steps and every force"
        draw.text((10, SIZE[1] + 24), text, font=font, fill="#7ee787")
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
