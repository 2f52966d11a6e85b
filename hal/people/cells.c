/* SPDX-License-Identifier: MIT */
/* From the picture to cells, and what the camera does to them: noise and exposure. */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define FIT_EVERY 16 /* frames */
#define GAIN_CELLS 2000
#define SCATTER 0.15f  /* width of the densest half of ratios, over their middle */
#define GAIN_BINS 2048 /* of seen / place, 0..4 */

/* Sums the code values of n = wide * high pixels: blue and red in the halves of sum[0], green in
 * the lower half of sum[1]. At most 16 pixels, so no half overflows. */
static inline void sum_codes(const uint8_t *in, ptrdiff_t x_step, ptrdiff_t y_step, int wide,
			     int high, uint32_t sum[2])
{
	sum[0] = sum[1] = 0;
	for (int v = 0; v < high; v++)
		for (int u = 0; u < wide; u++) {
			uint32_t pixel;

			memcpy(&pixel, in + v * y_step + u * x_step, sizeof(pixel));
			sum[0] += pixel & 0x00ff00ff;
			sum[1] += (pixel >> 8) & 0x000000ff;
		}
}

static inline void read_cell(struct people *p, const struct picture *picture, int x, int y,
			     int wide, int high, int each)
{
	const int at = y * p->across + x;
	const uint8_t *in = picture->origin + y * p->side * picture->y_step +
			    x * p->side * picture->x_step;
	uint32_t sum[2];

	sum_codes(in, picture->x_step, picture->y_step, wide, high, sum);
	p->seen[0][at] = p->linear[(sum[0] >> 16) * (uint32_t)each];
	p->seen[1][at] = p->linear[sum[1] * (uint32_t)each];
	p->seen[2][at] = p->linear[(sum[0] & 0xffff) * (uint32_t)each];
}

/* A cell that the picture's edge may cut. */
static void read_edge_cell(struct people *p, const struct picture *picture, int x, int y)
{
	const int wide = picture->width - x * p->side, high = picture->height - y * p->side;
	const int cut = wide < high ? wide : high, side = cut < p->side ? 1 : p->side;

	read_cell(p, picture, x, y, side, side, CODE_STEPS / (side * side));
}

/* Adds the codes of two neighbouring pixels to those of others: blue and red, and green. */
static inline void add_pair(const uint8_t *in, uint64_t *ends, uint64_t *middle)
{
	uint64_t pair;

	memcpy(&pair, in, sizeof(pair));
	*ends += pair & UINT64_C(0x00ff00ff00ff00ff);
	*middle += (pair >> 8) & UINT64_C(0x000000ff000000ff);
}

/* Reads the cells x..end - 1 of a row, whose pixels follow each other in memory. */
static inline void read_adjacent(struct people *p, const struct picture *picture, int y, int x,
				 int end, int side)
{
	const uint32_t each = (uint32_t)(CODE_STEPS / (side * side));
	const float *linear = p->linear;
	float *red = p->seen[0] + y * p->across, *green = p->seen[1] + y * p->across;
	float *blue = p->seen[2] + y * p->across;
	const uint8_t *in = picture->origin + y * side * picture->y_step + x * side * 4;

	for (; x < end; x++, in += side * 4) {
		uint64_t ends = 0, middle = 0;

		for (int v = 0; v < side; v++)
			for (int u = 0; u < side; u += 2)
				add_pair(in + v * picture->y_step + u * 4, &ends, &middle);
		ends += ends >> 32;
		middle += middle >> 32;
		red[x] = linear[(ends >> 16 & 0xffff) * each];
		green[x] = linear[(uint32_t)middle * each];
		blue[x] = linear[(ends & 0xffff) * each];
	}
}

static void read_cells(struct people *p, const struct picture *picture, int y, int x, int end)
{
	const int side = p->side;

	if (picture->x_step == 4 && side == 2)
		read_adjacent(p, picture, y, x, end, 2);
	else if (picture->x_step == 4)
		read_adjacent(p, picture, y, x, end, 4);
	else
		for (; x < end; x++)
			read_cell(p, picture, x, y, side, side, CODE_STEPS / (side * side));
}

void cells_read(struct people *p, const struct picture *picture)
{
	const int whole_across = picture->width / p->side, whole_down = picture->height / p->side;

	for (int s = 0; s < p->span_count; s++) {
		const struct span *span = &p->spans[s];
		const int end = span->x + span->count;
		const int inner = span->y < whole_down ? end < whole_across ? end : whole_across
						       : span->x;

		read_cells(p, picture, span->y, span->x, inner);
		for (int x = inner; x < end; x++)
			read_edge_cell(p, picture, x, span->y);
	}
}

/* Variance of the mean of n numbers, over theirs, whose neighbours have this correlation:
 * (1 + 2 sum over k of (1 - k / n) r^k) / n. */
static double mean_share(int n, double correlation)
{
	double sum = 1, power = 1;

	for (int k = 1; k < n; k++) {
		power *= correlation;
		sum += 2 * (1 - (double)k / n) * power;
	}
	return sum / n;
}

void cells_follow_noise(struct people *p, const struct picture *picture)
{
	struct sensor_noise_model model;
	double share;

	sensor_noise_watch(p->sensor, picture);
	if (p->frame % FIT_EVERY || !sensor_noise_fit(p->sensor, &model))
		return;
	share = mean_share(p->side, model.across) * mean_share(p->side, model.down);
	for (int c = 0; c < 3; c++) {
		p->still[c] = (float)(share * model.floor[c]) * WHITE * WHITE + STILL_LEAST;
		p->shot[c] = (float)(share * model.slope[c]) * WHITE;
	}
}

/* Mean ratio of bins from..to. */
static float mean_ratio(const int bins[GAIN_BINS], int from, int to)
{
	float sum = 0, count = 0;

	for (int b = from; b <= to; b++) {
		sum += (float)bins[b] * ((float)b + 0.5f);
		count += (float)bins[b];
	}
	return sum / count * (4.0f / GAIN_BINS);
}

/* The camera's exposure changes all cells alike, so half of them lie close together. Where they do
 * not, something hides the place, and the exposure of before is kept. */
static void take_gain(struct people *p, int c, const int bins[GAIN_BINS], int count)
{
	float narrowest = SCATTER;
	int held = 0, from = 0, best_from = 0, best_to = -1;

	for (int to = 0; to < GAIN_BINS; to++) {
		for (held += bins[to]; 2 * (held - bins[from]) >= count; from++)
			held -= bins[from];
		const float wide = (float)(to + 1 - from) / (0.5f * (float)(to + 1 + from));

		if (2 * held >= count && wide < narrowest) {
			narrowest = wide;
			best_from = from;
			best_to = to;
		}
	}
	if (best_to >= 0)
		p->gain[c] = fminf(fmaxf(mean_ratio(bins, best_from, best_to), 0.125f), 3.9f);
}

static void follow_channel(struct people *p, int c)
{
	const float light = p->light[c][0];
	const int step = p->watched / GAIN_CELLS + 1;
	int bins[GAIN_BINS] = {0}, count = 0;

	for (int s = 0; s < p->span_count; s++) {
		const struct span *span = &p->spans[s];

		for (int x = span->x + span->y % step; x < span->x + span->count; x += step) {
			const int at = span->y * p->across + x;
			const float place = p->lit[c][at] * p->drift[c][at] * light;
			float ratio;

			if (!p->known[at] || p->verdict[at] == VERDICT_PERSON ||
			    place < 0.004f * WHITE || p->seen[c][at] > 0.97f * WHITE)
				continue;
			ratio = p->seen[c][at] / place * (GAIN_BINS / 4.0f);
			bins[ratio < GAIN_BINS - 1 ? (int)ratio : GAIN_BINS - 1]++;
			count++;
		}
	}
	if (count > 100)
		take_gain(p, c, bins, count);
}

void cells_follow_gain(struct people *p)
{
	for (int c = 0; c < 3; c++) {
		follow_channel(p, c);
		for (int s = 0; s < p->span_count; s++) {
			const struct span *span = &p->spans[s];
			const int at = span->y * p->across + span->x, count = span->count;
			const float *restrict lit = p->lit[c] + at, *restrict drift = p->drift[c] +
										      at;
			const float light = p->light[c][0], gain = p->gain[c];
			float *restrict place = p->place[c] + at;

			for (int x = 0; x < count; x++) {
				const float exposed = lit[x] * drift[x] * light * gain;

				place[x] = exposed < WHITE ? exposed : WHITE;
			}
		}
	}
}
