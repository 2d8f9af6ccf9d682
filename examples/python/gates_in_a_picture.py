#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds the gates in pictures, and says where the drone is if it is level and flies straight at them.

usage: gates_in_a_picture.py PICTURE... [--config NAME]
"""
import argparse

import gatefly

parser = argparse.ArgumentParser()
parser.add_argument("pictures", nargs="+")
parser.add_argument("--config", help="a name in configs/ or a file: whose camera, which colours")
arguments = parser.parse_args()

detector = gatefly.Detector(arguments.config, all=True)  # once: it reads the configuration
camera = gatefly.Camera(arguments.config)
for path in arguments.pictures:
    picture = detector.read_image(path)  # or any RGB array (height, width, 3) of uint8
    gates = detector(picture)
    print(f"{path}: {picture.width} x {picture.height}, {len(gates)} gates")
    for gate in gates:
        corners = ", ".join(f"({u:.1f}, {v:.1f})" for u, v in gate.corners_px)
        print(f"  fitness {gate.fitness:.2f}, {gate.method}: {corners}")
        fix = camera.map_fix_from_corners(gate.corners_px, roll=0.0, pitch=0.0, yaw=0.0)
        if fix is not None:
            x, y, z = fix.p_GB
            print(f"    the drone is {-x:.1f} m before it, {y:+.1f} m to the right, {-z:+.1f} m above its middle")
