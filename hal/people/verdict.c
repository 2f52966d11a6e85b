/* SPDX-License-Identifier: MIT */
/*
 * Whose each cell is: the place's, a shadow's, or a person's. A cell is explained
 *
 * - by the place, as well as its deviation chi^2 = sum over the channels of
 *   (seen - expected)^2 / s^2 is small, with s^2 of place.c;
 * - by the place in other light, as well as seen / expected has an even slope over those cells
 *   around it that are about as much darker or lighter as it is: texture is kept in a shadow, and
 *   not under cloth. At a shadow's rim these are the cells on its own side;
 * - by a person at a fixed price, as he may have any colour.
 *
 * The better of the first two against the third is the cell's evidence, -1..1. A person is
 * connected, so each cell then weighs in the opinions of the four beside it (the mean-field
 * solution of an Ising model), and its own of the frame before, if it still shows the same.
 */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define DIFFERS 12.0f /* chi-square of three channels: 0.7 % of empty cells are above */
#define PRICE 20.0f   /* of a person, in units of chi-square */
#define SHADOW 6.0f   /* price of other light */
#define SHADOW_STEEP 8.0f
#define STEEP 0.3f  /* evidence per chi-square */
#define AROUND 2     /* cells on each side that tell of other light */
#define ALIKE 0.3f   /* of its ratio, by which a cell around may differ and is asked */
#define FLAT 2.0f    /* cells on a line tell no slope beside it */
#define MOST 0.35f   /* of those around that must be alike */
#define BRIGHTEST 1.5f   /* ratio of light that came on */
#define SAME_COLOUR 1.6f /* ratio of two channels' ratios */
#define UNEVEN 0.08f	 /* of its light, by which a shadow may be off its slope */
#define NEIGHBOUR 0.3f	 /* weight of each of the four opinions beside */
#define MEMORY 0.3f	 /* and of the frame before */
#define SHARP 1.6f
#define PASSES 6

float verdict_weight[VERDICT_CLUES] = {-5.606f, 0.3728f, 0.8022f, 1.755f, 0.7283f, 7.125f, 1.794f, 7.932f, 0.359f, 0.468f, 0.8418f, 0.4727f, -1.156f, -0.3865f, 1.924f, -1.063f};

/* ---- deviation ---- */

static void span_deviations(struct people *p, const struct span *span)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float *restrict spread = p->place.spread + at;
	float *restrict chi = p->verdict.chi + at;

	memset(chi, 0, (size_t)count * sizeof(*chi));
	for (int c = 0; c < 3; c++) {
		const float *restrict expected = p->place.expected[c] + at;
		const float *restrict seen = p->cells.seen[c] + at;
		const float still = p->cells.still[c], shot = p->cells.shot[c];
		const float model = p->place.model_variance;

		for (int x = 0; x < count; x++) {
			const float place = expected[x], off = seen[x] - place;

			chi[x] += off * off /
				  (spread[x] * (still + shot * place) + model * place * place);
		}
	}
}

static void grow_box(struct box *box, int left, int right, int y)
{
	box->left = left < box->left ? left : box->left;
	box->right = right > box->right ? right : box->right;
	box->top = y < box->top ? y : box->top;
	box->bottom = y > box->bottom ? y : box->bottom;
}

/* Cells that differ are a shadow's until they are found to be a person's. */
static void mark_span(struct people *p, const struct span *span)
{
	const int at = span->y * p->cells.across + span->x;
	const float *chi = p->verdict.chi + at;
	const uint8_t *known = p->place.known + at;
	uint8_t *whose = p->verdict.of + at;
	int first = -1, last = -1;

	for (int x = 0; x < span->count; x++) {
		whose[x] = known[x] && chi[x] > DIFFERS ? WHOSE_SHADOW : WHOSE_PLACE;
		if (whose[x] == WHOSE_PLACE)
			continue;
		first = first < 0 ? x : first;
		last = x;
	}
	if (first >= 0)
		grow_box(&p->verdict.differing, span->x + first, span->x + last, span->y);
}

/* ---- other light ---- */

static float weight_at(const struct people *p, int c, int at)
{
	const float place = p->place.expected[c][at];

	return 1 / (p->place.spread[at] * cells_variance(&p->cells, c, place) +
		    p->place.model_variance * place * place);
}

/* seen / expected around a cell, summed over the channels: an even slope by least squares over
 * those cells that are about as bright as it is. */
struct slope {
	int asked, count;
	float middle, across, down; /* of the ratio */
	uint32_t alike;		    /* bit of each cell that is */
};

static float ratio_at(const struct people *p, int at)
{
	const float *const *seen = (const float *const *)p->cells.seen;
	const float *const *place = (const float *const *)p->place.expected;

	return (seen[0][at] + seen[1][at] + seen[2][at]) /
	       (place[0][at] + place[1][at] + place[2][at] + 1);
}

/* Sums of a least-squares fit of a plane. */
struct plane_sums {
	float n, x, y, xx, xy, yy, r, rx, ry;
};

static void fit_slope(struct slope *slope, const struct plane_sums *sums)
{
	const float n = sums->n, mx = sums->x / n, my = sums->y / n, mr = sums->r / n;
	const float xx = sums->xx - n * mx * mx, yy = sums->yy - n * my * my;
	const float xy = sums->xy - n * mx * my;
	const float rx = sums->rx - n * mr * mx, ry = sums->ry - n * mr * my;
	const float whole = xx * yy - xy * xy;

	if (whole > FLAT) {
		slope->across = (rx * yy - ry * xy) / whole;
		slope->down = (ry * xx - rx * xy) / whole;
	}
	slope->middle = mr - slope->across * mx - slope->down * my;
}

static struct slope slope_around(const struct people *p, int x, int y)
{
	const float own = ratio_at(p, y * p->cells.across + x);
	struct slope slope = {.middle = own};
	struct plane_sums sums = {.n = 0};
	uint32_t bit = 1;

	for (int v = -AROUND; v <= AROUND; v++)
		for (int u = -AROUND; u <= AROUND; u++, bit <<= 1) {
			const int there = (y + v) * p->cells.across + x + u;
			float ratio;

			if (y + v < 0 || x + u < 0 || y + v >= p->cells.down ||
			    x + u >= p->cells.across || !p->cells.watch[there] ||
			    !p->place.known[there])
				continue;
			slope.asked++;
			ratio = ratio_at(p, there);
			if (fabsf(ratio - own) > ALIKE * own)
				continue;
			slope.alike |= bit;
			slope.count++;
			sums.n++;
			sums.x += (float)u;
			sums.y += (float)v;
			sums.xx += (float)(u * u);
			sums.xy += (float)(u * v);
			sums.yy += (float)(v * v);
			sums.r += ratio;
			sums.rx += ratio * (float)u;
			sums.ry += ratio * (float)v;
		}
	if (slope.count > 0)
		fit_slope(&slope, &sums);
	return slope;
}

/* In one channel, over the cells that are alike: s = seen, b = expected times the slope. */
struct alike {
	float ss, sb, bb; /* over s^2 of the place */
};

static struct alike sum_alike(const struct people *p, int x, int y, int c, const struct slope *slope)
{
	struct alike sums = {0, 0, 0};
	uint32_t bit = 1;

	for (int v = -AROUND; v <= AROUND; v++)
		for (int u = -AROUND; u <= AROUND; u++, bit <<= 1) {
			const int at = (y + v) * p->cells.across + x + u;
			float seen, lit, w;

			if (!(slope->alike & bit))
				continue;
			w = weight_at(p, c, at);
			seen = p->cells.seen[c][at];
			lit = p->place.expected[c][at] *
			      (slope->middle + slope->across * (float)u + slope->down * (float)v);
			sums.ss += w * seen * seen;
			sums.sb += w * seen * lit;
			sums.bb += w * lit * lit;
		}
	return sums;
}

static float clamp_one(float x)
{
	const float least = x > -1 ? x : -1; /* in two steps, as processors do it */

	return least < 1 ? least : 1;
}

/* How the brightness of all known cells around follows that of the place: sums over them. */
struct texture {
	float n, s, b, ss, sb, bb;
};

static struct texture texture_around(const struct people *p, int x, int y)
{
	struct texture sums = {.n = 0};

	for (int v = y - AROUND; v <= y + AROUND; v++)
		for (int u = x - AROUND; u <= x + AROUND; u++) {
			const int at = v * p->cells.across + u;
			float s, b;

			if (v < 0 || u < 0 || v >= p->cells.down || u >= p->cells.across ||
			    !p->cells.watch[at] || !p->place.known[at])
				continue;
			s = p->cells.seen[0][at] + p->cells.seen[1][at] + p->cells.seen[2][at];
			b = p->place.expected[0][at] + p->place.expected[1][at] +
			    p->place.expected[2][at];
			sums.n++;
			sums.s += s;
			sums.b += b;
			sums.ss += s * s;
			sums.sb += s * b;
			sums.bb += b * b;
		}
	return sums;
}

static float log_of(float x)
{
	return logf(1 + fmaxf(x, 0));
}

void verdict_clues(const struct people *p, int x, int y, float clue[VERDICT_CLUES])
{
	const int at = y * p->cells.across + x;
	const struct slope slope = slope_around(p, x, y);
	const struct texture t = texture_around(p, x, y);
	const float mean_s = t.s / t.n, mean_b = t.b / t.n, ratio_all = mean_s / (mean_b + 1);
	const float var_b = fmaxf(t.bb / t.n - mean_b * mean_b, 0);
	const float var_s = fmaxf(t.ss / t.n - mean_s * mean_s, 0);
	const float cov = t.sb / t.n - mean_s * mean_b;
	const float noise = 3 * (p->place.spread[at] * cells_variance(&p->cells, 1, mean_b / 3) +
				 p->place.model_variance * mean_b * mean_b / 9);
	float left = 0, own = 0, room = 0, low = INFINITY, high = 0;

	for (int c = 0; c < 3; c++) {
		const struct alike sums = sum_alike(p, x, y, c, &slope);
		const float colour = sums.sb / (sums.bb + 1e-6f), ratio = colour * slope.middle;
		const float off = p->cells.seen[c][at] - ratio * p->place.expected[c][at];

		left += sums.ss - colour * sums.sb;
		room += UNEVEN * UNEVEN * sums.ss;
		own += weight_at(p, c, at) * off * off;
		low = ratio < low ? ratio : low;
		high = ratio > high ? ratio : high;
	}
	clue[0] = 1;
	clue[1] = logf(p->verdict.chi[at] / DIFFERS);
	clue[2] = (float)slope.count / (float)slope.asked;
	clue[3] = log_of(left / (room + 3.0f * (float)(slope.count > 2 ? slope.count - 2 : 1)) - 1);
	clue[4] = log_of(own / (1 + room / (3 * (float)slope.count)));
	clue[5] = fmaxf(logf(p->place.darkest / fmaxf(slope.middle, 0.01f)), 0);
	clue[6] = fmaxf(logf(fmaxf(slope.middle, 0.01f)), 0);
	clue[7] = logf((high + 0.01f) / (fmaxf(low, 0) + 0.01f));
	clue[8] = log_of(var_b / noise) *
		  clamp_one(1 - cov / (ratio_all * var_b + noise + 1));
	clue[9] = log_of((var_s - cov * cov / (var_b + 1)) / noise);
	clue[10] = log_of(10 * (fabsf(slope.across) + fabsf(slope.down)) / slope.middle);
	clue[11] = p->cells.still_ms[at] > 0 ? p->verdict.last[at] : 0;
	clue[12] = p->cells.still_ms[at] > 0;
	clue[13] = log_of(var_b / noise);
	clue[14] = fabsf(logf(fmaxf(slope.middle, 0.01f)));
	clue[15] = clue[3] * clue[3];
}

/* ---- evidence and opinion ---- */

static float evidence_of(const struct people *p, int x, int y)
{
	const int at = y * p->cells.across + x;
	float clue[VERDICT_CLUES], sum = 0;

	if (!p->place.known[at] || p->verdict.of[at] == WHOSE_PLACE)
		return -1;
	verdict_clues(p, x, y, clue);
	for (int n = 0; n < VERDICT_CLUES; n++)
		sum += clue[n] * verdict_weight[n];
	return clamp_one(sum * STEEP);
}

/* Calls for each stretch of watched cells in a box, row by row. */
static void walk_box(struct people *p, const struct box *box,
		     void (*take)(struct people *p, int y, int x, int end))
{
	for (int y = box->top; y <= box->bottom; y++)
		for (int s = p->cells.row_span[y]; s < p->cells.row_span[y + 1]; s++) {
			const struct span *span = &p->cells.spans[s];
			const int x = span->x > box->left ? span->x : box->left;
			const int end = span->x + span->count;

			take(p, y, x, end <= box->right ? end : box->right + 1);
		}
}

static void gather_evidence(struct people *p, int y, int x, int end)
{
	for (; x < end; x++) {
		const int at = y * p->cells.across + x;

		p->verdict.evidence[at] = evidence_of(p, x, y);
	}
}

static void begin_opinions(struct people *p, int y, int x, int end)
{
	for (; x < end; x++) {
		const int at = y * p->cells.across + x;

		p->verdict.opinion[at] = clamp_one(p->verdict.evidence[at]);
	}
}

static void revise(struct people *p, int y, int x, int end)
{
	const int across = p->cells.across, row = y * across;
	const float *restrict evidence = p->verdict.evidence + row;
	const float *restrict own = p->verdict.opinion + row;
	const float *above = own - across, *below = own + across;
	float *restrict revised = p->verdict.revised + row;

	for (; x < end; x++)
		revised[x] = clamp_one(SHARP * (evidence[x] +
						NEIGHBOUR * (own[x - 1] + own[x + 1] + above[x] +
							     below[x])));
}

static void decide(struct people *p, int y, int x, int end)
{
	for (; x < end; x++) {
		const int at = y * p->cells.across + x;

		if (p->verdict.opinion[at] <= 0)
			continue;
		p->verdict.of[at] = WHOSE_PERSON;
		grow_box(&p->verdict.box, x, x, y);
	}
}

static void form_opinions(struct people *p, const struct box *box)
{
	memcpy(p->verdict.last, p->verdict.opinion, (size_t)p->cells.count * sizeof(float));
	walk_box(p, box, gather_evidence);
	for (int at = 0; at < p->cells.count; at++)
		p->verdict.opinion[at] = p->verdict.revised[at] = -1;
	walk_box(p, box, begin_opinions);
	for (int pass = 0; pass < PASSES; pass++) {
		float *revised = p->verdict.revised;

		walk_box(p, box, revise);
		p->verdict.revised = p->verdict.opinion;
		p->verdict.opinion = revised;
	}
	walk_box(p, box, decide);
}

/* A box with two cells around it, as a person may be a little wider than what differs. */
static struct box around(const struct people *p, const struct box *box)
{
	const struct box grown = {box->left > AROUND ? box->left - AROUND : 0,
				  box->right + AROUND < p->cells.across ? box->right + AROUND
									: p->cells.across - 1,
				  box->top > AROUND ? box->top - AROUND : 0,
				  box->bottom + AROUND < p->cells.down ? box->bottom + AROUND
								       : p->cells.down - 1};

	return grown;
}

/* In a frame in which a lamp was switched the prediction is off, and people have hardly moved:
 * everybody is where he was. */
static void keep_verdict(struct people *p)
{
	memcpy(p->verdict.of, p->verdict.before, (size_t)p->cells.count);
	for (int at = 0; at < p->cells.count; at++)
		if (p->verdict.of[at] == WHOSE_PERSON)
			grow_box(&p->verdict.box, at % p->cells.across, at % p->cells.across,
				 at / p->cells.across);
}

void verdict_judge(struct people *p)
{
	const struct box none = {p->cells.across, -1, p->cells.down, -1};

	memcpy(p->verdict.before, p->verdict.of, (size_t)p->cells.count);
	p->verdict.differing = p->verdict.box = none;
	for (int s = 0; s < p->cells.span_count; s++) {
		span_deviations(p, &p->cells.spans[s]);
		mark_span(p, &p->cells.spans[s]);
	}
	if (p->place.jumped) {
		keep_verdict(p);
	} else if (p->verdict.differing.right >= 0) {
		const struct box box = around(p, &p->verdict.differing);

		form_opinions(p, &box);
	} else {
		for (int at = 0; at < p->cells.count; at++)
			p->verdict.opinion[at] = -1;
	}
}
