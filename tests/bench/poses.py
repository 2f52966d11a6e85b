#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a basis of several poses costs a running kiosk: how soon a pose is shown, and what is in memory.

    BUILD=build/x tests/bench/poses.py BASIS [ALONE...]

BASIS: seven poses or more. ALONE: some of its poses, each baked alone (inlay-bake render --pose n) with the same settings: what all of
them would weigh is taken from their mean. The simulated cameras play still pictures, RATE a second, and the
screen is none, so that next to all time is the kiosk's own. Prints Markdown.
"""

import json
import os
import random
import re
import socket
import subprocess
import sys
import tempfile
import time

RATE = 25
POLL_S = 0.003  # the kiosk takes up to 500 lines a second
LIMIT_S = 20
ROUNDS = 2
JUMPS = 40

build = os.environ["BUILD"]
os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))


class Kiosk:
    def __init__(self, work, basis, *more):
        self.path = os.path.join(work, "socket")
        sets = {"basis.file": basis, "screen.driver": "null", "control.socket": self.path, "poses.timeline": "none"}
        for name in "fisheye", "background", "overview":
            sets[f"camera.{name}.sim.source"] = "files"
            sets[f"camera.{name}.sim.file"] = os.path.join(work, name + ".png")
            sets[f"camera.{name}.sim.clock"] = "real"
            sets[f"camera.{name}.rate"] = RATE
        sets.update(more)
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        command = [f"{build}/inlay", "run", "--config", "config/demo.conf", *words]
        self.process = subprocess.Popen(command)
        self.to = socket.socket(socket.AF_UNIX)
        until(lambda: self.to.connect_ex(self.path) == 0)
        self.lines = self.to.makefile("rw")
        until(lambda: self.status()["fps"] > RATE - 2)

    def tell(self, command):
        self.lines.write(command + "\n")
        self.lines.flush()
        return self.lines.readline().strip()

    def status(self):
        return json.loads(self.tell("status"))

    def show(self, command):
        """How many ms until it is in the picture."""
        start = time.monotonic()
        assert self.tell(command) == "ok"
        until(self.is_shown, POLL_S)
        return 1000 * (time.monotonic() - start)

    def is_shown(self):
        now = self.status()
        return now["pose"] == now["pose_shown"]

    def memory(self):
        """MB: all that is resident, of files, of its own."""
        time.sleep(1)
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as about:
            text = about.read()
        return [int(re.search(key + r":\s+(\d+)", text)[1]) / 1024 for key in ("VmRSS", "RssFile", "RssAnon")]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


def until(what, pause_s=0.05):
    limit = time.monotonic() + LIMIT_S
    while not what():
        assert time.monotonic() < limit, "the kiosk does not do it"
        time.sleep(pause_s)


def photograph(work):
    for show, name in ("fisheye", "fisheye"), ("before", "background"), ("before", "overview"):
        words = ["screen.show=" + show, "screen.device=" + os.path.join(work, name + ".png"), "basis.file=" + sys.argv[1]]
        sets = [word for value in words for word in ("--set", value)]
        subprocess.run(
            [f"{build}/inlay", "run", "--config", "config/demo.conf", *sets, "--frames", "2"],
            check=True, stderr=subprocess.DEVNULL,
        )


def say_times(what, times):
    times = sorted(times)
    shown = [times[len(times) // 2], times[len(times) * 95 // 100], times[-1]]
    print(f"| {what} |", " | ".join(f"{t:.0f}" for t in shown), "|")


def say_memory(what, kiosk):
    print(f"| {what} |", " | ".join(f"{m:.1f}" for m in kiosk.memory()), "|")


def say_sizes(basis, poses, alone):
    whole, single = os.path.getsize(basis) / 1e6, [os.path.getsize(path) / 1e6 for path in alone]
    print(f"{poses} poses: {whole:.2f} MB, {whole / poses:.2f} a pose")
    if alone:
        mean = sum(single) / len(single)
        print(f"alone: {mean:.2f} MB, the mean of {len(single)}; ratio {whole / poses / mean:.3f}")


def watch(kiosk, poses):
    say_memory("one pose shown", kiosk)
    kiosk.show("pose 1")
    kiosk.show("pose 0")
    say_memory("two in turn", kiosk)
    steps, jumps = [], []
    for _ in range(ROUNDS * poses):
        steps.append(kiosk.show("pose-next"))
        time.sleep(random.random() / RATE)
    say_memory("all, step by step", kiosk)
    each = [kiosk.show("pose-next") for _ in range(ROUNDS * poses)]
    at = 0
    for _ in range(JUMPS):
        at = (at + random.randrange(3, poses - 3)) % poses
        jumps.append(kiosk.show(f"pose {at}"))
    say_memory("any, by jumps", kiosk)
    print(f"\n| shown after, ms, of frames every {1000 / RATE:.0f} | median | 95 % | most |\n|---|---|---|---|")
    say_times("a step at any time", steps)
    say_times("a step in each frame", each)
    say_times("a jump", jumps)


def main():
    basis, *alone = (os.path.abspath(path) for path in sys.argv[1:])
    sys.argv[1] = basis
    about = subprocess.run([f"{build}/inlay-bake", "info", "--json", basis], check=True, capture_output=True).stdout
    poses = json.loads(about)["poses"]
    say_sizes(basis, poses, alone)
    with tempfile.TemporaryDirectory() as work:
        photograph(work)
        print("\n| in memory, MB | all | of files | its own |\n|---|---|---|---|")
        for path in alone[:1]:
            with Kiosk(work, path) as kiosk:
                say_memory("a file of one pose", kiosk)
        with Kiosk(work, basis) as kiosk:
            watch(kiosk, poses)


main()
