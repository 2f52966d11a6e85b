/* SPDX-License-Identifier: MIT */
/* Between two poses: composites both, and mixes them in linear light (hal/colour/crossfade.h). */
#include <errno.h>
#include <stdlib.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/colour/crossfade.h"

#define ROWS 16 /* rows that one item of work mixes */

struct pipeline_fade {
	size_t stride;
	uint8_t *pose[2]; /* [height][stride] */
	struct crossfade mix;
	/* The frame that is being made: */
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
	crossfade_init(&f->mix);
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

static void mix_rows(void *context, int item, int worker)
{
	const struct pipeline_fade *f = context;
	const int end = (item + 1) * ROWS < f->height ? (item + 1) * ROWS : f->height;

	(void)worker;
	for (int y = item * ROWS; y < end; y++)
		crossfade_row(&f->mix, f->pose[0] + (size_t)y * f->stride,
			      f->pose[1] + (size_t)y * f->stride, 4 * f->width,
			      f->out + (size_t)y * f->out_stride);
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
	crossfade_set(&f->mix, &p->settings.background, p->choice.share);
	f->out = out;
	f->out_stride = out_stride;
	pool_run(p->pool, (f->height + ROWS - 1) / ROWS, mix_rows, f);
	return 0;
}
