# SPDX-License-Identifier: Apache-2.0
"""A drone in a simulator, as `gatefly run` and `bench-drone` have one: a flight controller that runs as a program, and `gatefly link-sim` around it. The
controller is a fake that behaves like Betaflight 4.4.3 (tests/support/fake_betaflight_sitl.cpp), or Betaflight's own simulator target, set up as
tests/live/betaflight_4_5.txt says; or ArduCopter's or PX4's; or none, where link-sim speaks TS-002 itself.
"""
import contextlib
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

DRONE = ["--config", "archer-b2", "--config", "betaflight"]
PORTS = ("servos", "state", "radio", "pictures", "controller", "msp")
BETAFLIGHTS_OWN = {"servos": 9001, "state": 9003, "radio": 9004, "controller": 5761}


def free_ports(count, kind):
    sockets = [socket.socket(socket.AF_INET, kind) for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def camera_words(camera):
    return ["--config", camera] if camera else []


def ended(process):
    if process.poll() is None:
        process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream:
            stream.close()


def flown_and_landed(test, world, pilot):
    """Waits for link-sim and run, both with --json, and expects that they finished, landed, and agree. @return link-sim's outcome and run's."""
    told, heard = world.communicate(timeout=120)
    outcome = json.loads(told)
    told, said = pilot.communicate(timeout=20)
    flown = json.loads(told)
    everything = f"{outcome}\n{heard}\n{said}"
    test.assertTrue(outcome["finished"] and outcome["landed"], everything)
    test.assertEqual(flown["gates_passed"], outcome["gates_passed"])
    test.assertLess(flown["sticks"]["longest_gap_ms"], 50)
    return outcome, flown


def flies_a_lap(test, drone, file):
    """link-sim around the drone, and run, which flies it by that drone.toml: a lap of the oval, down to the floor."""
    world = drone.world("--laps", "1", "--seed", "1001", "--json", "--time-limit", "60")
    test.addCleanup(ended, world)
    pilot = drone.run("--laps", "1", "--drone", file, "--json")
    test.addCleanup(ended, pilot)
    flown_and_landed(test, world, pilot)


class Simulated:
    """A controller, and the ports of everything around it.

    told: what no controller knows, found by flying it: the throttle stick at which it hovers, the exponent of thrust over throttle.
    """

    def __init__(self, gatefly, root, folder, fake="", betaflight="", memory="", track="oval", camera="", ahead=()):
        """fake: the fake's program. betaflight: instead, Betaflight's, with the memory (eeprom.bin) that it was set up in. camera: a name in cameras/, if not
        the vehicle's own. ahead: words before the controller's and link-sim's programs, e.g. `chrt -f 45`: a flight controller is never late."""
        self._around(gatefly, root, folder, track, camera, ahead)
        self.configs = [*DRONE, *camera_words(camera)]
        if betaflight:
            self.ports.update(BETAFLIGHTS_OWN)
            shutil.copy(memory, self.folder / "eeprom.bin")
            self.betaflight = betaflight
            self._start_betaflight()
            self.told = ["--hover-stick-us", "1257", "--exponent", "1.66"]
        else:
            self.controller = self.start(*ahead, fake, *(word for name in ("servos", "state", "radio") for word in (f"--{name}", self.ports[name])),
                                         "--msp", self.ports["controller"], stderr=subprocess.DEVNULL)
            self.told = ["--hover-stick-us", "1273", "--exponent", "1.73"]
            self.controller.stdout.readline()
        self.link = ["--link", f"msp:tcp:127.0.0.1:{self.ports['msp']}"]

    def _around(self, gatefly, root, folder, track, camera, ahead):
        self.gatefly, self.root, self.folder, self.track = gatefly, pathlib.Path(root), pathlib.Path(folder), track
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"), GATEFLY_SOURCE_DIR=str(root))
        self.ports = dict(zip(PORTS, free_ports(4, socket.SOCK_DGRAM) + free_ports(2, socket.SOCK_STREAM)))
        self.camera = ["--camera", f"udp-jpeg:{self.ports['pictures']}"]
        self.world_words, self.ahead = [], ahead

    def _start_betaflight(self):
        with open(self.folder / "controller.txt", "a", encoding="utf-8") as says:
            self.controller = self.start(*self.ahead, self.betaflight, stdout=says, stderr=says)
        time.sleep(1)

    def start(self, *words, **more):
        streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
        return subprocess.Popen([str(word) for word in words], cwd=self.folder, text=True, env=self.environment, **streams)

    def world(self, *words, **more):
        """link-sim around the controller, once it is ready. One start of Betaflight's program in ten tells no motors, nor answers: it is started again."""
        for _ in range(2 if hasattr(self, "betaflight") else 0):
            try:
                return self._world(*words, **more)
            except RuntimeError as error:
                if "no flight controller tells motors" not in str(error):
                    raise
                ended(self.controller)
                self._start_betaflight()
        return self._world(*words, **more)

    def _world(self, *words, **more):
        ports = [word for name in PORTS for word in (f"--{name}", self.ports[name])]
        with open(self.folder / "world.txt", "w", encoding="utf-8") as says:
            process = self.start(*self.ahead, self.gatefly, "link-sim", self.track, *self.configs, *self.world_words, "--set", "sim.camera_quality=fast", *ports, *words, stderr=says, **more)
        try:
            self.until_it_says("ready", process, 60)
        except RuntimeError:
            ended(process)
            raise
        return process

    def end(self):
        """Ends the controller."""
        ended(self.controller)

    def heard(self):
        """All that link-sim has said so far."""
        return (self.folder / "world.txt").read_text(encoding="utf-8")

    def until_it_says(self, what, process, seconds, meanwhile=lambda: True):
        """Waits until link-sim has said that. meanwhile: what must be so until then."""
        end = time.monotonic() + seconds
        while what not in self.heard():
            if process.poll() is not None or time.monotonic() > end or not meanwhile():
                raise RuntimeError(f"link-sim has not said '{what}': {self.heard()}")
            time.sleep(0.002)

    def run(self, *words, **more):
        """`gatefly run` in the background."""
        return self.start(self.gatefly, "run", self.track, *self.configs, *self.camera, *self.link, *words, **more)

    def bench(self, asks, *words):
        """`gatefly bench-drone`, whose lines the drone's hand reads from the file `asks`. @return its exit code and all that it has said."""
        with open(self.folder / asks, "w", encoding="utf-8") as file:
            done = subprocess.run([str(word) for word in (self.gatefly, "bench-drone", "--propellers-off", *self.link, *words)], cwd=self.folder, env=self.environment,
                                  stdout=subprocess.PIPE, stderr=file, text=True, timeout=180, check=False)
        return done.returncode, done.stdout + (self.folder / asks).read_text(encoding="utf-8")

    def benched(self, seed):
        """A drone.toml by our own means: calibrated, read, turned, handed over. @return its path and all that was said."""
        asks = self.folder / "asks.txt"
        world = self.world("--seed", seed, "--bench", asks)
        try:
            drone = self.folder / "drone.toml"
            for _ in range(3):  # on a busy machine Betaflight's simulator now and then calibrates to something else
                with asks.open("a", encoding="utf-8") as file:
                    file.write("calibrate\n")
                time.sleep(2.5)
                code, said = self.bench(asks, "--name", "simulated", *self.told, "--least-v", "0", "--out", drone)
                if "calibrate it" not in said:
                    break
            if code == 0:
                code, more = self.bench(asks, "--hand-over", drone, *self.camera, *self.configs)
                said += more
            if code != 0:
                raise RuntimeError(said)
            return drone, said
        finally:
            world.terminate()
            world.wait(timeout=20)
            ended(world)


class ArduCopter(Simulated):
    """ArduCopter's own simulator with the JSON interface (tools/autopilots.sh), set up as tests/live/arducopter.parm says."""

    def __init__(self, gatefly, root, folder, program, track="oval", camera="", ahead=()):
        self._around(gatefly, root, folder, track, camera, ahead)
        self.configs = ["--config", "archer-b2", "--config", "arducopter", *camera_words(camera)]
        self.ports.update(controller=5760, servos=9002, radio=5501)
        self.world_words = ["--autopilot", "arducopter"]
        self.told = ["--exponent", "0.88"]
        self.controller = self.start(*ahead, program, "--model", "json:127.0.0.1", "--serial0", "tcp:5760", "--defaults", self.root / "tests" / "live" / "arducopter.parm", "-I0",
                                     "--home", "52,4.37,0,0", "--wipe", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.link = ["--link", f"mavlink:tcp:127.0.0.1:{self.ports['msp']}"]


class Px4(Simulated):
    """PX4's own simulator (tools/autopilots.sh --px4), set up as tests/live/px4/px4-rc.params says, at the ports that are its own."""

    def __init__(self, gatefly, root, folder, build, signs, track="oval", camera="", ahead=()):
        """build: the folder in which it was built, with bin/px4 and etc/ in it. signs: tests/fake_betaflight of the build, which signs a drone file."""
        self._around(gatefly, root, folder, track, camera, ahead)
        self.signs = signs
        self.build = pathlib.Path(build)
        self.configs = ["--config", "archer-b2", "--config", "arducopter", *camera_words(camera)]
        line, = free_ports(1, socket.SOCK_DGRAM)
        self.ports.update(state=4560, radio=18570, controller=14540)
        self.world_words = ["--autopilot", "px4", "--mavlink", line]
        self.environment.update(PX4_SIM_MODEL="none_iris", PATH=f"{self.root / 'tests' / 'live' / 'px4'}:{os.environ['PATH']}")
        with open(self.folder / "px4.txt", "w", encoding="utf-8") as says:
            self.controller = self.start(*ahead, self.build / "bin" / "px4", "-d", self.build / "etc", stdin=subprocess.DEVNULL, stdout=says, stderr=subprocess.STDOUT,
                                         start_new_session=True)
        self.link = ["--link", f"mavlink:udpin:127.0.0.1:{line}"]

    def world(self, *words, **more):
        process = super().world(*words, **more)
        # Level and still, as whoever owns it would; one that has just started may not hear of it.
        for _ in range(10):
            with contextlib.suppress(subprocess.TimeoutExpired):
                subprocess.run([self.build / "bin" / "px4-commander", "calibrate", "accel", "quick"], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=20, check=False)
            time.sleep(3)
            if "offset:" in (self.folder / "px4.txt").read_text(encoding="utf-8", errors="replace"):
                break
        else:
            ended(process)
            raise RuntimeError("PX4 does not calibrate its accelerometer")
        return process

    def benched(self, seed):
        """A drone.toml as tests/live has it, signed: there is no hand-over test for a PX4 yet."""
        content = (self.root / "tests" / "live" / "px4_sim.toml").read_text(encoding="utf-8")
        plain = self.folder / "plain.toml"
        plain.write_text(content, encoding="utf-8")
        flies = pathlib.Path(self.gatefly).with_name("gatefly-lab")
        mark = subprocess.run([self.signs, "--sign", plain, flies if flies.exists() else self.gatefly], capture_output=True, text=True, check=True).stdout.strip()
        signed = self.folder / "drone.toml"
        signed.write_text(f'{content}\n[hand_over_test]\npassed = "{mark}"\n', encoding="utf-8")
        return signed, f"seed {seed}: not flown for it"

    def end(self):
        # Its startup script is a program of its own, which would go on and talk to the next one.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.controller.pid, signal.SIGKILL)
        super().end()


class Ts002(Simulated):
    """link-sim as a simulator of TS-002, without a controller beside it."""

    def __init__(self, gatefly, root, folder, track="oval", camera="", ahead=()):
        self._around(gatefly, root, folder, track, camera, ahead)
        self.configs = ["--config", "archer-b2", "--config", "ts002", *camera_words(camera or "grandprix")]
        line, = free_ports(1, socket.SOCK_DGRAM)
        self.world_words = ["--autopilot", "ts-002", "--mavlink", line]
        self.link = ["--link", f"mavlink:udpin:127.0.0.1:{line}"]

    def end(self):
        pass

    def benched(self, seed):
        return self.root / "tests" / "live" / "ts002.toml", f"seed {seed}: nobody hands it over"
