# SPDX-License-Identifier: Apache-2.0
"""Gates in pictures, where the drone is, and races in the simulator: gatefly from Python.

    import gatefly
    for gate in gatefly.detect(gatefly.read_image("photo.jpg")):
        print(gate.fitness, gate.corners_px)

One page about it: docs/python.md. Frames, signs and units: docs/conventions.md. Lengths are in metres and angles in radians
where a name does not say otherwise. What cannot be used is a gatefly.Error (a ValueError) of one line, or a TypeError.
"""
from gatefly._gatefly import (
    Camera as Camera,
    Command as Command,
    Detector as Detector,
    Error as Error,
    Estimate as Estimate,
    Fix as Fix,
    Gate as Gate,
    Image as Image,
    MapGate as MapGate,
    Pictures as Pictures,
    Race as Race,
    Replay as Replay,
    Sensors as Sensors,
    Sighting as Sighting,
    Truth as Truth,
    __version__ as __version__,
    detect as detect,
    read_image as read_image,
    replay as replay,
)

__all__ = [name for name in dir() if not name.startswith("_")]
