/* SPDX-License-Identifier: MIT */
/*
 * The empty place. In each cell and channel
 *
 *     place = sum_k coefficient_k light_k,    light_k = sum_i w_i phi_k(d_i) L_i / E_0
 *
 * with phi_0 = z, so that light_0 is the irradiance of level ground over that of the first frame,
 * E_0, and the other phi z times harmonics of the light's direction d. A cell begins with
 * coefficient_0 = seen / light_0; the others are learned by recursive least squares with
 * forgetting. As all cells of a band see the same light, they share its covariance.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define STABLE_MS 2000	  /* a cell that has not changed for so long is known */
#define FORGETTING 0.999  /* at each lesson of a band, about once a second */
#define PRIOR 0.04	  /* variance of the other coefficients, over the first's square */
#define NOISE 4e-4	  /* variance of what is seen, over its square */
#define DARK 1e-5	  /* light_0 below which nothing can be told */
#define CLOSE_SHARE 0.03f /* of its light, by which a stable cell may differ */
#define JUMPED 0.03f	  /* change of light_k / light_0 from frame to frame: a lamp was switched */
#define LIGHT_MS 470.0	  /* in which a cell follows light */
#define TURNED 0.004f	  /* change of light_k / light_0 that asks for a new prediction */
#define LESSON_SHARE 0.1f /* of its light, that one lesson may change at most */

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

int place_create(struct people *p)
{
	const struct dome *dome = p->settings.dome;

	p->term = calloc((size_t)dome->count, sizeof(*p->term));
	p->ratios = calloc((size_t)(p->tiles_across * p->tiles_down), sizeof(*p->ratios));
	if (!p->term || !p->ratios)
		return -1;
	for (int i = 0; i < dome->count; i++) {
		sky_terms(dome->direction[i], p->term[i]);
		for (int k = 0; k < PLACE_TERMS; k++)
			p->term[i][k] *= dome->solid_angle_sr[i];
	}
	return 0;
}

void place_count_unknown(struct people *p)
{
	memset(p->unknown, 0, (size_t)p->down * sizeof(*p->unknown));
	for (int s = 0; s < p->span_count; s++) {
		const struct span *span = &p->spans[s];

		for (int x = 0; x < span->count; x++)
			p->unknown[span->y] += !p->known[span->y * p->across + span->x + x];
	}
}

void place_forget(struct people *p)
{
	memset(p->first, 0, sizeof(p->first));
	memset(p->light_then, 0, sizeof(p->light_then));
	for (int c = 0; c < 3; c++)
		for (int at = 0; at < p->cells; at++)
			p->drift[c][at] = 1;
	memset(p->known, 0, (size_t)p->cells);
	place_count_unknown(p);
	memset(p->stable_ms, 0, (size_t)p->cells * sizeof(*p->stable_ms));
	memset(p->verdict, 0, (size_t)p->cells);
	memset(p->order, 0, (size_t)p->cells);
	memset(p->order_before, 0, (size_t)p->cells);
	memset(p->fit, 0, sizeof(p->fit));
	for (int c = 0; c < 3; c++) {
		p->gain[c] = 1;
		for (int band = 0; band < PLACE_BANDS; band++)
			for (int k = 0; k < PLACE_TERMS; k++)
				p->fit[band][c].covariance[k][k] = k ? PRIOR : NOISE;
	}
}

/* Whether two lights differ by more than their strength. */
static bool lights_differ(float a[3][PLACE_TERMS], float b[3][PLACE_TERMS], float most)
{
	for (int c = 0; c < 3; c++)
		for (int k = 1; k < PLACE_TERMS; k++)
			if (!(fabsf(a[c][k] / a[c][0] - b[c][k] / b[c][0]) <= most))
				return true;
	return false;
}

bool place_light(struct people *p, const float (*radiance)[3])
{
	float before[3][PLACE_TERMS];

	memcpy(before, p->light, sizeof(before));
	for (int c = 0; c < 3; c++) {
		double sum[PLACE_TERMS] = {0};

		for (int i = 0; i < p->settings.dome->count; i++)
			for (int k = 0; k < PLACE_TERMS; k++)
				sum[k] += p->term[i][k] * (double)radiance[i][c];
		if (!(sum[0] > DARK))
			return false;
		if (!(p->first[c] > 0))
			p->first[c] = sum[0];
		for (int k = 0; k < PLACE_TERMS; k++)
			p->light[c][k] = (float)(sum[k] / p->first[c]);
	}
	p->jumped = lights_differ(p->light, before, JUMPED) ||
		    fabsf(p->light[1][0] - before[1][0]) > JUMPED * p->light[1][0];
	return true;
}

/* The place in the light of the last prediction, per unit of ground irradiance. */
static void predict_span(struct people *p, const struct span *span)
{
	const int at = span->y * p->across + span->x;

	for (int c = 0; c < 3; c++) {
		float *restrict lit = p->lit[c] + at;
		const int count = span->count;

		memset(lit, 0, (size_t)span->count * sizeof(*lit));
		for (int k = 0; k < PLACE_TERMS; k++) {
			const float *restrict coefficient = p->coefficient[c][k] + at;
			const float light = p->light_then[c][k] / p->light_then[c][0];

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
	const bool turned = lights_differ(p->light, p->light_then, TURNED);

	if (turned)
		memcpy(p->light_then, p->light, sizeof(p->light));
	for (int s = 0; s < p->span_count; s++) {
		const struct span *span = &p->spans[s];

		/* What the band has learned in the frame before, or the row was begun with. */
		if (turned || (span->y + 1) % PLACE_BANDS == band || p->unknown[span->y])
			predict_span(p, span);
	}
}

void place_adopt(struct people *p, int cell)
{
	for (int c = 0; c < 3; c++) {
		for (int k = 1; k < PLACE_TERMS; k++)
			p->coefficient[c][k][cell] = 0;
		p->coefficient[c][0][cell] = p->seen[c][cell] / (p->gain[c] * p->light[c][0]);
		p->place[c][cell] = p->seen[c][cell];
	}
	for (int c = 0; c < 3; c++) {
		p->lit[c][cell] = p->coefficient[c][0][cell];
		p->drift[c][cell] = 1;
	}
	p->unknown[cell / p->across] -= !p->known[cell];
	p->known[cell] = 1;
	p->verdict[cell] = VERDICT_EMPTY;
}

/* ---- cells that are not known yet ---- */

/* Whether a cell shows what it showed, in the light of now. */
static bool is_stable(const struct people *p, int cell)
{
	for (int c = 0; c < 3; c++) {
		const float was = p->place[c][cell];
		const float room = 4 * sqrtf(p->still[c] + p->shot[c] * was) + CLOSE_SHARE * was;

		if (fabsf(p->seen[c][cell] - was) > room)
			return false;
	}
	return true;
}

static void watch_cell(struct people *p, int cell)
{
	const bool stable = is_stable(p, cell);

	for (int c = 0; c < 3; c++) {
		const float is = p->seen[c][cell] / (p->gain[c] * p->light[c][0]);
		float *was = &p->coefficient[c][0][cell];

		*was = stable ? *was + (is - *was) * 0.125f : is;
		for (int k = 1; k < PLACE_TERMS; k++)
			p->coefficient[c][k][cell] = 0;
		p->drift[c][cell] = 1;
	}
	p->stable_ms[cell] = stable ? (uint16_t)(p->stable_ms[cell] + (int)p->step_ms) : 0;
	if (p->stable_ms[cell] >= STABLE_MS) {
		p->known[cell] = 1;
		p->unknown[cell / p->across]--;
	}
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

/* What a span's cells teach: how far they are off, at most LESSON_SHARE; 0 for cells that teach
 * nothing. */
static void span_lessons(const struct people *p, const struct span *span, int c,
			 float *restrict off)
{
	const int at = span->y * p->across + span->x, count = span->count;
	const float *seen = p->seen[c] + at, *place = p->place[c] + at;
	const float *drift = p->drift[c] + at;
	const uint8_t *known = p->known + at, *verdict = p->verdict + at;
	const float per_gain = 1 / p->gain[c];

	for (int x = 0; x < count; x++) {
		const float learned = place[x] / drift[x];
		const float room = LESSON_SHARE * learned, is = seen[x] - learned;
		const bool teaches = known[x] && verdict[x] != VERDICT_PERSON &&
				     seen[x] <= CLIPPED * WHITE;
		const float most = is > room ? room : is < -room ? -room : is;

		off[x] = teaches ? most * per_gain : 0;
	}
}

static void teach_span(struct people *p, const struct span *span, float step[3][PLACE_TERMS])
{
	const int at = span->y * p->across + span->x, count = span->count;
	float *restrict off = p->column[0][0];

	for (int c = 0; c < 3; c++) {
		span_lessons(p, span, c, off);
		for (int k = 0; k < PLACE_TERMS; k++) {
			float *restrict coefficient = p->coefficient[c][k] + at;
			const float share = step[c][k];

			for (int x = 0; x < count; x++)
				coefficient[x] += share * off[x];
		}
	}
}

/* rate_of() (hidden.c) of a span's known cells for any channel that is neither dim nor clipped,
 * where it is lighter than the place and where it is darker. */
static void span_rates(const struct people *p, const struct span *span, float *restrict lighter,
		       float *restrict darker)
{
	const int at = span->y * p->across + span->x, count = span->count;
	const uint8_t *known = p->known + at, *verdict = p->verdict + at;
	const float light_rate = p->light_rate;

	for (int x = 0; x < count; x++) {
		lighter[x] = (known[x] & (verdict[x] != VERDICT_PERSON)) ? light_rate : 0;
		darker[x] = verdict[x] == VERDICT_SHADED ? 0 : lighter[x];
	}
	for (int x = 0; p->jumped && x < count; x++)
		if (known[x] && p->before[at + x] == VERDICT_EMPTY && !p->order[at + x])
			lighter[x] = darker[x] = 1;
}

/* Follows, in the cells where nobody is, what the light's model is off by: lamps that are so near
 * that each place sees them elsewhere. */
static void drift_span(struct people *p, const struct span *span)
{
	const float *restrict lighter = p->column[1][0], *restrict darker = p->column[1][1];
	const int at = span->y * p->across + span->x, count = span->count;

	span_rates(p, span, p->column[1][0], p->column[1][1]);
	for (int c = 0; c < 3; c++) {
		const float *restrict seen = p->seen[c] + at, *restrict place = p->place[c] + at;
		float *restrict drift = p->drift[c] + at;

		for (int x = 0; x < count; x++) {
			const float in_light = lighter[x], in_shade = darker[x];
			const float ratio = seen[x] / place[x], most = ratio < 2 ? ratio : 2;
			const float told = ratio < 1 ? in_shade : in_light;
			const float rate = place[x] < DIM * WHITE ? 0 : told;
			const float taken = seen[x] > CLIPPED * WHITE ? 0 : rate;
			float is = drift[x] * (1 + taken * (most - 1));

			is = is > 1 / DRIFT_MOST ? is : 1 / DRIFT_MOST;
			drift[x] = is < DRIFT_MOST ? is : DRIFT_MOST;
		}
	}
}

void place_learn(struct people *p)
{
	const int band = (int)(p->frame % PLACE_BANDS);
	float step[3][PLACE_TERMS];

	p->light_rate = (float)(p->step_ms / (p->step_ms + LIGHT_MS));
	hidden_follow(p);
	for (int c = 0; c < 3; c++)
		fit_step(&p->fit[band][c], p->light[c], step[c]);
	for (int s = 0; s < p->span_count; s++) {
		const struct span *span = &p->spans[s];
		const int at = span->y * p->across;

		if (span->y % PLACE_BANDS == band && !p->learn_now)
			teach_span(p, span, step);
		drift_span(p, span);
		for (int x = span->x;
		     (p->learn_now || p->unknown[span->y]) && x < span->x + span->count; x++) {
			if (p->learn_now)
				place_adopt(p, at + x);
			else if (!p->known[at + x])
				watch_cell(p, at + x);
		}
	}
	p->learn_now = false;
}
