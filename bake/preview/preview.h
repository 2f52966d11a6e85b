/* SPDX-License-Identifier: MIT */
/* A photograph with the scene's objects in it, path traced with few samples (bake/truth), to see
 * whether everything is in its place. */
#ifndef INLAY_BAKE_PREVIEW_PREVIEW_H
#define INLAY_BAKE_PREVIEW_PREVIEW_H

#include <stdbool.h>

#include "hal/base/fault.h"

struct preview_settings {
	const char *scene, *background, *output;
	const char *config; /* of the kiosk; NULL: none */
	/* Light colours of a dome, or a picture of the kiosk's fisheye (needs config); both NULL:
	 * an even sky. */
	const char *lights, *fisheye;
	int frequency;	 /* of that dome; -1: the scene's */
	double exposure; /* radiance of the even sky, or of 1 in lights */
	int samples;	 /* a pixel; 0: as many as make PREVIEW_RAYS, but PREVIEW_SAMPLES at most */
	const char *pose; /* name or number; NULL: the first */
	int threads;	  /* 0: one for each processor */
	bool quiet;	  /* prints nothing */
};

#define PREVIEW_RAYS 2500000 /* camera rays: some three seconds of a processor */
#define PREVIEW_SAMPLES 16

/* Checks that the output can be written and is none of the files that the settings name. */
int preview_check(const struct preview_settings *settings, struct fault *fault);

/* Makes the picture, which appears whole or not at all. Prints a line for each object and one for
 * the picture. Errors of its files; -EINVAL: a picture or lights that do not fit the scene;
 * -ENODATA: the camera sees no object. */
int preview_run(const struct preview_settings *settings, struct fault *fault);

#endif
