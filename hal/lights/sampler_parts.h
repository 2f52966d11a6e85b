/* SPDX-License-Identifier: MIT */
/* Private to hal/lights/sampler*.c: what a sampler is made of. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_PARTS_H
#define INLAY_HAL_LIGHTS_SAMPLER_PARTS_H

#include "hal/lights/sampler.h"
#include "hal/lights/sampler_table.h"

/* Linear 1.0 of a decoded code value, which is kept less half of the range. */
#define SAMPLER_VALUE_MAX 65535
#define SAMPLER_VALUE_BIAS 32768

struct sampler_sums {
	int64_t plane[SAMPLER_PLANES];
};

/* What one thread decodes a strip into. */
struct sampler_scratch {
	int16_t *planes;
	uint32_t *row;
};

struct light_sampler {
	struct sampler_table table;
	const struct sampler_kernels *kernels;
	int width, height;
	double colours[3][3]; /* times gain */
	struct sampler_decode decode, above;
	int above_value; /* less than that is dark in the second one; SAMPLER_VALUE_MAX: it is not
			    used */
	float (*excess)[3]; /* [lights] */
	struct sampler_sums *above_parts, *above_all;
	double *sky_share;	       /* [lights]: solid angle over 2 pi */
	float *clipped;		       /* [lights] */
	struct sampler_sums *of_parts; /* [parts] */
	struct sampler_sums *of_all;   /* [sums] */
	double (*linear)[3];	       /* [sums] */
	struct sampler_scratch *scratch;
	int scratches;
};

/* Of one plane of a strip. */
static inline size_t sampler_plane_values(const struct light_sampler *s)
{
	return (size_t)s->table.row_stride * SAMPLER_STRIP_ROWS;
}

#endif
