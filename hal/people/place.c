/* SPDX-License-Identifier: MIT */
/*
 * The empty place. In each cell and channel
 *
 *     expected = gain drift sum_k coefficient_k light_k,   light_k = sum_i w_i phi_k(d_i) L_i / E_0
 *
 * with phi_0 = z, so that light_0 is the irradiance of level ground over that of the first frame,
 * E_0, and the other phi z times harmonics of the light's direction d. A cell begins with
 * coefficient_0 = seen / light_0; the others are learned by recursive least squares with
 * forgetting. As all cells of a band see the same light, they share its covariance. drift follows
 * within half a second what the model is off by: lamps so near that each place sees them elsewhere.
 *
 * A cell's deviations have the variance
 *
 *     s^2 = spread (still + shot expected) + model_variance expected^2
 *
 * of which spread is learned from what is seen, cell by cell: cameras that shake, leaves, and what
 * compression does to edges.
 */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define STABLE_MS 2000	  /* a cell that has not changed for so long is known */
#define FORGETTING 0.999  /* at each lesson of a band, about once a second */
#define PRIOR 0.04	  /* variance of the other coefficients, over the first's square */
#define NOISE 4e-4	  /* variance of what is seen, over its square */
#define DARK 1e-5	  /* light_0 below which nothing can be told */
#define CONE 0.95	  /* cosine of 18 degrees: what a body hides of a lamp and its glow */
#define SKY 0.5		  /* of the rest of the sky that a body hides where he stands */
#define DARKEST 0.1	  /* a share of light comes by way of walls */
#define SETTLING_MS 500.0 /* in which drift has followed a change of light */
#define STEADY 0.01f	  /* of its light, by which each cell is off at any time */
#define TURNED 0.004f	  /* change of light_k / light_0 that asks for a new prediction */
#define LESSON_SHARE 0.1f /* of its light, that one lesson may change at most */
#define HANDED_ON 0.3f	  /* of a gain that lasts, which a lesson hands on to the place, too */
#define MODEL 0.02f	  /* of its light, by which a cell is off until its spread is learned, */
#define SHIFT 0.15f	  /* and the cells by which the camera shakes */
#define SPREAD_MS 4000.0  /* in which spread is learned */
#define SPREAD_FIRST 4.0f /* of a place that was restored */
#define SPREAD_LEAST 0.5f
#define SPREAD_MOST 200.0f

static void sky_terms(const double d[3], double term[PLACE_TERMS])
{
	const double z = d[2] > 0 ? d[2] : 0;
	const double harmonic[PLACE_TERMS] = {1,
					      d[0],
					      d[1],
					      2 * z - 1,
					      d[0] * d[1],
					      d[0] * d[0] - d[1] * d[1],
					      d[0] * (2 * z - 1),
					      d[1] * (2 * z - 1),
					      6 * z * z - 6 * z + 1};

	for (int k = 0; k < PLACE_TERMS; k++)
		term[k] = z * harmonic[k];
}

void place_create(struct people *p)
{
	const struct dome *dome = p->settings.dome;

	for (int i = 0; i < dome->count; i++) {
		sky_terms(dome->direction[i], p->place.term[i]);
		for (int k = 0; k < PLACE_TERMS; k++)
			p->place.term[i][k] *= dome->solid_angle_sr[i];
	}
}

void place_count_unknown(struct people *p)
{
	p->place.unknown = 0;
	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];
		const uint8_t *known = p->place.known + span->y * p->cells.across + span->x;

		for (int x = 0; x < span->count; x++)
			p->place.unknown += !known[x];
	}
}

void place_forget(struct people *p)
{
	const size_t cells = (size_t)p->cells.count;
	struct place *place = &p->place;

	memset(place->first, 0, sizeof(place->first));
	memset(place->light_then, 0, sizeof(place->light_then));
	memset(place->known, 0, cells);
	memset(place->fit, 0, sizeof(place->fit));
	memset(p->cells.still_ms, 0, cells * sizeof(*p->cells.still_ms));
	memset(p->verdict.of, WHOSE_PLACE, cells);
	memset(p->crowd.order, 0, cells);
	p->crowd.persons = 0;
	for (int c = 0; c < 3; c++) {
		place->gain[c] = 1;
		for (int at = 0; at < p->cells.count; at++)
			place->drift[c][at] = 1;
		for (int band = 0; band < PLACE_BANDS; band++)
			for (int k = 0; k < PLACE_TERMS; k++)
				place->fit[band][c].covariance[k][k] = k ? PRIOR : NOISE;
	}
	for (int at = 0; at < p->cells.count; at++) {
		place->spread[at] = SPREAD_FIRST;
		p->verdict.opinion[at] = -1;
	}
	nudge_forget(&p->nudge);
	place_count_unknown(p);
}

/* ---- light ---- */

/* The sum over channels and terms of the squares of how much two lights differ, over their
 * strength; *most: the largest of them. */
static float light_change(float a[3][PLACE_TERMS], float b[3][PLACE_TERMS], float *most)
{
	float sum = 0;

	*most = 0;
	for (int c = 0; c < 3; c++)
		for (int k = 1; k < PLACE_TERMS; k++) {
			const float change = a[c][k] / a[c][0] - b[c][k] / b[c][0];

			sum += change * change;
			*most = fabsf(change) <= *most ? *most : fabsf(change);
		}
	return sum;
}

/* The share of the ground's irradiance that comes from within CONE of the light that gives most, of
 * those that are `left`, which it takes out. */
static double take_cone(const struct people *p, const float (*radiance)[3], bool *left)
{
	const struct dome *dome = p->settings.dome;
	double most = 0, all = 0, cone = 0;
	int middle = -1;

	for (int i = 0; i < dome->count; i++) {
		const double gives = p->place.term[i][0] * (double)radiance[i][1];

		all += gives;
		if (left[i] && gives > most) {
			most = gives;
			middle = i;
		}
	}
	for (int i = 0; i < dome->count && middle >= 0; i++) {
		const double *a = dome->direction[i], *b = dome->direction[middle];

		if (!left[i] || a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < CONE)
			continue;
		cone += p->place.term[i][0] * (double)radiance[i][1];
		left[i] = false;
	}
	return all > 0 ? cone / all : 0;
}

/* The ratio of the darkest shadow: a person hides the two strongest lamps, and SKY of the rest. */
static float darkest_shadow(const struct people *p, const float (*radiance)[3])
{
	bool *left = p->place.left;
	double hidden;

	memset(left, true, (size_t)p->settings.dome->count);
	hidden = take_cone(p, radiance, left) + take_cone(p, radiance, left);
	return (float)fmax((1 - hidden) * (1 - SKY), DARKEST);
}

bool place_light(struct people *p, const float (*radiance)[3])
{
	struct place *place = &p->place;
	float before[3][PLACE_TERMS], most, change;

	memcpy(before, place->light, sizeof(before));
	for (int c = 0; c < 3; c++) {
		double sum[PLACE_TERMS] = {0};

		for (int i = 0; i < p->settings.dome->count; i++)
			for (int k = 0; k < PLACE_TERMS; k++)
				sum[k] += place->term[i][k] * (double)radiance[i][c];
		if (!(sum[0] > DARK))
			return false;
		if (!(place->first[c] > 0))
			place->first[c] = sum[0];
		for (int k = 0; k < PLACE_TERMS; k++)
			place->light[c][k] = (float)(sum[k] / place->first[c]);
	}
	place->log_darkest = logf(darkest_shadow(p, radiance));
	if (!(before[0][0] > 0))
		return true;
	change = light_change(place->light, before, &most) / 3;
	place->model_variance += (float)PRIOR * change -
				 (float)(p->step_ms / (p->step_ms + SETTLING_MS)) *
					 (place->model_variance - STEADY * STEADY);
	return true;
}

/* The place in the light of the last prediction, per unit of ground irradiance. */
static void predict_span(struct people *p, const struct span *span)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;

	for (int c = 0; c < 3; c++) {
		float *restrict lit = p->place.lit[c] + at;

		memset(lit, 0, (size_t)count * sizeof(*lit));
		for (int k = 0; k < PLACE_TERMS; k++) {
			const float *restrict coefficient = p->place.coefficient[c][k] + at;
			const float light = p->place.light_then[c][k] / p->place.light_then[c][0];

			for (int x = 0; x < count; x++)
				lit[x] += coefficient[x] * light;
		}
		for (int x = 0; x < count; x++)
			lit[x] = lit[x] > 0 ? lit[x] : 0;
	}
}

void place_predict(struct people *p)
{
	const int band = (int)(p->frame % PLACE_BANDS);
	float most;
	bool turned;

	light_change(p->place.light, p->place.light_then, &most);
	turned = !(most <= TURNED);
	if (turned)
		memcpy(p->place.light_then, p->place.light, sizeof(p->place.light));
	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];

		/* The band that has learned in the frame before. */
		if (turned || (span->y + 1) % PLACE_BANDS == band)
			predict_span(p, span);
	}
}

/* ---- cells that become known ---- */

/* The spread of a cell of which only its light and its slope are known. */
static float first_spread(const struct people *p, int at)
{
	const int across = p->cells.across;
	const uint8_t *watch = p->cells.watch;
	const float *recent = p->cells.recent[1];
	const float unit = p->place.gain[1] * p->place.light[1][0], light = recent[at] * unit;
	const float dx = watch[at - 1] & watch[at + 1] ? recent[at + 1] - recent[at - 1] : 0;
	const float dy = watch[at - across] & watch[at + across]
				 ? recent[at + across] - recent[at - across]
				 : 0;
	const float slope = SHIFT * 0.5f * unit;

	return 1 + (MODEL * MODEL * light * light + slope * slope * (dx * dx + dy * dy)) /
			   cells_variance(&p->cells, 1, light);
}

void place_adopt(struct people *p, int at)
{
	for (int c = 0; c < 3; c++) {
		const float recent = p->cells.recent[c][at];

		p->place.coefficient[c][0][at] = recent;
		for (int k = 1; k < PLACE_TERMS; k++)
			p->place.coefficient[c][k][at] = 0;
		p->place.lit[c][at] = recent;
		p->place.drift[c][at] = 1;
		p->place.expected[c][at] = recent * p->place.gain[c] * p->place.light[c][0];
	}
	p->place.spread[at] = first_spread(p, at);
	p->place.unknown -= !p->place.known[at];
	p->place.known[at] = 1;
	p->verdict.of[at] = WHOSE_PLACE;
	p->verdict.opinion[at] = -1;
}

/* Reads a plane between its cells; the cells around the picture are as those at its edge. */
static void move_plane(const struct people *p, float *plane, const float shift[2])
{
	const int across = p->cells.across, down = p->cells.down;
	float *from = p->verdict.revised; /* which is made anew in each frame */

	memcpy(from, plane, (size_t)p->cells.count * sizeof(*plane));
	for (int y = 0; y < down; y++)
		for (int x = 0; x < across; x++) {
			const float u = fminf(fmaxf((float)x - shift[0], 0), (float)across - 1.01f);
			const float v = fminf(fmaxf((float)y - shift[1], 0), (float)down - 1.01f);
			const float right = u - floorf(u), low = v - floorf(v);
			const float *at = from + (int)v * across + (int)u;

			plane[y * across + x] =
				(1 - low) * ((1 - right) * at[0] + right * at[1]) +
				low * ((1 - right) * at[across] + right * at[across + 1]);
		}
}

void place_move(struct people *p, const float shift[2])
{
	float *known = p->verdict.evidence;

	for (int at = 0; at < p->cells.count; at++)
		known[at] = p->place.known[at];
	move_plane(p, known, shift);
	for (int c = 0; c < 3; c++) {
		for (int k = 0; k < PLACE_TERMS; k++)
			move_plane(p, p->place.coefficient[c][k], shift);
		move_plane(p, p->cells.recent[c], shift);
	}
	/* A cell between known and unknown ones is a mixture with nothing. */
	for (int at = 0; at < p->cells.count; at++) {
		p->place.known[at] = known[at] == 1;
		p->place.spread[at] = fmaxf(p->place.spread[at], first_spread(p, at));
		for (int c = 0; c < 3; c++)
			p->place.drift[c][at] = 1; /* what it has followed since was the nudge */
	}
	place_count_unknown(p);
	memset(p->place.light_then, 0, sizeof(p->place.light_then)); /* all is predicted anew */
}

/* ---- recursive least squares ---- */

/* The step that a lesson in this light teaches; the covariance becomes what is left. */
static void fit_step(struct place_fit *fit, const float light[PLACE_TERMS], float step[PLACE_TERMS])
{
	double product[PLACE_TERMS] = {0}, whole = NOISE, trace = 0;

	for (int j = 0; j < PLACE_TERMS; j++)
		for (int k = 0; k < PLACE_TERMS; k++)
			product[j] += fit->covariance[j][k] * (double)light[k];
	for (int k = 0; k < PLACE_TERMS; k++)
		whole += product[k] * (double)light[k];
	for (int j = 0; j < PLACE_TERMS; j++) {
		step[j] = (float)(product[j] / whole);
		for (int k = 0; k < PLACE_TERMS; k++)
			fit->covariance[j][k] -= product[j] * product[k] / whole;
		trace += fit->covariance[j][j];
	}
	/* Light that does not change for hours must not make the rest of the covariance grow. */
	if (trace < PRIOR * PLACE_TERMS)
		for (int j = 0; j < PLACE_TERMS; j++)
			for (int k = 0; k < PLACE_TERMS; k++)
				fit->covariance[j][k] /= FORGETTING;
}

/* How far a span's cells are off, at most LESSON_SHARE, less what all cells share, which the gain
 * has, and hands on slowly; 0 for cells that teach nothing. */
static void span_lessons(const struct people *p, const struct span *span, int c,
			 float *restrict off)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float *seen = p->cells.seen[c] + at, *expected = p->place.expected[c] + at;
	const float *drift = p->place.drift[c] + at;
	const uint8_t *known = p->place.known + at, *whose = p->verdict.of + at;
	const uint16_t *still_ms = p->cells.still_ms + at;
	const float per_gain = 1 / p->place.gain[c], shared = p->place.shared[c];
	const float handed_on = HANDED_ON * (p->place.gain[c] - 1);

	for (int x = 0; x < count; x++) {
		const float learned = expected[x] / drift[x];
		const float room = LESSON_SHARE * learned, is = seen[x] * shared - learned;
		const bool teaches = known[x] && seen[x] <= CLIPPED * WHITE &&
				     (whose[x] == WHOSE_PLACE ||
				      (whose[x] == WHOSE_SHADOW && still_ms[x] > STABLE_MS));
		const float most = is > room ? room : is < -room ? -room : is;

		off[x] = teaches ? (most + handed_on * learned) * per_gain : 0;
	}
}

static void teach_span(struct people *p, const struct span *span, float step[3][PLACE_TERMS])
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	float *restrict off = p->place.lessons;

	for (int c = 0; c < 3; c++) {
		span_lessons(p, span, c, off);
		for (int k = 0; k < PLACE_TERMS; k++) {
			float *restrict coefficient = p->place.coefficient[c][k] + at;
			const float share = step[c][k];

			for (int x = 0; x < count; x++)
				coefficient[x] += share * off[x];
		}
	}
}

/* ---- spread ---- */

/* chi has a mean of 3 where spread is right. */
static void spread_span(struct people *p, const struct span *span)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float rate = (float)(p->step_ms / (p->step_ms + SPREAD_MS));
	const float *restrict chi = p->verdict.chi + at;
	const uint8_t *whose = p->verdict.of + at, *known = p->place.known + at;
	const uint16_t *still_ms = p->cells.still_ms + at;
	float *restrict spread = p->place.spread + at;

	for (int x = 0; x < count; x++) {
		const float told = chi[x] < 12 ? chi[x] : 12;
		const bool teaches = known[x] &&
				     (whose[x] == WHOSE_PLACE ||
				      (whose[x] == WHOSE_SHADOW && still_ms[x] > STABLE_MS));
		const float rate_here = teaches ? rate : 0;
		const float is = spread[x] * (1 + rate_here * (told * (1 / 3.0f) - 1));
		const float least = is > SPREAD_LEAST ? is : SPREAD_LEAST;

		spread[x] = least < SPREAD_MOST ? least : SPREAD_MOST;
	}
}

/* ---- all of it ---- */

static void learn_cell(struct people *p, int at)
{
	if (p->place.learn_now) {
		for (int c = 0; c < 3; c++)
			p->cells.recent[c][at] = p->cells.seen[c][at] /
						 (p->place.gain[c] * p->place.light[c][0]);
		place_adopt(p, at);
	} else if (!p->place.known[at] && p->cells.still_ms[at] >= STABLE_MS) {
		place_adopt(p, at);
	}
}

void place_learn(struct people *p)
{
	const int band = (int)(p->frame % PLACE_BANDS);
	float step[3][PLACE_TERMS];

	drift_follow(p);
	for (int c = 0; c < 3; c++)
		fit_step(&p->place.fit[band][c], p->place.light[c], step[c]);
	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];
		const int at = span->y * p->cells.across + span->x;

		if (span->y % PLACE_BANDS == band && !p->place.learn_now)
			teach_span(p, span, step);
		spread_span(p, span);
		for (int x = 0; x < span->count && (p->place.learn_now || p->place.unknown); x++)
			if (p->place.learn_now || !p->place.known[at + x])
				learn_cell(p, at + x);
	}
	p->place.learn_now = false;
}
