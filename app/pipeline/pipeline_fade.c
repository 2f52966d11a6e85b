/* SPDX-License-Identifier: MIT */
/* Between two poses: both pictures, mixed in linear light. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "app/pipeline/pipeline_parts.h"

#define ROWS 16 /* of the picture, that a thread mixes at a time */

struct pipeline_fade {
	size_t stride;
	uint8_t *pose[2];	 /* [height][stride] */
	double linear[256];	 /* of code values */
	uint8_t mixed[256][256]; /* code values of both to that of the mix */
	struct transfer_curve curve;
	double share; /* that mixed is of; < 0: none */
	/* the frame in the making */
	int width, height;
	uint8_t *out;
	size_t out_stride;
};

int pipeline_fade_begin(struct pipeline *p)
{
	const size_t width = p->basis->info.width, height = p->basis->info.height;
	struct pipeline_fade *f = p->fade;

	if (f)
		return 0;
	f = p->fade = calloc(1, sizeof(*f));
	if (!f)
		return -ENOMEM;
	f->stride = (4 * width + 63) / 64 * 64;
	f->width = (int)width;
	f->height = (int)height;
	f->share = -1;
	for (int k = 0; k < 2; k++) {
		f->pose[k] = aligned_alloc(64, f->stride * height);
		if (!f->pose[k]) {
			pipeline_fade_end(p);
			return -ENOMEM;
		}
	}
	return 0;
}

void pipeline_fade_end(struct pipeline *p)
{
	if (!p->fade)
		return;
	free(p->fade->pose[0]);
	free(p->fade->pose[1]);
	free(p->fade);
	p->fade = NULL;
}

/* The code value whose light is nearest; values ascend, so the search goes on where it was. */
static void fill_row(struct pipeline_fade *f, int a)
{
	int code = 0;

	for (int b = 0; b < 256; b++) {
		const double wanted = (1 - f->share) * f->linear[a] + f->share * f->linear[b];

		while (code < 255 && f->linear[code + 1] - wanted <= wanted - f->linear[code])
			code++;
		f->mixed[a][b] = (uint8_t)(a == b ? a : code);
	}
}

static void prepare(struct pipeline_fade *f, const struct transfer_curve *curve, double share)
{
	const bool same = f->share >= 0 && transfer_curve_same(&f->curve, curve);

	if (!same) {
		f->curve = *curve;
		for (int v = 0; v < 256; v++)
			f->linear[v] = transfer_curve_decode(curve, v / 255.0);
	}
	if (same && f->share == share)
		return;
	f->share = share;
	for (int a = 0; a < 256; a++)
		fill_row(f, a);
}

static void mix_rows(void *context, int item, int worker)
{
	const struct pipeline_fade *f = context;
	const int end = (item + 1) * ROWS < f->height ? (item + 1) * ROWS : f->height;

	(void)worker;
	for (int y = item * ROWS; y < end; y++) {
		const uint8_t *a = f->pose[0] + (size_t)y * f->stride;
		const uint8_t *b = f->pose[1] + (size_t)y * f->stride;
		uint8_t *out = f->out + (size_t)y * f->out_stride;

		for (int x = 0; x < 4 * f->width; x++)
			out[x] = f->mixed[a[x]][b[x]];
	}
}

int pipeline_fade_run(struct pipeline *p, const struct backdrop *background, uint8_t *out,
		      size_t out_stride)
{
	const int poses[2] = {p->choice.pose, p->choice.next};
	struct pipeline_fade *f = p->fade;
	int err = 0;

	for (int k = 0; k < 2 && !err; k++)
		err = compositor_run(p->compositor, poses[k], &p->selection, background, f->pose[k],
				     f->stride);
	if (err)
		return err;
	prepare(f, &p->settings.background, p->choice.share);
	f->out = out;
	f->out_stride = out_stride;
	pool_run(p->pool, (f->height + ROWS - 1) / ROWS, mix_rows, f);
	return 0;
}
