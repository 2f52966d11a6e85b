/* SPDX-License-Identifier: MIT */
/*
 * Decides for each cell whether it is the place's, a shadow's or a person's. A cell differs where
 * chi^2 = sum over the channels of (seen - expected)^2 / s^2 is large, with s^2 of place.c. Clues
 * then tell how likely it is a person's:
 *
 * - how well the place in other light explains the cells around: an even slope of seen / expected,
 *   of one colour, over those that are about as much darker or lighter, as on one side of a
 *   shadow's rim; a shadow keeps the place's texture, and cloth has another;
 * - whether it is darker than a shadow can be in the light that is measured, or lighter;
 * - whether it has just changed, and what it was in the frame before.
 *
 * A person is connected, so each cell then weighs in the opinions of the four beside it (the
 * mean-field solution of an Ising model).
 */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

/* Halving or doubling ALIKE, UNEVEN, STEEP, NEIGHBOUR, SHARP or PASSES changes the wrong pixels of
 * rooms 0 and 4 (tests/people) by 5 % at most, but for ALIKE 0.6: 10 %. */
#define DIFFERS 12.0f  /* chi-square of three channels: 0.7 % of empty cells are above */
#define AROUND 2       /* cells on each side that tell of other light */
#define WINDOW 13      /* of these (2 AROUND + 1)^2: every other one, as on a chess board */
#define ALIKE 0.3f     /* of its ratio, by which a cell around may differ and is asked */
#define FLAT 2.0f      /* cells on a line tell no slope beside it */
#define UNEVEN 0.08f   /* of its light, by which a shadow may be off its slope */
#define STEEP 0.3f     /* evidence per logit */
#define NEIGHBOUR 0.3f /* weight of each of the four opinions beside */
#define SHARP 1.6f     /* slope of an opinion, which is clamped, over the sum of these */
#define PASSES 3       /* in which opinions settle */

/* A cell's logit is the sum of its clues by these: a logistic regression of the truth on the clues,
 * over the rooms that are there to choose on (tests/people/fit.c). */
static const float clue_weight[VERDICT_CLUES] = {
	-8.156f, 0.1133f, 1.174f, 0.5819f,  17.22f,  -0.05164f, 0.09868f, 0.4239f,
	3.894f,	 3.195f,  7.608f, -0.9414f, 0.8562f, 1.723f,	1.0f,	  -1.077f,
};

/* ---- deviation ---- */

static void channel_weights(const struct people *p, const struct span *span, int c)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float *restrict spread = p->place.spread + at;
	const float *restrict expected = p->place.expected[c] + at;
	const float still = p->cells.still[c], shot = p->cells.shot[c];
	const float model = p->place.model_variance;
	float *restrict weight = p->verdict.weight[c] + at;

	for (int x = 0; x < count; x++) {
		const float place = expected[x];

		weight[x] = 1 / (spread[x] * (still + shot * place) + model * place * place);
	}
}

static void sum_channels(float *const plane[3], int at, int count, float *restrict sum)
{
	const float *restrict r = plane[0] + at, *restrict g = plane[1] + at;
	const float *restrict b = plane[2] + at;

	for (int x = 0; x < count; x++)
		sum[x] = r[x] + g[x] + b[x];
}

static void divide_sums(struct people *p, int at, int count)
{
	const float *restrict bright = p->verdict.bright + at, *restrict lit = p->verdict.lit + at;
	float *restrict ratio = p->verdict.ratio + at;

	for (int x = 0; x < count; x++)
		ratio[x] = bright[x] / (lit[x] + 1);
}

/* Also prepares what other cells will ask about these: weights, and brightness. */
static void span_deviations(struct people *p, const struct span *span)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	float *restrict chi = p->verdict.chi + at;

	memset(chi, 0, (size_t)count * sizeof(*chi));
	for (int c = 0; c < 3; c++) {
		const float *restrict expected = p->place.expected[c] + at;
		const float *restrict seen = p->cells.seen[c] + at;
		const float *restrict weight = p->verdict.weight[c] + at;

		channel_weights(p, span, c);
		for (int x = 0; x < count; x++)
			chi[x] += (seen[x] - expected[x]) * (seen[x] - expected[x]) * weight[x];
	}
	sum_channels(p->cells.seen, at, count, p->verdict.bright + at);
	sum_channels(p->place.expected, at, count, p->verdict.lit + at);
	divide_sums(p, at, count);
}

static void grow_box(struct box *box, int left, int right, int y)
{
	box->left = left < box->left ? left : box->left;
	box->right = right > box->right ? right : box->right;
	box->top = y < box->top ? y : box->top;
	box->bottom = y > box->bottom ? y : box->bottom;
}

/* Cells that differ are a shadow's, which is 1, until they are found to be a person's. */
static void mark_span(struct people *p, const struct span *span)
{
	const int at = span->y * p->cells.across + span->x;
	const float *restrict chi = p->verdict.chi + at;
	const uint8_t *restrict known = p->place.known + at;
	uint8_t *restrict whose = p->verdict.of + at;
	int first = 0, last = span->count - 1;

	for (int x = 0; x < span->count; x++)
		whose[x] = (uint8_t)((chi[x] > DIFFERS) & (known[x] != 0));
	while (first <= last && !whose[first])
		first++;
	while (last > first && !whose[last])
		last--;
	if (first <= last)
		grow_box(&p->verdict.differing, span->x + first, span->x + last, span->y);
}

/* ---- clues ---- */

/* The known cells around one, and of them those that are about as bright against the place. */
struct window {
	int known, alike;
	int at[WINDOW]; /* of those that are alike */
	float across[WINDOW], down[WINDOW];
	float middle, slope_across, slope_down; /* of seen / place, by least squares over these */
	/* Moments of seen and place, over all known ones. */
	float mean_seen, mean_place, seen2, seen_place, place2;
};

/* Sums of a least-squares fit of a plane. */
struct plane_sums {
	float x, y, xx, xy, yy, r, rx, ry;
};

static void fit_slope(struct window *w, const struct plane_sums *sums)
{
	const float n = (float)w->alike, mx = sums->x / n, my = sums->y / n, mr = sums->r / n;
	const float xx = sums->xx - n * mx * mx, yy = sums->yy - n * my * my;
	const float xy = sums->xy - n * mx * my;
	const float rx = sums->rx - n * mr * mx, ry = sums->ry - n * mr * my;
	const float whole = xx * yy - xy * xy;

	if (whole > FLAT) {
		w->slope_across = (rx * yy - ry * xy) / whole;
		w->slope_down = (ry * xx - rx * xy) / whole;
	}
	w->middle = mr - w->slope_across * mx - w->slope_down * my;
	w->middle = w->middle > 0.01f ? w->middle : 0.01f;
}

static void add_to_window(struct window *w, struct plane_sums *sums, const struct people *p, int at,
			  float u, float v, float own)
{
	const float seen = p->verdict.bright[at], place = p->verdict.lit[at];
	const float ratio = p->verdict.ratio[at];

	w->known++;
	w->mean_seen += seen;
	w->mean_place += place;
	w->seen2 += seen * seen;
	w->seen_place += seen * place;
	w->place2 += place * place;
	if (fabsf(ratio - own) > ALIKE * own)
		return;
	w->at[w->alike] = at;
	w->across[w->alike] = u;
	w->down[w->alike] = v;
	w->alike++;
	sums->x += u;
	sums->y += v;
	sums->xx += u * u;
	sums->xy += u * v;
	sums->yy += v * v;
	sums->r += ratio;
	sums->rx += ratio * u;
	sums->ry += ratio * v;
}

static void look_around(const struct people *p, int x, int y, struct window *w)
{
	const int middle = y * p->cells.across + x;
	const float own = p->verdict.ratio[middle];
	struct plane_sums sums = {0};
	float n;

	memset(w, 0, offsetof(struct window, at));
	w->slope_across = w->slope_down = 0;
	w->mean_seen = w->mean_place = w->seen2 = w->seen_place = w->place2 = 0;
	for (int v = -AROUND; v <= AROUND; v++)
		for (int u = -AROUND + ((v + AROUND) & 1); u <= AROUND; u += 2) {
			const int at = middle + v * p->cells.across + u;

			if (y + v < 0 || x + u < 0 || y + v >= p->cells.down ||
			    x + u >= p->cells.across || !p->cells.watch[at] || !p->place.known[at])
				continue;
			add_to_window(w, &sums, p, at, (float)u, (float)v, own);
		}
	fit_slope(w, &sums);
	n = (float)w->known;
	w->mean_seen /= n;
	w->mean_place /= n;
	w->seen2 = w->seen2 / n - w->mean_seen * w->mean_seen;
	w->seen_place = w->seen_place / n - w->mean_seen * w->mean_place;
	w->place2 = w->place2 / n - w->mean_place * w->mean_place;
}

/* What the place in other light, of an even slope and one colour, leaves of what is seen. */
struct residue {
	float around, own; /* of the cells that are alike, of the cell: chi-square over its mean */
	float colour;	   /* ratio of the two channels that changed most differently */
};

static struct residue find_residue(const struct people *p, int middle, const struct window *w)
{
	const float count = (float)w->alike;
	float left = 0, own = 0, room = 0, low = INFINITY, high = 0;

	for (int c = 0; c < 3; c++) {
		const float *seen = p->cells.seen[c], *expected = p->place.expected[c];
		const float *weight = p->verdict.weight[c];
		float ss = 0, sb = 0, bb = 1e-6f, ratio, off;

		for (int n = 0; n < w->alike; n++) {
			const int at = w->at[n];
			const float s = seen[at], share = weight[at];
			const float b = expected[at] * (w->middle + w->slope_across * w->across[n] +
							w->slope_down * w->down[n]);

			ss += share * s * s;
			sb += share * s * b;
			bb += share * b * b;
		}
		ratio = sb / bb * w->middle;
		off = seen[middle] - ratio * expected[middle];
		left += ss - sb * sb / bb;
		room += UNEVEN * UNEVEN * ss;
		own += weight[middle] * off * off;
		low = ratio < low ? ratio : low;
		high = ratio > high ? ratio : high;
	}
	/* Each cell leaves 3 of it to noise, but for what the fit took. */
	return (struct residue){left / (room + 3 * (count > 2 ? count - 2 : 1)) - 1,
				own / (1 + room / (3 * count)),
				(high + 0.01f) / ((low > 0 ? low : 0) + 0.01f)};
}

static float clamp_one(float x)
{
	const float least = x > -1 ? x : -1; /* in two steps, as processors do it */

	return least < 1 ? least : 1;
}

static float log_of(float x)
{
	return logf(1 + (x > 0 ? x : 0));
}

void verdict_clues(const struct people *p, int x, int y, float clue[VERDICT_CLUES])
{
	const int at = y * p->cells.across + x;
	const bool still = p->cells.still_ms[at] > 0;
	struct window w;
	struct residue left;
	float noise, light, texture, kept;

	look_around(p, x, y, &w);
	left = find_residue(p, at, &w);
	light = logf(w.middle);
	noise = 3 / p->verdict.weight[1][at];
	texture = log_of(w.place2 / noise);
	kept = w.seen_place / (w.mean_seen / (w.mean_place + 1) * w.place2 + noise);
	clue[0] = 1;
	clue[1] = logf(p->verdict.chi[at] / DIFFERS);
	clue[2] = log_of(left.around);
	clue[3] = log_of(left.own);
	clue[4] = logf(left.colour);
	clue[5] = texture;
	clue[6] = texture * clamp_one(1 - kept);
	clue[7] = log_of((w.seen2 - w.seen_place * w.seen_place / (w.place2 + 1)) / noise);
	clue[8] = light > 0 ? light : 0;
	clue[9] = light < 0 ? -light : 0;
	clue[10] = p->place.log_darkest > light ? p->place.log_darkest - light : 0;
	clue[11] = still;
	clue[12] = still ? p->verdict.last[at] : 0;
	clue[13] = (float)w.alike / (float)w.known;
	clue[14] = log_of(10 * (fabsf(w.slope_across) + fabsf(w.slope_down)) / w.middle);
	clue[15] = clue[2] * clue[2];
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
		sum += clue[n] * clue_weight[n];
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

/* Every other cell, as on a chess board, is asked, */
static void gather_evidence(struct people *p, int y, int x, int end)
{
	for (; x < end; x++) {
		const int at = y * p->cells.across + x;

		p->verdict.evidence[at] = (x + y) & 1 ? -1 : evidence_of(p, x, y);
	}
}

/* and the others are as those of the four beside them that differ from the place. */
static void fill_evidence(struct people *p, int y, int x, int end)
{
	const int beside[4] = {-1, 1, -p->cells.across, p->cells.across};

	for (x += (x + y + 1) & 1; x < end; x += 2) {
		const int at = y * p->cells.across + x;
		float sum = 0;
		int count = 0;

		if (!p->place.known[at] || p->verdict.of[at] == WHOSE_PLACE)
			continue;
		for (int n = 0; n < 4; n++)
			if (at + beside[n] >= 0 && at + beside[n] < p->cells.count &&
			    p->verdict.of[at + beside[n]] != WHOSE_PLACE) {
				sum += p->verdict.evidence[at + beside[n]];
				count++;
			}
		p->verdict.evidence[at] = count ? sum / (float)count : evidence_of(p, x, y);
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
		revised[x] = clamp_one(SHARP * (evidence[x] + NEIGHBOUR * (own[x - 1] + own[x + 1] +
									   above[x] + below[x])));
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
	float *before = p->verdict.last;

	p->verdict.last = p->verdict.opinion;
	p->verdict.opinion = before;
	walk_box(p, box, gather_evidence);
	walk_box(p, box, fill_evidence);
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

/* Two cells around a box, too, as a person may be a little wider than what differs. */
static void widen(const struct people *p, struct box *box)
{
	grow_box(box, box->left > AROUND ? box->left - AROUND : 0,
		 box->right + AROUND < p->cells.across ? box->right + AROUND : p->cells.across - 1,
		 box->top > AROUND ? box->top - AROUND : 0);
	grow_box(box, box->left, box->right,
		 box->bottom + AROUND < p->cells.down ? box->bottom + AROUND : p->cells.down - 1);
}

void verdict_judge(struct people *p)
{
	const struct box none = {p->cells.across, -1, p->cells.down, -1};

	p->verdict.differing = p->verdict.box = none;
	for (int s = 0; s < p->cells.span_count; s++) {
		span_deviations(p, &p->cells.spans[s]);
		mark_span(p, &p->cells.spans[s]);
	}
	if (p->verdict.differing.right >= 0) {
		widen(p, &p->verdict.differing);
		form_opinions(p, &p->verdict.differing);
	} else {
		for (int at = 0; at < p->cells.count; at++)
			p->verdict.opinion[at] = -1;
	}
}
