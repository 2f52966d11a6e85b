/* SPDX-License-Identifier: MIT */
/* From the picture to cells, their noise, and for how long they have shown the same. */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define ROWS 4	      /* of pixels, which are read of a cell at most: their mean is quiet enough */
#define WATCH_EVERY 2 /* frames */
#define FIT_EVERY 16
#define CHANGED 25.0f /* chi-square of three channels: one cell in 10^5 by noise alone */
#define STEADY 0.012f /* of its light, by which a still cell of a compressed film varies */
#define RECENT 0.125f /* share of a frame in the mean of what a cell shows */
#define STILL_MOST 60000
#define STILL_LEAST                                                                                \
	6000.0f /* variance of a cell: rounding, and what a model is off by in the dark */

/* The rows of pixels that are read of a cell: few of a large one, as light is a mean anyway. */
static inline int rows_apart(int side)
{
	return side > ROWS ? side / ROWS : 1;
}

/* sum: of the code values of so many pixels. */
static inline void take_sums(struct people *p, int at, uint32_t red, uint32_t green, uint32_t blue,
			     uint32_t pixels)
{
	p->cells.seen[0][at] = p->cells.linear[red * CODE_STEPS / pixels];
	p->cells.seen[1][at] = p->cells.linear[green * CODE_STEPS / pixels];
	p->cells.seen[2][at] = p->cells.linear[blue * CODE_STEPS / pixels];
}

/* Reads side x side pixels from a cell's corner on. Sums of 64 codes fit into halves of words. */
static void read_cell(struct people *p, const struct picture *picture, int x, int y, int side)
{
	const uint8_t *in = picture->origin + y * p->cells.side * picture->y_step +
			    x * p->cells.side * picture->x_step;
	const int apart = rows_apart(side);
	uint32_t ends = 0, middle = 0; /* blue and red, green */

	for (int v = 0; v < side; v += apart)
		for (int u = 0; u < side; u++) {
			uint32_t pixel;

			memcpy(&pixel, in + v * picture->y_step + u * picture->x_step,
			       sizeof(pixel));
			ends += pixel & 0x00ff00ff;
			middle += (pixel >> 8) & 0x000000ff;
		}
	take_sums(p, y * p->cells.across + x, ends >> 16, middle, ends & 0xffff,
		  (uint32_t)(side * side / apart));
}

/* A cell that the picture's edge may cut. */
static void read_edge_cell(struct people *p, const struct picture *picture, int x, int y)
{
	const int wide = picture->width - x * p->cells.side,
		  high = picture->height - y * p->cells.side;
	const int cut = wide < high ? wide : high;

	read_cell(p, picture, x, y, cut < p->cells.side ? 1 : p->cells.side);
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
	const uint8_t *in = picture->origin + y * side * picture->y_step + x * side * 4;
	const int apart = rows_apart(side);

	for (; x < end; x++, in += side * 4) {
		uint64_t ends = 0, middle = 0;

		for (int v = 0; v < side; v += apart)
			for (int u = 0; u < side; u += 2)
				add_pair(in + v * picture->y_step + u * 4, &ends, &middle);
		ends += ends >> 32;
		middle += middle >> 32;
		take_sums(p, y * p->cells.across + x, ends >> 16 & 0xffff, (uint32_t)middle,
			  ends & 0xffff, (uint32_t)(side * side / apart));
	}
}

/* The sides are constants where they are usual, for the compiler. */
static void read_cells(struct people *p, const struct picture *picture, int y, int x, int end)
{
	const int side = p->cells.side;

	if (picture->x_step != 4)
		for (; x < end; x++)
			read_cell(p, picture, x, y, side);
	else if (side == 2)
		read_adjacent(p, picture, y, x, end, 2);
	else if (side == 4)
		read_adjacent(p, picture, y, x, end, 4);
	else if (side == 8)
		read_adjacent(p, picture, y, x, end, 8);
	else
		read_adjacent(p, picture, y, x, end, side);
}

void cells_read(struct people *p, const struct picture *picture)
{
	const int whole_across = picture->width / p->cells.side,
		  whole_down = picture->height / p->cells.side;

	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];
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
	const int apart = rows_apart(p->cells.side);
	struct sensor_noise_model model;
	double share;

	if (p->frame % WATCH_EVERY == 0)
		sensor_noise_watch(p->cells.sensor, picture);
	if (p->frame % FIT_EVERY || !sensor_noise_fit(p->cells.sensor, &model))
		return;
	share = mean_share(p->cells.side, model.across) *
		mean_share(p->cells.side / apart, pow(model.down, apart));
	for (int c = 0; c < 3; c++) {
		p->cells.still[c] = (float)(share * model.floor[c]) * WHITE * WHITE + STILL_LEAST;
		p->cells.shot[c] = (float)(share * model.slope[c]) * WHITE;
	}
}

/* The cells of a span against what they showed: chi-square by the noise of both. */
static void span_changes(const struct people *p, const struct span *span, float *restrict chi)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float model = STEADY * STEADY + p->place.model_variance;

	memset(chi, 0, (size_t)count * sizeof(*chi));
	for (int c = 0; c < 3; c++) {
		const float unit = p->place.gain[c] * p->place.light[c][0];
		const float still = p->cells.still[c], shot = p->cells.shot[c];
		const float *restrict seen = p->cells.seen[c] + at;
		const float *restrict recent = p->cells.recent[c] + at;

		for (int x = 0; x < count; x++) {
			const float was = recent[x] * unit, off = seen[x] - was;

			chi[x] += off * off / (still + shot * was + model * was * was);
		}
	}
}

void cells_follow_stillness(struct people *p)
{
	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];
		const int at = span->y * p->cells.across + span->x, count = span->count;
		uint16_t *restrict still_ms = p->cells.still_ms + at;
		float *chi = p->verdict.chi + at; /* which is made anew after this */

		span_changes(p, span, chi);
		for (int c = 0; c < 3; c++) {
			const float per_unit = 1 / (p->place.gain[c] * p->place.light[c][0]);
			const float *restrict seen = p->cells.seen[c] + at;
			float *restrict recent = p->cells.recent[c] + at;

			for (int x = 0; x < count; x++) {
				const float share = chi[x] <= CHANGED ? RECENT : 1;

				recent[x] += share * (seen[x] * per_unit - recent[x]);
			}
		}
		for (int x = 0; x < count; x++) {
			const int ms = still_ms[x] + (int)p->step_ms;

			still_ms[x] = (uint16_t)(chi[x] <= CHANGED
							 ? ms < STILL_MOST ? ms : STILL_MOST
							 : 0);
		}
	}
}
