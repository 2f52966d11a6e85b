/* SPDX-License-Identifier: MIT */
/*
 * Whether the camera was nudged. Patches of the place are sought in the picture, a few in each
 * frame, by the correlation of their gradients,
 *
 *     r(s) = sum_x <t(x), g(x + s)> / sqrt(sum_x |t(x)|^2  sum_x |g(x + s)|^2)
 *
 * t: of the place as learned, g: of what is seen; neither lamps nor exposure change it much. Once
 * all have been asked, the shift on which most agree counts if the round before said the same.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define ROUND_MS 500.0	 /* in which all patches are asked */
#define MOVED_LEAST 0.5f /* pixels, and of a cell 0.2: what one round is off by */
#define ALIKE 0.35f	 /* of a cell, by which shifts may differ that agree */
#define MATCH 0.5f	 /* correlation of a patch that is found; with another place it is 0.3 */
#define DISTINCT 0.1f	 /* by which it is above that of any shift elsewhere: no pattern repeats */
#define TEXTURE 4.0f	 /* a patch's weaker gradient, over the noise's: it tells both directions */
#define SCATTER 61 /* patches from one to the next that is asked: a prime, so all have their turn */
#define SURE_PATCHES 48 /* in the mean of which are where they were learned, or a third of all */
#define ROUND 0.05f   /* and over both: else the stronger one's errors are the weaker one's shift */
#define FOUND_LEAST 8 /* patches that agree */
#define FOUND_SHARE 0.1f /* of those that have texture: others may be hidden */

enum { SIDE = 8, REACH = 8, SHIFTS = 2 * REACH + 1, WINDOW = SIDE + 2 * REACH };

/* What is asked of a patch: its gradients, and those of what is seen around it. */
struct sought {
	float across[SIDE * SIDE], down[SIDE * SIDE], energy;
	float seen_across[WINDOW][WINDOW], seen_down[WINDOW][WINDOW];
	float match[SHIFTS][SHIFTS]; /* by shift; from REACH - reach to REACH + reach */
};

void nudge_place(struct people *p)
{
	const int across = p->cells.across, down = p->cells.down, beyond = REACH + SIDE + 1;
	int step = 1, count;

	do {
		count = 0;
		for (int y = REACH + 1; y + beyond <= down; y += SIDE * step)
			for (int x = REACH + 1; x + beyond <= across; x += SIDE * step) {
				const int middle = (y + SIDE / 2) * across + x + SIDE / 2;

				if (p->cells.watch[middle] && count++ < NUDGE_PATCHES)
					p->nudge.patch[count - 1] = y * across + x;
			}
		step++;
	} while (count > NUDGE_PATCHES);
	p->nudge.patches = count % SCATTER ? count : count - (count > 0);
	p->nudge.next = p->nudge.usable = p->nudge.votes = 0;
}

/* False: it is not all known, or noise hides its texture. */
static bool take_patch(const struct people *p, int patch, struct sought *sought)
{
	const int across = p->cells.across;
	const float *lit = p->place.lit[1];
	const uint8_t *known = p->place.known;
	const float unit = p->place.gain[1] * p->place.light[1][0];
	float xx = 0, yy = 0, xy = 0, mean = 0, noise;

	for (int k = 0; k < SIDE * SIDE; k++) {
		const int at = patch + k / SIDE * across + k % SIDE;
		const float dx = lit[at + 1] - lit[at - 1],
			    dy = lit[at + across] - lit[at - across];

		if (!(known[at - 1] & known[at + 1] & known[at - across] & known[at + across]))
			return false;
		sought->across[k] = dx;
		sought->down[k] = dy;
		xx += dx * dx;
		yy += dy * dy;
		xy += dx * dy;
		mean += lit[at] * unit / (SIDE * SIDE);
	}
	sought->energy = xx + yy;
	/* The noise of two cells differs by this much in the sum over the patch. */
	noise = 2 * SIDE * SIDE * CELLS_RECENT_NOISE * cells_variance(&p->cells, 1, mean) /
		(unit * unit);
	/* The smaller eigenvalue is about the determinant over the trace. */
	return xx * yy - xy * xy > fmaxf(TEXTURE * noise, ROUND * (xx + yy)) * (xx + yy);
}

static void read_window(const struct people *p, int patch, int reach, struct sought *sought)
{
	const float *seen = p->cells.recent[1] + patch - REACH * (p->cells.across + 1);

	for (int y = REACH - reach; y < REACH + reach + SIDE; y++)
		for (int x = REACH - reach; x < REACH + reach + SIDE; x++) {
			const float *at = seen + y * p->cells.across + x;

			sought->seen_across[y][x] = at[1] - at[-1];
			sought->seen_down[y][x] = at[p->cells.across] - at[-p->cells.across];
		}
}

/* The correlations for shifts of a row: v in -reach..reach. */
static void match_row(struct sought *sought, int v, int reach)
{
	const int first = REACH - reach, count = 2 * reach + 1;
	float both[SHIFTS] = {0}, energy[SHIFTS] = {0};

	for (int k = 0; k < SIDE * SIDE; k++) {
		const float across = sought->across[k], down = sought->down[k];
		const int y = REACH + v + k / SIDE, x = first + k % SIDE;
		const float *restrict gx = &sought->seen_across[y][x];
		const float *restrict gy = &sought->seen_down[y][x];

		for (int s = 0; s < count; s++) {
			both[s] += across * gx[s] + down * gy[s];
			energy[s] += gx[s] * gx[s] + gy[s] * gy[s];
		}
	}
	for (int s = 0; s < count; s++)
		sought->match[REACH + v][first + s] = both[s] /
						      sqrtf(energy[s] * sought->energy + 1e-6f);
}

/* The vertex of the parabola through three values of which the middle one is the largest. */
static float vertex(float before, float at, float after)
{
	const float bend = before + after - 2 * at;

	return bend < 0 ? 0.5f * (before - after) / bend : 0;
}

/* Seeks a patch up to `reach` cells away. False: it is seen nowhere, or in more than one place. */
static bool seek(struct sought *sought, const struct people *p, int patch, int reach, float at[2])
{
	const int low = REACH - reach, high = REACH + reach;
	int bx = REACH, by = REACH;
	float best = -1, other = -1;

	read_window(p, patch, reach, sought);
	for (int v = -reach; v <= reach; v++)
		match_row(sought, v, reach);
	for (int y = low; y <= high; y++)
		for (int x = low; x <= high; x++)
			if (sought->match[y][x] > best) {
				best = sought->match[y][x];
				bx = x;
				by = y;
			}
	for (int y = low; y <= high; y++)
		for (int x = low; x <= high; x++)
			if (abs(x - bx) > 1 || abs(y - by) > 1)
				other = fmaxf(other, sought->match[y][x]);
	if (best < MATCH || best < other + DISTINCT || bx == low || bx == high || by == low ||
	    by == high)
		return false;
	at[0] = (float)(bx - REACH) +
		vertex(sought->match[by][bx - 1], best, sought->match[by][bx + 1]);
	at[1] = (float)(by - REACH) +
		vertex(sought->match[by - 1][bx], best, sought->match[by + 1][bx]);
	return true;
}

static void ask_patch(struct people *p, int patch)
{
	struct nudge *nudge = &p->nudge;
	struct sought sought;
	float *vote = nudge->vote[nudge->votes];
	bool is_there;

	if (!take_patch(p, patch, &sought))
		return;
	nudge->usable++;
	is_there = seek(&sought, p, patch, 1, vote);
	nudge->sure += ((float)is_there - nudge->sure) *
		       fmaxf(1.0f / SURE_PATCHES, 3.0f / (float)nudge->patches);
	/* Where half of the patches are found, others are hidden, and need no wide search. */
	nudge->votes += is_there ||
			(2 * nudge->votes < nudge->usable && seek(&sought, p, patch, REACH, vote));
}

static bool are_alike(const float a[2], const float b[2])
{
	return fabsf(a[0] - b[0]) < ALIKE && fabsf(a[1] - b[1]) < ALIKE;
}

/* The mean of the votes that are alike, around that which has most. Returns how many there are. */
static int count_votes(const struct nudge *nudge, float shift[2])
{
	int most = 0;

	for (int n = 0; n < nudge->votes; n++) {
		float sum[2] = {0, 0};
		int alike = 0;

		for (int m = 0; m < nudge->votes; m++) {
			if (!are_alike(nudge->vote[n], nudge->vote[m]))
				continue;
			alike++;
			sum[0] += nudge->vote[m][0];
			sum[1] += nudge->vote[m][1];
		}
		if (alike <= most)
			continue;
		most = alike;
		shift[0] = sum[0] / (float)alike;
		shift[1] = sum[1] / (float)alike;
	}
	return most;
}

static void take_shift(struct people *p, const float shift[2])
{
	struct nudge *nudge = &p->nudge;
	const float side = (float)p->cells.side;
	float moved[2];

	for (int k = 0; k < 2; k++)
		moved[k] = nudge->moved[k] + shift[k] * side;
	nudge->lost = hypotf(moved[0], moved[1]) > NUDGE_MOST;
	memcpy(nudge->told, moved, sizeof(moved));
	if (nudge->lost || hypotf(shift[0], shift[1]) < fmaxf(MOVED_LEAST / side, 0.2f))
		return;
	place_move(p, shift);
	memcpy(nudge->moved, moved, sizeof(moved));
}

static void end_round(struct people *p)
{
	struct nudge *nudge = &p->nudge;
	float shift[2] = {0, 0};
	const int found = count_votes(nudge, shift);
	const bool is_told = found >= FOUND_LEAST && 2 * found > nudge->votes &&
			     (float)found > FOUND_SHARE * (float)nudge->usable;

	if (is_told && are_alike(shift, nudge->before))
		take_shift(p, shift);
	memcpy(nudge->before, shift, sizeof(shift));
	nudge->next = nudge->usable = nudge->votes = 0;
}

void nudge_follow(struct people *p)
{
	struct nudge *nudge = &p->nudge;
	const int asked = (int)(nudge->patches * fmin(p->step_ms / ROUND_MS, 1)) + 1;

	for (int n = 0; n < asked && nudge->next < nudge->patches; n++)
		ask_patch(p, nudge->patch[nudge->next++ * SCATTER % nudge->patches]);
	if (nudge->next >= nudge->patches)
		end_round(p);
}
