/* SPDX-License-Identifier: MIT */
/* Private to hal/lights/sampler*.c: the parts of a sampler. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_PARTS_H
#define INLAY_HAL_LIGHTS_SAMPLER_PARTS_H

#include "hal/lights/pixel_noise.h"
#include "hal/lights/sampler.h"
#include "hal/lights/sampler_table.h"
#include "hal/optics/dome_placed.h"

/* A decoded code value: 65535 is linear 1.0; 32768 is subtracted to fit 16 bits. */
#define SAMPLER_VALUE_MAX 65535
#define SAMPLER_VALUE_BIAS 32768

struct sampler_sums {
	int64_t plane[SAMPLER_PLANES];
};

/* Memory of one thread: the decoded planes of a strip, and a row of pixels. */
struct sampler_scratch {
	int16_t *planes;
	uint32_t *row;
};

/* What one of several exposures needs besides. */
struct sampler_exposure {
	struct sampler_decode soft;  /* what is believed of each code */
	struct sampler_decode above; /* what the longer exposure does not believe */
	bool shorter;	    /* there is a shorter exposure: soft is used in place of decode */
	double longer;	    /* ratio to the longer exposure; 1: none, above is off */
	float (*excess)[3]; /* [table.lights]: what the longer exposure does not believe */
	struct sampler_sums *above_parts, *above_all; /* as of_parts and of_all, above the level */
};

struct light_sampler {
	int lights; /* of the dome */
	/* NULL: the table's lights are the dome's; else they are thirds */
	struct dome_placed *placed;
	float (*measured)[3]; /* [table.lights] */
	double (*third)[3];   /* [table.lights] */
	double (*folded)[3];  /* [lights] */
	struct sampler_table table;
	const struct sampler_kernels *kernels;
	int width, height;
	double colours[3][3];	  /* gain included */
	struct pixel_white white; /* of the camera's curve */
	struct sampler_decode decode;
	struct sampler_exposure exposure;
	double *sky_share;	       /* [lights]: solid angle / 2 pi, by parts */
	float *clipped;		       /* [table.lights] */
	struct sampler_sums *of_parts; /* [parts] */
	struct sampler_sums *of_all;   /* [sums]: of_parts added up */
	double (*linear)[3];	       /* [sums] of a float picture */
	struct sampler_scratch *scratch;
	int scratches;
};

/* Number of values in one plane of a strip. */
static inline size_t sampler_plane_values(const struct light_sampler *s)
{
	return (size_t)s->table.row_stride * SAMPLER_STRIP_ROWS;
}

/* ---- sampler_frame.c: the sums over a frame's pixels, strip by strip on all threads ---- */

/* Makes the scratch memory of so many threads, which stays: a second frame allocates nothing.
 * -ENOMEM. */
int sampler_scratch_grow(struct light_sampler *sampler, int threads);

/*
 * Reads a frame of the sampler's size and fills of_all, and above_all when something above a level
 * is wanted. pool may be NULL: the calling thread does all. -ENOMEM.
 */
int sampler_frame_sum(struct light_sampler *sampler, const struct frame_reader *reader,
		      struct pool *pool);

#endif
