#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the small flight that tests/replay ships out of one that `gatefly fly` recorded: the first seconds, IMU and heights
as they are, the true position now and then, every third picture as a JPEG (needs ffmpeg).

    ./gatefly fly oval --laps 1 --seed 1 --frames
    tools/golden_flight.py out/oval-1 tests/replay/oval_flight
    GATEFLY_RENEW_TRACES=1 ctest --preset release -R replay      # then look at what changed
"""
import csv
import gzip
import pathlib
import shutil
import subprocess
import sys

from frames_of import frames_of

SECONDS, EVERY_PICTURE, TRUTH_EVERY = 8.0, 3, 26
GYRO = ["gyro_p_radps", "gyro_q_radps", "gyro_r_radps"]
ACCEL = ["acc_x_mps2", "acc_y_mps2", "acc_z_mps2"]
TRUTH = ["ot_x_m", "ot_y_m", "ot_z_m"]


def short(text, digits):
    return f"{float(text):.{digits}f}".rstrip("0").rstrip(".") if text else ""


def make(source, target):
    target.mkdir(parents=True, exist_ok=True)
    for old in target.glob("img_*.jpg"):
        old.unlink()
    for name in ("track.toml", "config-0.toml", "settings.txt"):
        shutil.copy(source / name, target / name)
    rows = [row for row in csv.DictReader(gzip.open(source / "log_si.csv.gz", "rt")) if float(row["t_s"]) < SECONDS]
    with (target / "log_si.csv").open("w") as log:
        log.write(",".join(["t_ns", *GYRO, *ACCEL, "sonar_m", "baro_m", *TRUTH]) + "\n")
        for i, row in enumerate(rows):
            # The sensor's own steps: 1/4096 rad/s and 1/1024 m/s².
            cells = [row["t_ns"], *(short(row[k], 6) for k in GYRO), *(short(row[k], 5) for k in ACCEL),
                     short(row["sonar_m"], 3), short(row["baro_m"], 3),
                     *(short(row[k], 4) if i % TRUTH_EVERY == 0 else "" for k in TRUTH)]
            log.write(",".join(cells) + "\n")
    pictures = [row for row in csv.DictReader((source / "images.csv").open()) if int(row["log_row"]) < len(rows)][::EVERY_PICTURE]
    frames = dict(frames_of(source))
    with (target / "images.csv").open("w") as images:
        images.write("image,log_row,t_ns\n")
        for i, picture in enumerate(pictures):
            name = f"img_{i:05}.jpg"
            # Full range in and out: the values stay as the camera has them.
            subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-color_range", "pc", "-pixel_format", "uyvy422", "-video_size", "160x315",
                            "-i", "-", "-pix_fmt", "yuvj422p", "-q:v", "3", target / name], input=frames[picture["image"]], check=True)
            images.write(f"{name},{picture['log_row']},{picture['t_ns']}\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    make(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
