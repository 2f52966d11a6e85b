/* SPDX-License-Identifier: MIT */
/*
 * The finished composite under a panorama and lamps, path traced without cells, basis or
 * compositor: the reference for the whole method. The camera sees lamps in the background and
 * through glass, never before an object.
 *
 *     out = O + (1 - coverage) * s / u * B      linear light
 *
 * O, s and u come from ordinary paths: next-event estimation by the panorama's texels and each
 * lamp, and sampling of the BSDF, joined by the balance heuristic (lamps: the power heuristic).
 * u - s is estimated as a difference, from the same random numbers, so that it is exactly 0 where
 * the object is not involved.
 */
#ifndef INLAY_BAKE_TRUTH_TRUTH_H
#define INLAY_BAKE_TRUTH_TRUTH_H

#include <limits.h>
#include <stdint.h>

#include "bake/scene/scene.h"
#include "bake/truth/sky.h"
#include "hal/options/options.h"

struct truth_settings {
	int samples; /* a pixel */
	int bounces, seed;
	int threads; /* 0: one for each processor */
	bool quiet;
};

struct truth_report {
	double noise_levels; /* standard error, 8-bit levels, RMS over what the object changes */
	uint64_t rays;
	double seconds;
};

/* Traces the composite. out: a new float picture of the camera's size, linear; background: of the
 * same size, linear. -ENOMEM, or -errno of starting threads. */
int truth_run(const struct scene *scene, const struct sky *sky, const struct image *background,
	      const struct truth_settings *settings, struct image *out, struct truth_report *report,
	      struct fault *fault);

/* The pictures that import takes, of a scene under one sky: linear, black where nothing is seen. */
struct truth_pictures {
	struct image with;     /* objects and real surfaces */
	struct image without;  /* real surfaces alone */
	struct image alone;    /* what is seen of the objects, over black */
	struct image coverage; /* the objects' share of each pixel, the same in all channels */
};

int truth_pictures(const struct scene *scene, const struct sky *sky,
		   const struct truth_settings *settings, struct truth_pictures *out,
		   struct fault *fault);
void truth_pictures_free(struct truth_pictures *pictures); /* idempotent; zeroed is fine */

/* Rows of a command whose AT(truth) is a struct truth_settings. */
/* clang-format off */
#define TRUTH_ROWS										   \
	{"samples", OPTION_INT, AT(truth.samples), .min = 1, .max = 1 << 20},			   \
	{"seed", OPTION_INT, AT(truth.seed), .max = INT_MAX},					   \
	{"threads", OPTION_INT, AT(truth.threads), .min = 1, .max = 1024},			   \
	{"quiet", OPTION_FLAG, AT(truth.quiet)}
/* clang-format on */

#endif
