/* SPDX-License-Identifier: MIT */
#include "bake/exchange/import_fit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/*
 * Thresholds for what is judged below. Measured on pictures of boxes of 26 lights: what fits gives
 * ratios of 0.04 to 0.65 where a wrong one gives 1.4 to 23, and of 0.05 to 0.16 where an inverted
 * one gives 6 to 22. Of boxes black, grey, white, mirroring and of glass, at three places and with
 * 4 samples, none is refused, and of 45 wrong coverages 41 are: the others differ by a few pixels
 * of the edge.
 */
#define PAIRS_LEAST 8	  /* fewer edges tell nothing */
#define EDGES_BETTER 1.25 /* ratio of edges that are edges of the pictures */
#define GAINS_BETTER 1.15 /* ratio of light that ground cannot gain ... */
#define BLACK_BETTER 2	  /* ... or, for black objects, of light changed */
#define INVERTED_GAINS 2  /* the same of an inverted coverage, whose edges tell nothing */
#define INVERTED_BLACK 4
#define INTERCHANGED 2 /* ratio of edges without objects to those with them */

/* Two neighbouring pixels, summed over all lights: how far they differ, and the brighter one. */
struct fit_pair {
	float with, without, change; /* change: of what the objects change */
	float most_with, most_without;
};

/* A pixel, summed over all lights and channels, and its pairs with the right and the lower one. */
struct fit_pixel {
	float gained, lost,
		both; /* objects make it brighter, darker; light with and without them */
	struct fit_pair pair[2];
};

struct fit {
	const struct import_pictures *pictures;
	int width, height;
	struct fit_pixel *pixel;
};

static float sum_of(const float *rgb)
{
	return rgb[0] + rgb[1] + rgb[2];
}

static void pair_add(struct fit_pair *pair, const float *with, const float *without, int to)
{
	const float here = sum_of(with), there = sum_of(with + 3 * to);
	const float here_without = sum_of(without), there_without = sum_of(without + 3 * to);

	pair->with += fabsf(here - there);
	pair->without += fabsf(here_without - there_without);
	pair->change += fabsf((here - there) - (here_without - there_without));
	pair->most_with += fmaxf(here, there);
	pair->most_without += fmaxf(here_without, there_without);
}

/* Goes through the pictures once, light by light as they lie in the stacks. */
static void fit_sum(struct fit *f)
{
	const struct import_pictures *p = f->pictures;

	for (int i = 0; i < p->with.count; i++)
		for (int k = 0; k < f->width * f->height; k++) {
			const int x = k % f->width, y = k / f->width;
			const float *with = picture_stack_at(&p->with, i, x, y);
			const float *without = picture_stack_at(&p->without, i, x, y);
			struct fit_pixel *pixel = &f->pixel[k];

			for (int c = 0; c < 3; c++) {
				pixel->gained += fmaxf(with[c] - without[c], 0);
				pixel->lost += fmaxf(without[c] - with[c], 0);
				pixel->both += with[c] + without[c];
			}
			if (x + 1 < f->width)
				pair_add(&pixel->pair[0], with, without, 1);
			if (y + 1 < f->height)
				pair_add(&pixel->pair[1], with, without, f->width);
		}
}

/* ---- other coverages ---- */

enum fit_turn { AS_IT_IS, MIRRORED, UPSIDE_DOWN, TURNED, INVERTED, TURNS };

static const char *const turn_names[TURNS] = {
	[MIRRORED] = "mirrored left to right",
	[UPSIDE_DOWN] = "mirrored top to bottom",
	[TURNED] = "turned by 180 degrees",
	[INVERTED] = "inverted",
};

static float fit_coverage(const struct fit *f, enum fit_turn turn, int x, int y)
{
	const float *coverage = f->pictures->coverage;
	const bool across = turn == MIRRORED || turn == TURNED;
	const bool down = turn == UPSIDE_DOWN || turn == TURNED;
	const int u = across ? f->width - 1 - x : x, v = down ? f->height - 1 - y : y;
	const float here = coverage[v * f->width + u];

	return turn == INVERTED ? 1 - here : here;
}

/* Whether a pair crosses an edge of the coverage. */
static bool is_edge(const struct fit *f, enum fit_turn turn, int x, int y, int axis)
{
	const int u = x + !axis, v = y + axis;

	return u < f->width && v < f->height &&
	       (fit_coverage(f, turn, x, y) >= 0.5f) != (fit_coverage(f, turn, u, v) >= 0.5f);
}

static double share_of(float part, float whole)
{
	return whole > 0 ? (double)(part / whole) : 0;
}

/* What one of two coverages has and the other has not. */
struct fit_sums {
	double covered, gained, changed; /* pixels, and shares of their light */
	double edges, change;
};

static void fit_compare_pixel(const struct fit *f, enum fit_turn turn, int x, int y,
			      struct fit_sums sums[2])
{
	const struct fit_pixel *pixel = &f->pixel[y * f->width + x];
	const double more = (double)(fit_coverage(f, AS_IT_IS, x, y) - fit_coverage(f, turn, x, y));
	struct fit_sums *s = &sums[more < 0];

	s->covered += fabs(more);
	s->gained += fabs(more) * share_of(pixel->gained, pixel->both);
	s->changed += fabs(more) * share_of(pixel->gained + pixel->lost, pixel->both);
	for (int axis = 0; axis < 2; axis++) {
		const bool edge = is_edge(f, AS_IT_IS, x, y, axis);

		if (edge == is_edge(f, turn, x, y, axis))
			continue;
		sums[!edge].edges++;
		sums[!edge].change += share_of(pixel->pair[axis].change,
					       pixel->pair[axis].most_with);
	}
}

/* Tells how much better another coverage fits, by their edges; 1 of an inverted one, which has the
 * same; 0: not decidedly. Objects send light back where the ground under a shadow only loses it,
 * and their edges are edges of the pictures. */
static double fits_better(const struct fit *f, enum fit_turn turn)
{
	struct fit_sums sums[2] = {{0}};
	const struct fit_sums *is = &sums[0], *other = &sums[1];
	double gains, changes, edges;

	for (int y = 0; y < f->height; y++)
		for (int x = 0; x < f->width; x++)
			fit_compare_pixel(f, turn, x, y, sums);
	gains = other->gained * is->covered / (is->gained * other->covered);
	changes = other->changed * is->covered / (is->changed * other->covered);
	edges = other->change * is->edges / (is->change * other->edges);
	/* ratios without a meaning are NaN, which is no larger than anything */
	if (turn == INVERTED)
		return (gains > INVERTED_GAINS && changes > INVERTED_GAINS) ||
				       changes > INVERTED_BLACK
			       ? 1
			       : 0;
	return is->edges >= PAIRS_LEAST && other->edges >= PAIRS_LEAST && edges > EDGES_BETTER &&
			       (gains > GAINS_BETTER || changes > BLACK_BETTER)
		       ? edges
		       : 0;
}

/* Tells whether the coverage's edges are those of the pictures that should have no objects. */
static bool is_interchanged(const struct fit *f)
{
	double with = 0, without = 0;
	int edges = 0;

	for (int k = 0; k < 2 * f->width * f->height; k++) {
		const int x = k / 2 % f->width, y = k / 2 / f->width;
		const struct fit_pair *pair = &f->pixel[k / 2].pair[k % 2];

		if (!is_edge(f, AS_IT_IS, x, y, k % 2))
			continue;
		edges++;
		with += share_of(pair->with, pair->most_with);
		without += share_of(pair->without, pair->most_without);
	}
	return edges >= PAIRS_LEAST && without > INTERCHANGED * with;
}

static int fit_judge(const struct fit *f, const struct import_pictures_settings *settings,
		     struct fault *fault)
{
	enum fit_turn best = AS_IT_IS;
	double most = 0;

	if (is_interchanged(f))
		return fault_say(
			fault, -EINVAL,
			"%s: the objects that are covered are seen in %s, expected them here: interchanged",
			settings->object, settings->ground);
	for (int turn = AS_IT_IS + 1; turn < TURNS; turn++) {
		const double better = fits_better(f, turn);

		if (better > most) {
			most = better;
			best = turn;
		}
	}
	if (best == AS_IT_IS)
		return 0;
	return fault_say(
		fault, -EINVAL,
		"%s: it fits the pictures better if it is %s, expected white where they show objects",
		settings->coverage ? settings->coverage : settings->mask, turn_names[best]);
}

int import_fit_check(const struct import_pictures *pictures,
		     const struct import_pictures_settings *settings, struct fault *fault)
{
	struct fit f = {pictures, pictures->with.width, pictures->with.height, NULL};
	int err;

	f.pixel = calloc((size_t)f.width * (size_t)f.height, sizeof(*f.pixel));
	if (!f.pixel)
		return fault_say(fault, -ENOMEM, "out of memory");
	fit_sum(&f);
	err = fit_judge(&f, settings, fault);
	free(f.pixel);
	return err;
}
