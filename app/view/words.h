/* SPDX-License-Identifier: MIT */
/* What the program says on the screen, in plain words. Pure functions from numbers to text. */
#ifndef INLAY_APP_VIEW_WORDS_H
#define INLAY_APP_VIEW_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/device/camera.h"

/*
 * "Fisheye camera 'C920' is not connected: waiting". role: "Fisheye", "Background", "Scene" or
 * "Fisheye and background" for a camera that several views share; name: of the device, or as the
 * configuration calls it. Returns text's length, as snprintf; 0 for CAMERA_FINE.
 */
int words_camera(char *text, size_t room, const char *role, const char *name,
		 enum camera_situation situation);

/* "Pose 3 'left' cannot be loaded: waiting, the log says why"; name: "" where it has none. The
 * length as above. */
int words_pose(char *text, size_t room, int pose, const char *name);

struct words_figures {
	int lights_used, lights;
	double threshold; /* grey level */
	bool percent;	  /* the threshold is one, of white */
	double error;	  /* worst case of what was dropped, linear light, 1 is white */
	double frames_a_second;
	double latency_ms; /* mean of the last second */
	uint64_t drops;	   /* since the start */
	double clipped;	   /* share of the sky, 0..1 */
	bool recovered;	   /* what it must be has been added */
	bool at_bound;	   /* but not all of it */
};

/* "lights 212 of 406 · threshold 32 · error ≤ 1.4 % of white · 29.9 frames/s · latency 38 ms · 12
 * dropped · sky clipped 0.3 %, recovered"; "threshold 1 %" of a percentage */
int words_information(char *text, size_t room, const struct words_figures *figures);

#endif
