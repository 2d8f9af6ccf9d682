#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The frames that `gatefly fly --frames` kept, as raw UYVY files again, to the bit (needs ffmpeg).

    ./gatefly fly oval --frames
    tools/frames_of.py out/oval-1 out/frames      # frame_00000.uyvy ...
"""
import csv
import pathlib
import subprocess
import sys

WIDTH, HEIGHT = 160, 315  # as the Bebop stores them


def frames_of(folder, width=WIDTH, height=HEIGHT):
    """Name and bytes of each frame, in the order of images.csv."""
    folder, size = pathlib.Path(folder), 2 * width * height
    # Planes, as the film has them: asked for UYVY, ffmpeg would convert the range of the colours, too.
    command = ["ffmpeg", "-v", "error", "-i", folder / "frames.mkv", "-f", "rawvideo", "-pix_fmt", "yuv422p", "-"]
    with (folder / "images.csv").open(encoding="utf-8") as table, subprocess.Popen(command, stdout=subprocess.PIPE) as film:
        for row in csv.DictReader(table):
            planes = film.stdout.read(size)
            if len(planes) != size:
                sys.exit(f"{folder / 'frames.mkv'}: ends before {row['image']}")
            frame = bytearray(size)
            frame[1::2], frame[0::4], frame[2::4] = planes[:size // 2], planes[size // 2:3 * size // 4], planes[3 * size // 4:]
            yield row["image"], bytes(frame)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    target = pathlib.Path(sys.argv[2])
    target.mkdir(parents=True, exist_ok=True)
    for name, frame in frames_of(sys.argv[1]):
        (target / name).write_bytes(frame)
