# SPDX-License-Identifier: MIT
"""Does to a running kiosk whatever may be done to it, at random.

    actions.py SOCKET PID TIMES SEED CONF BASIS

Sends actions, so many times some, to the control socket, SIGHUPs after another configuration was written to CONF, cuts the
file BASIS short and puts it back. At the end the file is whole, and a pose is chosen: it has to be
shown within two minutes. Fails, and tells the last commands, when the kiosk does not answer.
"""
import collections
import json
import os
import random
import signal
import socket
import sys
import time

POSES = 12
path, pid, times, seed, conf, basis = sys.argv[1:]
pid = int(pid)
chance = random.Random(int(seed))
done = collections.deque(maxlen=60)
counts = collections.Counter()
kiosk = socket.socket(socket.AF_UNIX)
kiosk.settimeout(120)
kiosk.connect(path)
replies = kiosk.makefile("r")
with open(conf) as file:
    first_conf = file.read()
with open(basis, "rb") as file:
    whole = file.read()


def tell(command):
    done.append(command)
    counts[command.split()[0]] += 1
    kiosk.sendall((command + "\n").encode())
    reply = replies.readline()
    if not reply:
        raise ConnectionError("no answer to " + command)
    return reply


def draw():
    level = chance.choice(["0", "8", "60", "200", "0.5%", "20%", "256", "dim"])
    pose = chance.choice([str(chance.randrange(POSES)), "front", "round", "next", "prev", "none", "12"])
    return chance.choice(["view-next"] * 4 + ["pose-next"] * 4 + ["pose-prev"] * 4 + [
        "pose " + pose, "pose " + pose, "threshold-set " + level, "threshold-up", "threshold-down",
        "threshold-next", "object", "information", "split-left", "split-right", "freeze", "wake",
        "status"])


def replace(file, data):
    with open(file + ".new", "wb") as to:
        to.write(data)
    os.rename(file + ".new", file)


def reload():
    text = first_conf + """
[poses]
timeline = %s
rate = %d
fade = %s
[screen]
show = %s
information = %s
[composite]
threads = %d
gain = %s
[lights]
threshold = %s
threshold_mode = %s
""" % (chance.choice(["none", "none", "loop", "swing"]), chance.choice([1, 7, 40, 200]),
       chance.choice(["yes", "no"]),
       chance.choice(["composite", "before", "fisheye", "split", "quad", "off", "nothing"]),
       chance.choice(["yes", "no"]), chance.randrange(4), chance.choice(["0.5", "1", "3"]),
       chance.choice(["0", "20", "1%"]),
       chance.choice(["ambient", "drop"]))
    replace(conf, text.encode())
    done.append("SIGHUP")
    counts["SIGHUP"] += 1
    os.kill(pid, signal.SIGHUP)


def cut():
    done.append("cut")
    counts["cut"] += 1
    os.truncate(basis, chance.randrange(len(whole)))


def put_back():
    """Into the same file, or as another one of that name."""
    done.append("put back")
    if chance.randrange(2):
        replace(basis, whole)
    else:
        with open(basis, "wb") as to:
            to.write(whole)


def go_on():
    for _ in range(int(times)):
        action = draw()
        for _ in range(chance.choice([1, 1, 2, 4, 4, 5])):
            tell(action)
        event = chance.random()
        if event < 0.03:
            reload()
        elif event < 0.05:
            cut()
        elif event < 0.1:
            put_back()
        time.sleep(chance.choice([0, 0.002, 0.01, 0.03]))


def settle():
    replace(basis, whole)
    replace(conf, (first_conf + "[poses]\ntimeline = none\n[screen]\nshow = composite\n").encode())
    os.kill(pid, signal.SIGHUP)
    until = time.monotonic() + 120
    while True:
        tell("pose 7")
        status = json.loads(tell("status"))
        if status["pose_shown"] == 7 and not status.get("pose_trouble"):
            return
        if time.monotonic() > until:
            raise TimeoutError("pose 7 is not shown: %s" % status)
        time.sleep(0.05)


try:
    go_on()
    settle()
except Exception as error:
    print("%s; last: %s" % (error, ", ".join(done)))
    sys.exit(1)
print(", ".join("%d %s" % (count, name) for name, count in counts.most_common()))
