# SPDX-License-Identifier: MIT
"""Plays the service manager: writes each message that comes to a socket as a line with its time.

    manager.py SOCKET
"""
import os
import socket
import sys
import time

path = sys.argv[1]
manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
manager.bind(path + ".new")
os.rename(path + ".new", path)  # there when it listens
while True:
    message = manager.recv(4096).decode()
    print("%.3f %s" % (time.monotonic(), message.replace("\n", " ")), flush=True)
