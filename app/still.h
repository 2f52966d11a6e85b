/* SPDX-License-Identifier: MIT */
/* inlay still: one picture through the pipeline, from files to a file. */
#ifndef INLAY_APP_STILL_H
#define INLAY_APP_STILL_H

#include "config/config.h"
#include "hal/base/fault.h"

/* Fast and exact as in compositor.h; reference: double precision, of the exact layer where the
 * basis has one. */
enum still_mode { STILL_FAST, STILL_EXACT, STILL_REFERENCE, STILL_MODE_COUNT };

extern const char *const still_mode_names[]; /* "fast", "exact", "reference", NULL */

struct still_settings {
	const struct config *config;
	const char *basis;
	const char *background;
	const char *fisheye; /* one of fisheye and lights, the other NULL */
	const char *lights;
	const char *lights_out; /* NULL: none are written */
	const char *out;	/* .png: code values; .pfm, .hdr: linear light */
	struct ini_level threshold;
	int pose;
	enum still_mode mode;
};

int still_run(const struct still_settings *settings, struct fault *fault);

#endif
