#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a flight folder of `gatefly fly` as one picture: what the drone saw, and where it flew.

    ./gatefly fly showroom --seed 1 --frames
    ./tools/flight_picture.py out/showroom-1 docs/showroom.png

Needs ffmpeg, python3-numpy and python3-matplotlib. The green outlines are what the pilot detected in flight.
"""
import csv
import math
import pathlib
import sys
import tomllib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from frames_of import frames_of

INK, TRUE, GUESS, GATE = "#22303c", "#0b7285", "#e8590c", "#f08c00"


def upright_rgb(frame, stored_width=160, stored_height=315):
    raw = np.frombuffer(frame, np.uint8).reshape(stored_height, stored_width // 2, 4).astype(float)
    y = raw[:, :, [1, 3]].reshape(stored_height, stored_width)
    u, v = np.repeat(raw[:, :, 0], 2, 1) - 128, np.repeat(raw[:, :, 2], 2, 1) - 128
    rgb = np.stack([y + 1.402 * v, y - 0.344136 * u - 0.714136 * v, y + 1.772 * u], -1)
    return np.rot90(np.clip(rgb, 0, 255).astype(np.uint8))


def detections(folder):
    rows = {}
    for row in csv.DictReader((folder / "detections.csv").open()):
        quad = [(float(row[c + "_u"]), float(row[c + "_v"])) for c in ("tl", "tr", "br", "bl")]
        rows.setdefault(row["image"], []).append(quad)
    return rows


def main(folder, picture):
    folder = pathlib.Path(folder)
    track = tomllib.loads((folder / "track.toml").read_text())
    log = np.genfromtxt(folder / "log_si.csv.gz", delimiter=",", names=True)
    images = list(csv.DictReader((folder / "images.csv").open()))
    air = [i for i in images if log["ot_z_m"][int(i["log_row"])] < -1.0]
    found = detections(folder)
    lap = [i for i in air[: len(air) // 3] if i["image"] in found]
    shown = [lap[int(k)] for k in np.linspace(0.0, 0.95, 8) * len(lap)]

    wanted = {image["image"] for image in shown}
    frames = {name: frame for name, frame in frames_of(folder) if name in wanted}

    figure = plt.figure(figsize=(12, 5.2), dpi=100)
    grid = figure.add_gridspec(4, 4, width_ratios=[2.4, 2.4, 0.35, 6.2], wspace=0.02, hspace=0.04,
                               left=0.005, right=0.99, top=0.985, bottom=0.10)
    for k, image in enumerate(shown):
        ax = figure.add_subplot(grid[k // 2, k % 2])
        ax.imshow(upright_rgb(frames[image["image"]]))
        for quad in found.get(image["image"], []):
            ax.plot(*zip(*quad, quad[0]), color="#51ff8f", lw=1.6)
        ax.text(6, 18, f"{float(image['t_s']):.1f} s", color="white", fontsize=8)
        ax.set_xlim(0, 314), ax.set_ylim(159, 0), ax.axis("off")

    ax = figure.add_subplot(grid[:, 3])
    for box in track.get("obstacles", []):
        n, e = box["position_m"]
        dx, dy = box["box_m"][:2] if "box_m" in box else (2 * box["pole_m"][0],) * 2
        ax.add_patch(plt.Rectangle((e - dy / 2, n - dx / 2), dy, dx, color="#dbe2e8"))
    for number, gate in enumerate(track["gates"], 1):
        n, e, _ = gate["position_m"]
        yaw, half = math.radians(gate["heading_deg"]), gate.get("side_m", 1.0) / 2
        across = np.array([-math.sin(yaw), math.cos(yaw)]) * half
        ax.plot([e - across[1], e + across[1]], [n - across[0], n + across[0]], color=GATE, lw=4, solid_capstyle="round")
        ax.annotate(str(number), (e, n), (7, 5), textcoords="offset points", color=INK, fontsize=9)
    ax.plot(log["ot_y_m"], log["ot_x_m"], color=TRUE, lw=1.3, label="flown")
    ax.plot(log["est_y_m"], log["est_x_m"], color=GUESS, lw=0.7, alpha=0.8, label="what the pilot believed")
    ax.set_aspect("equal"), ax.set_xlabel("east [m]"), ax.set_ylabel("north [m]")
    ax.legend(frameon=False, fontsize=8, loc="upper left"), ax.grid(alpha=0.25)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    figure.savefig(picture)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
