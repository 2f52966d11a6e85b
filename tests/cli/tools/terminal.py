# SPDX-License-Identifier: MIT
"""Runs a program in a terminal that goes away as soon as a file has a line; its exit code is left.

    terminal.py FILE PROGRAM ARGUMENT...
"""
import os
import pty
import signal
import sys
import time

file, command = sys.argv[1], sys.argv[2:]
stderr = os.dup(2)
child, terminal = pty.fork()
if child == 0:
    os.dup2(stderr, 2)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nohup leaves it ignored
    os.execv(command[0], command)
end = time.monotonic() + 120
while not (os.path.exists(file) and os.path.getsize(file)) and time.monotonic() < end:
    time.sleep(0.05)
os.close(terminal)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) & 255)
