/* SPDX-License-Identifier: MIT */
#include "app/view/layout.h"

#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ONE (1 << 14)
#define BAND_ROWS 32 /* destination rows of one item of work */

static void axis_free(struct scaler_axis *axis)
{
	free(axis->first);
	free(axis->weight);
	*axis = (struct scaler_axis){.from = 0};
}

static double tent(double distance, double reach)
{
	return fmax(0, 1 - fabs(distance) / reach);
}

/* Weights of one destination pixel: a tent around its centre, cut at the picture's border and
 * scaled to sum to ONE exactly; the largest weight takes the rest of the rounding. */
static void axis_add_weights(struct scaler_axis *axis, int i, double scale, double reach)
{
	double centre = (i + 0.5) * scale - 0.5, sum = 0;
	int first = (int)ceil(centre - reach), left = ONE, largest = 0;
	uint16_t *weight = axis->weight + (size_t)i * (size_t)axis->taps;

	if (first > axis->from - axis->taps)
		first = axis->from - axis->taps;
	if (first < 0)
		first = 0;
	for (int t = 0; t < axis->taps; t++)
		sum += tent(first + t - centre, reach);
	for (int t = 0; t < axis->taps; t++) {
		weight[t] = (uint16_t)lrint(tent(first + t - centre, reach) / sum * ONE);
		left -= weight[t];
		if (weight[t] > weight[largest])
			largest = t;
	}
	weight[largest] = (uint16_t)(weight[largest] + left);
	axis->first[i] = first;
}

static int axis_fit(struct scaler_axis *axis, int from, int to)
{
	double scale = (double)from / to, reach = fmax(1, scale);
	/* A half-open interval of length 2 * reach holds no more whole numbers than this. */
	int taps = (int)ceil(2 * reach);

	axis_free(axis);
	axis->from = from;
	axis->to = to;
	axis->taps = taps < from ? taps : from;
	axis->first = calloc((size_t)to, sizeof(*axis->first));
	axis->weight = calloc((size_t)to * (size_t)axis->taps, sizeof(*axis->weight));
	if (!axis->first || !axis->weight) {
		axis_free(axis);
		return -ENOMEM;
	}
	for (int i = 0; i < to; i++)
		axis_add_weights(axis, i, scale, reach);
	return 0;
}

static size_t row_bytes(const struct scaler *scaler)
{
	return (size_t)scaler->across.to * 4;
}

int scaler_fit(struct scaler *scaler, int from_width, int from_height, int to_width, int to_height,
	       const struct pool *pool)
{
	const int workers = pool_threads(pool);
	int err;

	if (scaler->scratch && scaler->workers >= workers && scaler->across.from == from_width &&
	    scaler->across.to == to_width && scaler->down.from == from_height &&
	    scaler->down.to == to_height)
		return 0;
	scaler_free(scaler);
	err = axis_fit(&scaler->across, from_width, to_width);
	if (err)
		return err;
	err = axis_fit(&scaler->down, from_height, to_height);
	if (err)
		goto free_scaler;
	scaler->workers = workers;
	/* For each worker: a sum for each byte of a row, the rows under the filter, and the number
	 * of the source row in each of them. */
	scaler->scratch_bytes = 4 * row_bytes(scaler) +
				(size_t)scaler->down.taps * (row_bytes(scaler) + sizeof(int));
	scaler->scratch = calloc((size_t)scaler->workers, scaler->scratch_bytes);
	if (!scaler->scratch) {
		err = -ENOMEM;
		goto free_scaler;
	}
	return 0;
free_scaler:
	scaler_free(scaler);
	return err;
}

void scaler_free(struct scaler *scaler)
{
	axis_free(&scaler->across);
	axis_free(&scaler->down);
	free(scaler->scratch);
	*scaler = (struct scaler){.scratch = NULL};
}

/* ---- running ---- */

struct band_job {
	struct scaler *scaler;
	const struct picture *from;
	int left, right;
	uint8_t *out;
	size_t out_stride;
};

static void scale_across(const struct band_job *job, int y, uint8_t *to)
{
	const struct scaler_axis *axis = &job->scaler->across;
	const struct picture *from = job->from;
	const uint8_t *row = from->origin + y * from->y_step;

	for (int x = job->left; x < job->right; x++, to += 4) {
		const uint8_t *pixel = row + axis->first[x] * from->x_step;
		const uint16_t *weight = axis->weight + (size_t)x * (size_t)axis->taps;
		uint32_t sum[4] = {ONE / 2, ONE / 2, ONE / 2, ONE / 2};

		for (int t = 0; t < axis->taps; t++, pixel += from->x_step) {
			for (int c = 0; c < 4; c++)
				sum[c] += (uint32_t)weight[t] * pixel[c];
		}
		for (int c = 0; c < 4; c++)
			to[c] = (uint8_t)(sum[c] / ONE);
	}
}

static void make_row(const struct band_job *job, int y, uint32_t *sum, uint8_t *rows, int *held)
{
	const struct scaler *scaler = job->scaler;
	const struct scaler_axis *down = &scaler->down;
	const uint16_t *weight = down->weight + (size_t)y * (size_t)down->taps;
	uint8_t *out = job->out + (size_t)y * job->out_stride;
	size_t bytes = (size_t)(job->right - job->left) * 4;

	for (size_t i = 0; i < bytes; i++)
		sum[i] = ONE / 2;
	for (int t = 0; t < down->taps; t++) {
		int source = down->first[y] + t, slot = source % down->taps;
		uint8_t *row = rows + (size_t)slot * bytes;

		if (held[slot] != source) {
			scale_across(job, source, row);
			held[slot] = source;
		}
		for (size_t i = 0; i < bytes; i++)
			sum[i] += (uint32_t)weight[t] * row[i];
	}
	for (size_t i = 0; i < bytes; i++)
		out[i] = (uint8_t)(sum[i] / ONE);
}

static void make_band(void *context, int item, int worker)
{
	const struct band_job *job = context;
	struct scaler *scaler = job->scaler;
	uint8_t *scratch = scaler->scratch + (size_t)worker * scaler->scratch_bytes;
	uint32_t *sum = (uint32_t *)(void *)scratch;
	int *held = (int *)(void *)(scratch + 4 * row_bytes(scaler));
	uint8_t *rows = (uint8_t *)(held + scaler->down.taps);
	int end = (item + 1) * BAND_ROWS;

	if (end > scaler->down.to)
		end = scaler->down.to;
	for (int t = 0; t < scaler->down.taps; t++)
		held[t] = -1;
	for (int y = item * BAND_ROWS; y < end; y++)
		make_row(job, y, sum, rows, held);
}

void picture_copy(const struct picture *from, uint8_t *out, size_t out_stride)
{
	for (int y = 0; y < from->height; y++) {
		const uint8_t *row = from->origin + y * from->y_step;

		if (from->x_step > 0)
			memcpy(out, row, (size_t)from->width * 4);
		else
			ARGBMirror(row - (ptrdiff_t)(from->width - 1) * 4, from->width * 4, out,
				   (int)out_stride, from->width, 1);
		out += out_stride;
	}
}

void scaler_run(struct scaler *scaler, struct pool *pool, const struct picture *from, int left,
		int right, uint8_t *out, size_t out_stride)
{
	struct band_job job = {scaler, from, left, right, out, out_stride};
	int bands = (scaler->down.to + BAND_ROWS - 1) / BAND_ROWS;

	pool_run(pool, bands, make_band, &job);
}
