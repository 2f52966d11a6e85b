/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/lamps/lamp_match.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/optics/vec.h"

#define CANDIDATES_MAX 512
#define NODES_MAX 1000000 /* ways that are tried: a second or so */
/* Another way is out of the question where it is a thousand times less likely: 2 ln 1000. */
#define CLEARLY_WORSE 13.8
/* A panel that is seen straight and at 50 degrees differs by 1.6 in its light, by its square root in
 * its width; half of a lamp that a shade hides, by 2. */
#define FLUX_DEVIATION 0.6
#define SIZE_DEVIATION 0.3
/* Nearer than this no lamp is laid before a lens. */
#define NEAREST_M 0.1
#define DEVIATIONS 3
/* Of the light: a lamp with less puts the picture off by half a level at most (tests/accuracy). */
#define STRONG 0.03

/* By Wilson and Hilferty, whose cube is right to a percent; 3.09 is the normal deviate of it. */
double lamp_most_squares(int freedom)
{
	const double part = 2 / (9.0 * freedom);

	return freedom * pow(1 - part + 3.09 * sqrt(part), 3);
}

struct matching {
	const struct lamp_sight *sight;
	int sights;
	const struct lamp_deviations *deviation;
	struct lamp_track *candidate; /* [CANDIDATES_MAX] */
	int candidates;
	bool overflow;
	/* The search: */
	bool taken[SIGHT_PLACES_MAX][SIGHT_SPOTS_MAX];
	int chosen[SIGHT_PLACES_MAX * SIGHT_SPOTS_MAX], count, matched, nodes;
	double squares;
	struct {
		int chosen[SIGHT_PLACES_MAX * SIGHT_SPOTS_MAX], count, matched;
		double squares;
	} best;
	double rival; /* squares of the best other way with as many matched by as many */
};

static const struct lamp_spot *spot_of(const struct matching *m, const struct lamp_track *t, int k)
{
	return t->spot[k] < 0 ? NULL : &m->sight[k].spot[t->spot[k]];
}

static double direction_deviation(const struct matching *m, const struct lamp_spot *spot)
{
	return hypot(m->deviation->px * spot->pixel, m->deviation->turn);
}

/* ---- one candidate ---- */

/* Solves the 3 x 3 system of columns a with Cramer's rule. False: it has no one solution. */
static bool solve(const double a[3][3], const double b[3], double x[3])
{
	double cross[3], det;

	vec_cross(a[1], a[2], cross);
	det = vec_dot(a[0], cross);
	if (!(fabs(det) > 1e-12 * vec_length(a[0]) * vec_length(a[1]) * vec_length(a[2])))
		return false;
	for (int k = 0; k < 3; k++) {
		vec_cross(a[(k + 1) % 3], a[(k + 2) % 3], cross);
		x[k] = vec_dot(b, cross) / det;
	}
	return true;
}

/* The point nearest to the rays, each by its deviation at the distance of the last guess. Its
 * squares; INFINITY: the rays do not meet before the lens. */
static double meet_rays(const struct matching *m, struct lamp_track *t)
{
	double distance[SIGHT_PLACES_MAX], squares = 0;

	for (int k = 0; k < m->sights; k++)
		distance[k] = 2; /* a room's; the weights hardly depend on it */
	for (int turn = 0; turn < 4; turn++) {
		double a[3][3] = {{0}}, b[3] = {0};

		squares = 0;
		for (int k = 0; k < m->sights; k++) {
			const struct lamp_spot *spot = spot_of(m, t, k);
			const double *at = m->sight[k].at;
			double sigma;

			if (!spot)
				continue;
			sigma = hypot(distance[k] * direction_deviation(m, spot),
				      m->deviation->place_m);
			for (int i = 0; i < 3; i++)
				for (int j = 0; j < 3; j++) {
					const double across = (i == j) -
							      spot->dir[i] * spot->dir[j];

					a[j][i] += across / (sigma * sigma);
					b[i] += across * at[j] / (sigma * sigma);
				}
		}
		if (!solve((const double(*)[3])a, b, t->at))
			return INFINITY;
		for (int k = 0; k < m->sights; k++) {
			const struct lamp_spot *spot = spot_of(m, t, k);
			double to[3], angle;

			if (!spot)
				continue;
			for (int i = 0; i < 3; i++)
				to[i] = t->at[i] - m->sight[k].at[i];
			if (!(vec_dot(to, spot->dir) > NEAREST_M))
				return INFINITY;
			distance[k] = vec_normalize(to);
			angle = vec_angle(to, spot->dir);
			squares += pow(angle / hypot(direction_deviation(m, spot),
						     m->deviation->place_m / distance[k]),
				       2);
		}
	}
	t->least_m = INFINITY;
	for (int k = 0; k < m->sights; k++)
		if (t->spot[k] >= 0)
			t->least_m = fmin(t->least_m, distance[k]);
	return squares;
}

/* The squares of a light that is infinitely far; direction and least distance into *far. */
static double parallel_rays(const struct matching *m, const struct lamp_track *t,
			    struct lamp_track *far)
{
	double squares = 0;

	*far = *t;
	far->far = true;
	far->least_m = 0;
	memset(far->at, 0, sizeof(far->at));
	for (int k = 0; k < m->sights; k++)
		for (int i = 0; t->spot[k] >= 0 && i < 3; i++)
			far->at[i] += spot_of(m, t, k)->dir[i];
	vec_normalize(far->at);
	for (int k = 0; k < m->sights; k++)
		if (t->spot[k] >= 0)
			squares += pow(vec_angle(spot_of(m, t, k)->dir, far->at) /
					       direction_deviation(m, spot_of(m, t, k)),
				       2);
	/* Seen across the line of sight, places that are b apart tell distances up to b / angle. */
	for (int j = 0; j < m->sights; j++)
		for (int k = 0; k < j; k++) {
			double apart[3], across[3];

			if (t->spot[j] < 0 || t->spot[k] < 0)
				continue;
			for (int i = 0; i < 3; i++)
				apart[i] = m->sight[j].at[i] - m->sight[k].at[i];
			vec_cross(apart, far->at, across);
			far->least_m =
				fmax(far->least_m,
				     vec_length(across) /
					     (DEVIATIONS *
					      hypot(direction_deviation(m, spot_of(m, t, j)),
						    direction_deviation(m, spot_of(m, t, k)))));
		}
	return squares;
}

/* How much the places differ on how large and how strong the light is; *terms: comparisons. */
static double looks_squares(const struct matching *m, const struct lamp_track *t, int *terms)
{
	const double deviation[2] = {FLUX_DEVIATION, SIZE_DEVIATION};
	double squares = 0;

	*terms = 0;
	for (int what = 0; what < 2; what++) {
		double sum = 0, square = 0;
		int n = 0;

		for (int k = 0; k < m->sights; k++) {
			const struct lamp_spot *spot = spot_of(m, t, k);
			double to[3], distance = 1, value;

			if (!spot || (what ? !spot->resolved : spot->clipped))
				continue;
			for (int i = 0; i < 3; i++)
				to[i] = t->at[i] - m->sight[k].at[i];
			if (!t->far)
				distance = vec_length(to);
			value = what ? log(spot->radius * distance)
				     : log(spot->flux * distance * distance);
			sum += value;
			square += value * value;
			n++;
		}
		if (n < 2)
			continue;
		squares += fmax(0, square - sum * sum / n) / (deviation[what] * deviation[what]);
		*terms += n - 1;
	}
	return squares;
}

/* Keeps a track whose spots are set, if its rays can be those of one light. */
static void judge_candidate(struct matching *m, struct lamp_track *t)
{
	struct lamp_track far;
	const double parallel = parallel_rays(m, t, &far);
	int freedom = 2 * t->seen - 3, terms;
	double looks;

	if (parallel <= lamp_most_squares(2 * t->seen - 2)) {
		*t = far;
		t->squares = parallel;
		freedom = 2 * t->seen - 2;
	} else {
		t->squares = meet_rays(m, t);
	}
	if (!(t->squares <= lamp_most_squares(freedom)))
		return;
	looks = looks_squares(m, t, &terms);
	t->squares += looks;
	if (!(t->squares <= lamp_most_squares(freedom + terms)))
		return;
	if (m->candidates == CANDIDATES_MAX)
		m->overflow = true;
	else
		m->candidate[m->candidates++] = *t;
}

/* Goes through all choices of a spot, or none, at each place. */
static void list_candidates(struct matching *m, struct lamp_track *t, int k)
{
	struct lamp_track whole = *t;

	if (k == m->sights) {
		if (whole.seen >= 2)
			judge_candidate(m, &whole);
		return;
	}
	for (int spot = -1; spot < m->sight[k].count; spot++) {
		t->spot[k] = spot;
		t->seen += spot >= 0;
		list_candidates(m, t, k + 1);
		t->seen -= spot >= 0;
	}
}

/* ---- all of them together ---- */

static void end_way(struct matching *m)
{
	const bool equal = m->matched == m->best.matched && m->count == m->best.count;

	if (m->matched < m->best.matched ||
	    (m->matched == m->best.matched && m->count > m->best.count) ||
	    (equal && m->squares >= m->best.squares)) {
		if (equal)
			m->rival = fmin(m->rival, m->squares);
		return;
	}
	m->rival = equal ? m->best.squares : INFINITY;
	memcpy(m->best.chosen, m->chosen, sizeof(m->chosen));
	m->best.count = m->count;
	m->best.matched = m->matched;
	m->best.squares = m->squares;
}

static void take_track(struct matching *m, const struct lamp_track *t, bool taken)
{
	for (int k = 0; k < m->sights; k++)
		if (t->spot[k] >= 0)
			m->taken[k][t->spot[k]] = taken;
	m->matched += taken ? t->seen : -t->seen;
	m->squares += taken ? t->squares : -t->squares;
}

static bool is_free(const struct matching *m, const struct lamp_track *t)
{
	for (int k = 0; k < m->sights; k++)
		if (t->spot[k] >= 0 && m->taken[k][t->spot[k]])
			return false;
	return true;
}

/* Takes the spots in order: each goes into one of the tracks that it is in, or into none. */
static void search_ways(struct matching *m, int k, int spot)
{
	while (k < m->sights && spot == m->sight[k].count) {
		k++;
		spot = 0;
	}
	if (k == m->sights) {
		end_way(m);
		return;
	}
	if (m->nodes++ > NODES_MAX)
		return;
	if (m->taken[k][spot]) {
		search_ways(m, k, spot + 1);
		return;
	}
	for (int i = 0; i < m->candidates; i++) {
		const struct lamp_track *t = &m->candidate[i];

		if (t->spot[k] != spot || !is_free(m, t))
			continue;
		take_track(m, t, true);
		m->chosen[m->count++] = i;
		search_ways(m, k, spot + 1);
		m->count--;
		take_track(m, t, false);
	}
	m->taken[k][spot] = true;
	search_ways(m, k, spot + 1);
	m->taken[k][spot] = false;
}

/* ---- what is said ---- */

/* Doubts a spot that no track has, or whose light some place does not see, if that matters. */
static void judge_spot(const struct matching *m, int k, int spot, const struct lamp_track *t,
		       struct verdict *verdict)
{
	const struct lamp_spot *s = &m->sight[k].spot[spot];
	char text[SIGHT_TEXT_MAX];

	lamp_sight_text(s->dir, text);
	if (t && t->seen == m->sights)
		return;
	if (s->clipped ? !s->resolved : m->sight[k].share[spot] < STRONG) {
		if (!t)
			log_info("%s: a weak light at %s is seen from there alone, and left out",
				 m->sight[k].name, text);
		return;
	}
	verdict_doubt(
		verdict,
		"leave lamps on, remain where none is hidden, keep the fisheye turned as before, and check --at",
		"the light at %s in %s is not seen%s where it has to be from the other places: it moved or was hidden, or a place is wrong",
		text, m->sight[k].name, t ? " from one place" : "");
}

static void judge_way(const struct matching *m, const struct lamp_track *track, int tracks,
		      struct verdict *verdict)
{
	for (int k = 0; k < m->sights; k++)
		for (int spot = 0; spot < m->sight[k].count; spot++) {
			const struct lamp_track *t = NULL;

			for (int i = 0; i < tracks; i++)
				if (track[i].spot[k] == spot)
					t = &track[i];
			judge_spot(m, k, spot, t, verdict);
		}
	if (m->overflow || m->nodes > NODES_MAX || m->rival < m->best.squares + CLEARLY_WORSE)
		verdict_doubt(
			verdict,
			m->sights > 2
				? "lay it at another place, off the line through the others"
				: "add a third place, off the line through the two and not at their height",
			"the lights can be taken together in more than one way: they lie in one plane with the places");
}

int lamp_match(const struct lamp_sight *sight, int sights, const struct lamp_deviations *deviation,
	       struct lamp_track track[SIGHT_SPOTS_MAX], struct verdict *verdict)
{
	struct matching *m = calloc(1, sizeof(*m));
	struct lamp_track t = {.seen = 0};
	int count = 0;

	if (!m)
		return -ENOMEM;
	m->sight = sight;
	m->sights = sights;
	m->deviation = deviation;
	m->rival = INFINITY;
	m->best.matched = -1;
	m->candidate = calloc(CANDIDATES_MAX, sizeof(*m->candidate));
	if (!m->candidate) {
		free(m);
		return -ENOMEM;
	}
	list_candidates(m, &t, 0);
	search_ways(m, 0, 0);
	/* The search took them in the order of the first place's spots: the strongest first. */
	for (; count < m->best.count && count < SIGHT_SPOTS_MAX; count++)
		track[count] = m->candidate[m->best.chosen[count]];
	judge_way(m, track, count, verdict);
	free(m->candidate);
	free(m);
	return count;
}
