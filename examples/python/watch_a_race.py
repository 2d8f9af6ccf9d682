#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flies a race in the simulator and says, picture by picture, what the pilot sees and believes.

usage: watch_a_race.py [TRACK] [--seed N] [--laps N] [--seconds S]
"""
import argparse

import numpy as np

import gatefly

parser = argparse.ArgumentParser()
parser.add_argument("track", nargs="?", default="oval")
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--laps", type=int)
parser.add_argument("--seconds", type=float, default=1000.0, help="of flight, at most")
arguments = parser.parse_args()

race = gatefly.Race(arguments.track, seed=arguments.seed, laps=arguments.laps)
for picture in race.pictures():
    pixels = picture.rgb()  # (height, width, 3): for matplotlib's imshow, or a network of yours
    x, y, z = race.estimate.p_EB
    error = np.linalg.norm(race.estimate.p_EB - race.truth.p_EB)
    print(f"{race.time:6.2f} s  {race.phase:9}  gate {race.target_gate}  brightness {pixels.mean():3.0f}  "
          f"{len(race.sighting.gates)} seen  at ({x:5.2f}, {y:5.2f}, {z:5.2f}) m, off by {error:.2f} m")
    if race.time > arguments.seconds:
        race.stop()

result = race.result
print(f"{result['stop_reason']}: {result['gates_passed']} of {result['gates_total']} gates in {result['flight_time_s']:.1f} s")
