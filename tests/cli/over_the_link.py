#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Races that `gatefly run` flies behind a flight controller's program and `gatefly link-sim`, one seed after another, in real time; leave both cores to it.

usage: over_the_link.py GATEFLY REPOSITORY_ROOT CONTROLLER [--memory eeprom.bin | --arducopter | --px4 FAKE_BETAFLIGHT | --ts002] [--track oval] [--camera NAME] [--first-seed 4901] [--runs 10]
                        [--loss 0.02] [--reorder 0.02] [--ahead 'chrt -f 45'] [--kept FILE]
    CONTROLLER       tests/fake_betaflight_sitl; or Betaflight's simulator with --memory (tests/live/betaflight_4_5.txt); or ArduCopter's with --arducopter; or the
                     folder in which PX4 was built with --px4, and tests/fake_betaflight, which signs its drone file; with --ts002 link-sim speaks TS-002 and there is none: any word
    --kept           a file to which every race is added, a line of JSON; races that are in it are not flown again
Exit code 0: all finished and landed; 1: not.
"""
import argparse
import json
import pathlib
import shutil
import statistics
import sys
import tempfile

from simulated import ArduCopter, Px4, Simulated, Ts002, ended


def flown(drone, file, options, seed):
    limit = ["--time-limit", options.time_limit]
    trouble = ["--loss", options.loss, "--reorder", options.reorder]
    round_two = ["--second-round"] if options.second_round else []
    world = drone.world(*round_two, "--seed", seed, "--json", "--log", drone.folder / "truth.csv", *limit, *trouble)
    says = drone.folder / "run.txt"
    with says.open("w", encoding="utf-8") as heard:
        pilot = drone.run("--drone", file, "--json", *limit, "--out", drone.folder / "flight", stderr=heard)
    outcome, told = {"finished": False, "landed": False, "gates_passed": 0, "gates_total": 0, "mean_speed_mps": 0}, ""
    try:
        drone.until_it_says("handed over", world, 60, lambda: pilot.poll() is None)
        outcome = json.loads(world.communicate(timeout=options.time_limit + 120)[0])
        told = pilot.communicate(timeout=30)[0]
    except RuntimeError as error:
        outcome["stop_reason"] = f"not handed over: {error}"
    finally:
        ended(pilot)
        ended(world)
    try:
        own = json.loads(told)
        own.pop("config", None)
    except ValueError:
        own = {"said": says.read_text(encoding="utf-8")}
    return {"seed": seed, **outcome, "own": own}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("gatefly", "root", "controller"):
        parser.add_argument(name)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--memory", default="")
    kind.add_argument("--arducopter", action="store_true")
    kind.add_argument("--px4", default="")
    kind.add_argument("--ts002", action="store_true")
    parser.add_argument("--second-round", action="store_true", help="of TS-002: no ATTITUDE")
    parser.add_argument("--track", default="oval")
    parser.add_argument("--camera", default="")
    parser.add_argument("--first-seed", type=int, default=4901)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--time-limit", type=float, default=180)
    parser.add_argument("--loss", type=float, default=0)
    parser.add_argument("--reorder", type=float, default=0)
    parser.add_argument("--ahead", default="", help="words before the controller's and link-sim's programs: 'chrt -f 45', so that nothing makes them late")
    parser.add_argument("--kept")
    parser.add_argument("--drone", help="a drone.toml with a passed hand-over test; without it, one is made")
    parser.add_argument("--keep-folders", help="where the flights' folders go")
    options = parser.parse_args()
    resolved = {name: pathlib.Path(getattr(options, name)).resolve() for name in ("gatefly", "root", "controller")}
    kept = pathlib.Path(options.kept) if options.kept else None
    races = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines()] if kept and kept.exists() else []
    with tempfile.TemporaryDirectory(prefix="gatefly-over-link-") as folder:
        def controller():
            own = pathlib.Path(tempfile.mkdtemp(dir=folder))
            around = {"track": options.track, "camera": options.camera, "ahead": options.ahead.split()}
            if options.ts002:
                return Ts002(resolved["gatefly"], resolved["root"], own, **around)
            if options.px4:
                return Px4(resolved["gatefly"], resolved["root"], own, resolved["controller"], pathlib.Path(options.px4).resolve(), **around)
            if options.arducopter:
                return ArduCopter(resolved["gatefly"], resolved["root"], own, resolved["controller"], **around)
            which = {"betaflight": resolved["controller"], "memory": options.memory} if options.memory else {"fake": resolved["controller"]}
            return Simulated(resolved["gatefly"], resolved["root"], own, **which, **around)
        file = options.drone and pathlib.Path(options.drone).resolve()
        if not file:
            drone = controller()
            try:
                made, _ = drone.benched(options.first_seed)
                file = pathlib.Path(folder) / "drone.toml"
                shutil.copy(made, file)
            finally:
                drone.end()
        for seed in range(options.first_seed, options.first_seed + options.runs):
            if any(race["seed"] == seed for race in races):
                continue
            drone = controller()
            try:
                race = flown(drone, file, options, seed)
            finally:
                drone.end()
            if options.keep_folders:
                shutil.copytree(drone.folder, pathlib.Path(options.keep_folders) / str(seed), dirs_exist_ok=True)
            races.append(race)
            print(json.dumps(race), flush=True)
            if kept:
                with kept.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps(race) + "\n")
    done = [race for race in races if race["finished"] and race["landed"]]
    speed = f", {statistics.mean(race['mean_speed_mps'] for race in done):.2f} m/s in the mean" if done else ""
    print(f"{len(done)} of {len(races)} finished and landed{speed}")
    return int(len(done) < len(races))


if __name__ == "__main__":
    sys.exit(main())
