#!/usr/bin/awk -f
# SPDX-License-Identifier: MIT
# Writes a ball of radius 1 around the origin as an OBJ file: awk -f ball.awk >ball.obj
BEGIN {
	across = 96; down = 48; turn = 2 * atan2(0, -1)
	for (j = 0; j <= down; j++)
		for (i = 0; i < across; i++) {
			radius = sin(turn * j / down / 2)
			print "v", radius * cos(turn * i / across), cos(turn * j / down / 2), -radius * sin(turn * i / across)
		}
	for (j = 0; j < down; j++)
		for (i = 0; i < across; i++) {
			a = j * across + i + 1; b = j * across + (i + 1) % across + 1
			if (j < down - 1) print "f", a, a + across, b + across
			if (j > 0) print "f", a, b + across, b
		}
}
