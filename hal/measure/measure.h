/* SPDX-License-Identifier: MIT */
/* Measures what a frame costs and how wrong it is; for reports and benches. */
#ifndef INLAY_HAL_MEASURE_MEASURE_H
#define INLAY_HAL_MEASURE_MEASURE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/basis/basis.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/optics/dome.h"

/* The background picture of all benchmarks and reports: gradients, edges and texture, from black to
 * white. */

void background_fill(struct canvas *canvas);

/* The settings of all composites that are measured: sRGB before and after, with the object. */
struct compositor_settings background_settings(enum compositor_mode mode);

/*
 * Measures the error of a composite against double precision, in 8-bit levels, over the pixels that
 * the object changes. The reference is not rounded, so a perfect 8-bit picture has an RMS error of
 * 0.29 levels, 58.9 dB.
 */

/* Classifies the pixels of a picture. */
enum scope_pixel {
	SCOPE_UNTOUCHED, /* the object does not change the pixel */
	SCOPE_OBJECT,	 /* the object covers the pixel, at least in part */
	SCOPE_SHADOW,	 /* the object changes the receiver and does not cover it */
};

struct scope {
	int width, height;
	uint8_t *pixel; /* [height * width]: enum scope_pixel */
	long objects, shadows;
};

int scope_create(struct scope *scope, const struct basis *basis,
		 const struct basis_layer *layer); /* -ENOMEM */
void scope_free(struct scope *scope);		   /* idempotent; zeroed is fine */

struct composite_error {
	double rms, psnr_db, max; /* over object and shadow */
	double frame_psnr_db;	  /* over every pixel */
	/* Mean of |ratio - true ratio| over pixels and channels of the shadow, weighted by the
	 * background, in linear light:
	 *     sum |out - true out| / sum B
	 */
	double contrast;
};

double error_psnr(double rms); /* in dB; at most 120: JSON has no infinity */

/* truth: [height][width][3], R G B, 0..255. Both pictures hold code values of this transfer
 * function. */
struct composite_error error_measure(const struct scope *scope, const double *truth,
				     const struct canvas *is, const struct picture *background,
				     enum transfer transfer);

/* Sets each figure of *worst to the worse of both. */
void error_worse(struct composite_error *worst, const struct composite_error *other);

/*
 * Lightings for tests of a basis: built-in ones, files of lights, panoramas. All but files are
 * exposed like a camera would expose them.
 */

/* One lighting, or several of one kind, of which the worst result counts. */
struct lighting {
	char name[64];
	int members;
	float (*radiance)[3]; /* [members][lights] */
};

struct lightings {
	struct lighting *item;
	int count;
};

void lightings_free(struct lightings *lightings); /* idempotent; zeroed is fine */

/* Returns one member of a lighting: [lights]. */
const float (*lighting_member(const struct lighting *lighting, const struct basis *basis,
			      int member))[3];

/* Copies a file's name without folders and extension. */
void lighting_name(const char *path, char *name, size_t room);

/* Creates the dome of the basis's lights; the caller frees it. -ENOTSUP: their nodes divide no sky;
 * -ENOMEM. */
int lightings_dome(struct dome *dome, const struct basis *basis, struct fault *fault);

/* Each function adds to the list. After a failure the earlier entries are still valid. */

/* Adds overcast (CIE), sun (low, at a place that no bake has tried), random, and single cells
 * (`cells` of them, spread over the sky). White ground has radiance 1; with single cells white
 * ground or the brightest spot of the object. -ENOMEM. */
int lightings_add_built_in(struct lightings *lightings, const struct basis *basis, int cells,
			   struct fault *fault);

/* Adds a file of lights (hal/lights/lights_file.h), unchanged. */
int lightings_add_file(struct lightings *lightings, const struct basis *basis, const char *path,
		       struct fault *fault);

/* Adds the mean of an equirectangular picture over each light, exposed so that white ground has
 * radiance 0.6. -EINVAL: the picture is not in linear light; -ENOTSUP: the basis's lights are no
 * dome's; -ENOMEM, errors of reading. */
int lightings_add_panorama(struct lightings *lightings, const struct basis *basis, const char *path,
			   struct fault *fault);

/*
 * Times several methods in turns (A, B, C, A, B, C, ...), so that noise of the machine affects all
 * equally. Untimed runs of the same method precede each timed one, so that it finds warm caches.
 */

struct turns {
	void *context;
	int ways, repeat;
	/* Called before each run, untimed. Anything but 0 from prepare() or run() ends all. */
	int (*prepare)(void *context, int way, int turn);
	int (*run)(void *context, int way);
	/* Other threads work, too, so that the clock's time counts. Else processor time of the
	 * calling thread does: other programs interrupt a long run more often than a short one. */
	bool shared;
	/* Totals where they do not: clock time and processor time, added to. */
	int64_t timed_ns, ran_ns;
};

/* ms: [ways][repeat], in the order of turns. Returns 0, or what prepare() or run() returned. */
int turns_time(struct turns *turns, double *ms);

/* The least time, and the quartiles: half of the times are between low and high. */
struct turns_spread {
	double least, low, median, high;
};

/* Sorts ms and returns its spread. Between two times they are interpolated linearly. */
struct turns_spread turns_spread(double *ms, int count);

#endif
