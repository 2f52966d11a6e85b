/* SPDX-License-Identifier: MIT */
/* What the program says on the screen, in plain words. Pure functions: numbers to UTF-8 text. */
#ifndef INLAY_APP_VIEW_WORDS_H
#define INLAY_APP_VIEW_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/device/camera.h"

/*
 * "Fisheye camera 'C920' is not connected: waiting". role: "Fisheye", "Background", "Scene", or
 * "Fisheye and background" for a camera that several views share. name: of the device, else the
 * configuration's. why: what does not fit, for CAMERA_UNSUPPORTED_FORMAT; empty: not known. Returns
 * the text's length, as snprintf(); 0 for CAMERA_FINE.
 */
int words_camera(char *text, size_t room, const char *role, const char *name,
		 enum camera_situation situation, const char *why);

/* "Pose 3 'left' cannot be loaded: waiting, the log says why". name: "" for none. Returns the
 * length in the same way. */
int words_pose(char *text, size_t room, int pose, const char *name);

/* "The background's camera was moved: its picture lies 10 px left and 2 px down of where it was.
 * Nobody is before the object until it is calibrated again (inlay-calibrate camera)". Returns the
 * length in the same way. */
int words_moved(char *text, size_t room, const double moved_px[2]);

struct words_figures {
	int lights_used, lights;
	double threshold; /* grey level, or percent of white */
	bool percent;	  /* the threshold is a percentage */
	double error; /* bound for what the lights left out may change, linear light, 1 is white */
	double frames_a_second;
	double latency_ms;	  /* mean over the last second */
	uint64_t drops;		  /* since the start */
	double clipped;		  /* share of the sky, 0..1 */
	bool recovered;		  /* the clipped light has been added */
	bool at_bound;		  /* but a bound cut it */
	bool lamp;		  /* one shines where the dome is coarse */
	double lamp_deg[2];	  /* azimuth and height */
	const char *missing_lamp; /* name of one that shows no light where it is said to be; NULL */
	/* One that no section names; off 0: there is none. */
	double unnamed_azimuth_deg, unnamed_height_deg, unnamed_off;
	bool people;	    /* they are looked for */
	double learned;	    /* share of the place that is known without people, 0..1 */
	int in_front;	    /* groups of people in front of the object */
	bool unsure;	    /* the place looks so different that only who moves is */
	double moved_px[2]; /* right and down, by which the camera was nudged */
	bool depth;	    /* there is a depth camera */
	bool by_depth;	    /* and it tells who is */
};

/* "lights 212 of 406 · threshold 32 · error ≤ 1.4 % of white · 29.9 frames/s · latency 38 ms · 12
 * dropped · sky clipped 0.3 %, recovered". A percentage is written "threshold 1 %". Of lamps at
 * places it goes on " · no light at lamp desk · light at 134°, 22° high, no [lamp]: off 8 % if
 * 1.5 m away". With a lamp in a coarse part it goes on " · lamp at azimuth 134°, height 22°: shadow
 * too soft, the dome is coarse there". Where people are looked for: " · place learned 98 %, 1 in
 * front", and with a depth camera " by depth" or " by feet", then " · place not recognized, only
 * who moves is in front", and " · camera moved 2 px right". */
int words_information(char *text, size_t room, const struct words_figures *figures);

#endif
