#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flies a recorded flight again by both filters and compares them with where the drone really was.

usage: replay_a_flight.py FOLDER      of `gatefly fly`, or a real flight's: log_si.csv, images.csv, pictures
"""
import sys

import numpy as np

import gatefly

if len(sys.argv) != 2:
    sys.exit(__doc__)
for estimator in ("drag", "imu15"):
    flight = gatefly.replay(sys.argv[1], estimator=estimator)
    estimates, summary = flight.estimates, flight.summary
    position = np.column_stack([estimates[name] for name in ("x_m", "y_m", "z_m")])
    fixes = np.count_nonzero(estimates["source"] != "predict")
    print(f"{estimator}: {summary['samples']} samples to {estimates['t_s'][-1]:.1f} s, {fixes} fixes, "
          f"{summary['gates_passed']} gates passed")
    if flight.rmse is not None:
        error = np.linalg.norm(position - flight.true_p_EB, axis=1)
        x, y, z = flight.rmse
        print(f"  position error: rms x {x:.2f}, y {y:.2f}, z {z:.2f} m from the first fix to the last gate; "
              f"at most {np.nanmax(error):.2f} m in all")
