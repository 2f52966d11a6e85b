/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/lamps/lamp_places.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/optics/vec.h"

/* Light from farther away differs by less than 2 % over 0.15 m, half of an object: the bar of tests/accuracy. */
#define NEAR_M 15.0
/* Below this angle between its direction and the line through the places they see a lamp from one side alone. */
#define IN_LINE (10 * M_PI / 180)

enum { POSE = 6 }; /* unknowns of a place: what it moved by, and its turn */

struct problem {
	const struct lamp_places *places;
	const struct lamp_track *track; /* [lamps.count] */
};

static const struct lamp_spot *spot_of(const struct problem *p, int lamp, int k)
{
	const int spot = p->track[lamp].spot[k];

	return spot < 0 ? NULL : &p->places->sight[k].spot[spot];
}

/* The direction in which place k sees a lamp, in the axes that it is said to have. */
static bool expected_direction(const struct problem *p, const double *x, int lamp, int k,
			       double dir[3])
{
	const double *pose = x + 3 * p->places->lamps.count + POSE * k;
	double to[3], turn[3];

	for (int i = 0; i < 3; i++)
		to[i] = x[3 * lamp + i] - p->places->sight[k].at[i] - pose[i];
	if (!(vec_normalize(to) > 0))
		return false;
	vec_cross(pose + 3, to, turn);
	for (int i = 0; i < 3; i++)
		dir[i] = to[i] + turn[i];
	vec_normalize(dir);
	return true;
}

static bool evaluate(void *context, const double *x, double *residual)
{
	const struct problem *p = context;
	const struct lamp_deviations *deviation = &p->places->deviation;
	const double *pose = x + 3 * p->places->lamps.count;

	for (int lamp = 0; lamp < p->places->lamps.count; lamp++)
		for (int k = 0; k < p->places->sights; k++) {
			const struct lamp_spot *spot = spot_of(p, lamp, k);
			double dir[3], across[3], up[3], axis[3] = {0};

			if (!spot)
				continue;
			if (!expected_direction(p, x, lamp, k, dir))
				return false;
			axis[fabs(spot->dir[2]) < 0.7 ? 2 : 0] = 1;
			vec_cross(axis, spot->dir, across);
			vec_normalize(across);
			vec_cross(spot->dir, across, up);
			*residual++ = vec_dot(dir, across) / (deviation->px * spot->pixel);
			*residual++ = vec_dot(dir, up) / (deviation->px * spot->pixel);
		}
	for (int i = 0; i < POSE * p->places->sights; i++)
		*residual++ = pose[i] / (i % POSE < 3 ? deviation->place_m : deviation->turn);
	return true;
}

/* ---- the result ---- */

/* The radius of each lamp: the mean of what the places see. */
static void find_radius(struct lamp_places *places, const struct problem *p, int lamp)
{
	double sum = 0, square = 0;
	int n = 0;

	places->radius_known[lamp] = true;
	for (int k = 0; k < places->sights; k++) {
		const struct lamp_spot *spot = spot_of(p, lamp, k);
		double to[3], radius;

		if (!spot)
			continue;
		for (int i = 0; i < 3; i++)
			to[i] = places->lamps.lamp[lamp].position[i] - places->sight[k].at[i];
		radius = vec_length(to) * sin(spot->radius);
		sum += radius;
		square += radius * radius;
		n++;
		places->radius_known[lamp] &= spot->resolved && !spot->clipped;
	}
	places->lamps.lamp[lamp].radius = sum / n;
	places->radius_deviation_m[lamp] = sqrt(fmax(0, square - sum * sum / n) / (n - 1));
}

static int add_points(struct lamp_places *places, const struct problem *p,
		      struct observations *seen)
{
	int err = 0;

	for (int k = 0; !err && k < places->sights; k++) {
		err = observations_begin_view(seen, places->sight[k].name);
		for (int lamp = 0; !err && lamp < places->lamps.count; lamp++)
			if (spot_of(p, lamp, k))
				err = observations_add(seen, places->lamps.lamp[lamp].position,
						       spot_of(p, lamp, k)->px, "lamp%d", lamp + 1);
	}
	return err;
}

/* Where the lamps are expected in the pictures. */
static void expect_points(struct lamp_places *places, const struct problem *p, const double *x)
{
	struct finding *f = &places->finding;
	double sum = 0;
	int i = 0;

	for (int k = 0; k < places->sights; k++)
		for (int lamp = 0; lamp < places->lamps.count; lamp++) {
			double dir[3], off;

			if (!spot_of(p, lamp, k))
				continue;
			f->weight[i] = 1;
			if (!expected_direction(p, x, lamp, k, dir) ||
			    !fisheye_project(&places->lens, dir, f->expected[i]))
				f->expected[i][0] = f->expected[i][1] = NAN;
			off = hypot(f->expected[i][0] - f->seen->point[i].px[0],
				    f->expected[i][1] - f->seen->point[i].px[1]);
			sum += off * off;
			f->worst_px = fmax(f->worst_px, off);
			i++;
		}
	f->rms_px = sqrt(sum / i);
}

static bool project_world(const void *context, int view, const double world[3], double px[2])
{
	const struct lamp_places *places = context;
	double dir[3];

	for (int i = 0; i < 3; i++)
		dir[i] = world[i] - places->sight[view].at[i] - places->moved[view][i];
	return fisheye_project(&places->lens, dir, px);
}

static int publish(struct lamp_places *places, const struct problem *p, const double *x,
		   const struct least_squares_fit *fit, int unknowns)
{
	static const char *const name[4] = {"x", "y", "z", "radius"};
	struct finding *f = &places->finding;
	const int lamps = places->lamps.count, columns = 4 * lamps;
	int err = estimate_create(&f->estimate, columns);

	if (err)
		return err;
	snprintf(f->model, sizeof(f->model), "lamps at places");
	f->project = project_world;
	f->context = places;
	expect_points(places, p, x);
	f->estimate.residuals = 2 * f->seen->count;
	f->estimate.freedom = f->estimate.residuals - 3 * lamps;
	f->estimate.sigma = f->rms_px;
	for (int k = 0; k < columns; k++) {
		const struct lamp *lamp = &places->lamps.lamp[k / 4];
		struct parameter *parameter = &f->estimate.parameter[k];
		double *covariance = f->estimate.covariance + k * columns;

		snprintf(parameter->name, sizeof(parameter->name), "lamp%d %s", k / 4 + 1,
			 name[k % 4]);
		snprintf(parameter->unit, sizeof(parameter->unit), "m");
		parameter->value = k % 4 < 3 ? lamp->position[k % 4] : lamp->radius;
		for (int j = 0; k % 4 < 3 && j < columns; j++)
			if (j % 4 < 3)
				covariance[j] = fit->inverse[(k / 4 * 3 + k % 4) * unknowns +
							     j / 4 * 3 + j % 4];
	}
	for (int lamp = 0; lamp < lamps; lamp++) {
		double *radius_m = &places->radius_deviation_m[lamp], square = 0;
		char key[32], label[64];

		for (int i = 0; i < 3; i++)
			square += pow(estimate_deviation(&f->estimate, 4 * lamp + i), 2);
		places->deviation_m[lamp] = sqrt(square);
		/* An angle is as large as it is; the distance makes a radius of it. */
		*radius_m = hypot(*radius_m, places->lamps.lamp[lamp].radius *
						     places->deviation_m[lamp] /
						     p->track[lamp].least_m);
		f->estimate.covariance[(4 * lamp + 3) * (columns + 1)] = *radius_m * *radius_m;
		snprintf(key, sizeof(key), "lamp%d_deviation_m", lamp + 1);
		snprintf(label, sizeof(label), "deviation of the place of lamp%d", lamp + 1);
		finding_add(f, key, label, "m", places->deviation_m[lamp]);
	}
	return 0;
}

/* ---- doubts ---- */

static void doubt_places(struct lamp_places *places, const struct problem *p, double squares)
{
	struct verdict *verdict = &places->finding.verdict;

	if (!(squares <= lamp_most_squares(places->finding.estimate.freedom)))
		verdict_doubt(
			verdict,
			"check --at and the lens's rotation, keep the fisheye turned as before, and leave lamps where they are",
			"the directions do not meet: their residuals have squares of %.0f, expected at most %.0f",
			squares, lamp_most_squares(places->finding.estimate.freedom));
	for (int lamp = 0; lamp < places->lamps.count; lamp++)
		if (!(places->deviation_m[lamp] <= places->tolerance * p->track[lamp].least_m))
			verdict_doubt(
				verdict,
				"lay the fisheye farther apart, across the direction of that lamp, and tell the places more exactly",
				"the place of lamp%d, near %.2f,%.2f,%.2f, deviates by %.2g m, more than %.0f %% of its distance",
				lamp + 1, places->lamps.lamp[lamp].position[0],
				places->lamps.lamp[lamp].position[1],
				places->lamps.lamp[lamp].position[2], places->deviation_m[lamp],
				100 * places->tolerance);
}

/* Whether every other place lies in line with the first one, as seen along a direction. */
static bool is_in_line(const struct lamp_places *places, const double dir[3])
{
	for (int k = 1; k < places->sights; k++) {
		double line[3], across[3];

		for (int i = 0; i < 3; i++)
			line[i] = places->sight[k].at[i] - places->sight[0].at[i];
		vec_normalize(line);
		vec_cross(line, dir, across);
		if (vec_length(across) > sin(IN_LINE))
			return false;
	}
	return true;
}

static void judge_far(struct lamp_places *places, const struct lamp_track *track)
{
	char text[SIGHT_TEXT_MAX];

	lamp_sight_text(track->at, text);
	if (track->least_m >= NEAR_M)
		log_info("the light at %s is at least %.0f m away: it stays light from afar", text,
			 track->least_m);
	else if (is_in_line(places, track->at))
		verdict_doubt(
			&places->finding.verdict, "lay the fisheye at another place, off that line",
			"the light at %s lies in line with the places: nobody can tell how far away it is",
			text);
	else
		verdict_doubt(&places->finding.verdict,
			      "lay the fisheye farther apart, and tell the places more exactly",
			      "the light at %s shows no parallax: it may be anywhere beyond %.1f m",
			      text, track->least_m);
}

/* ---- all of it ---- */

static int solve_places(struct lamp_places *places, const struct lamp_track *track,
			struct observations *seen, struct fault *fault)
{
	struct problem p = {places, track};
	const int lamps = places->lamps.count, unknowns = 3 * lamps + POSE * places->sights;
	double x[3 * LAMPS_MAX + POSE * SIGHT_PLACES_MAX] = {0};
	double scale[3 * LAMPS_MAX + POSE * SIGHT_PLACES_MAX];
	struct least_squares problem = {.parameters = unknowns,
					.residuals = POSE * places->sights,
					.evaluate = evaluate,
					.context = &p,
					.scale = scale,
					.group = 1};
	struct least_squares_fit fit = {.sigma = 0};
	int err;

	for (int i = 0; i < unknowns; i++) /* a metre of a lamp; a deviation of a place */
		scale[i] = i < 3 * lamps		? 1
			   : (i - 3 * lamps) % POSE < 3 ? places->deviation.place_m
							: places->deviation.turn;
	for (int lamp = 0; lamp < lamps; lamp++) {
		memcpy(x + 3 * lamp, track[lamp].at, sizeof(track[lamp].at));
		problem.residuals += 2 * track[lamp].seen;
	}
	err = least_squares_solve(&problem, x, &fit, fault);
	if (err == -ENOMEM)
		return err;
	for (int lamp = 0; lamp < lamps; lamp++) {
		memcpy(places->lamps.lamp[lamp].position, x + 3 * lamp, 3 * sizeof(*x));
		find_radius(places, &p, lamp);
	}
	for (int k = 0; k < places->sights; k++)
		memcpy(places->moved[k], x + 3 * lamps + POSE * k, sizeof(places->moved[k]));
	if (err) {
		verdict_doubt(&places->finding.verdict, "lay the fisheye at other places", "%s",
			      fault->text);
	}
	err = add_points(places, &p, seen);
	if (!err) {
		struct finding *f = &places->finding;
		const struct verdict verdict = f->verdict;

		err = finding_create(f, "lamps", seen);
		f->verdict = verdict;
	}
	if (!err)
		err = publish(places, &p, x, &fit, unknowns);
	if (!err)
		doubt_places(places, &p, fit.squares);
	least_squares_free(&fit);
	return err ? fault_say(fault, err, "out of memory") : 0;
}

int lamp_places_find(struct lamp_places *places, struct observations *seen, struct fault *fault)
{
	struct verdict *verdict = &places->finding.verdict;
	struct lamp_track track[SIGHT_SPOTS_MAX], near[LAMPS_MAX];
	int tracks, left = 0;

	places->lamps.count = 0;
	places->finding.seen = seen;
	verdict_begin(verdict);
	for (int k = 0; k < places->sights; k++)
		if (!places->sight[k].count)
			verdict_doubt(verdict, "expose less, so that lamps stand out",
				      "no lamp is to be seen in %s", places->sight[k].name);
	tracks = lamp_match(places->sight, places->sights, &places->deviation, track, verdict);
	if (tracks < 0)
		return fault_say(fault, tracks, "out of memory");
	for (int i = 0; i < tracks; i++)
		if (track[i].far)
			judge_far(places, &track[i]);
		else if (places->lamps.count < LAMPS_MAX)
			near[places->lamps.count++] = track[i];
		else
			left++;
	if (left)
		log_info("%d more lamps of less light are left out: %d is the most", left,
			 LAMPS_MAX);
	if (!places->lamps.count) {
		verdict_doubt(verdict, "nothing has to be named", "no light is near");
		return 0;
	}
	return solve_places(places, near, seen, fault);
}

void lamp_places_free(struct lamp_places *places)
{
	finding_free(&places->finding);
}

int lamp_places_write(const struct lamp_places *places, const char *path, struct fault *fault)
{
	struct output out = {.stream = NULL};
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	fputs("; Lamps, by inlay-calibrate lamps, for the configuration of the kiosk. After +- stands one\n"
	      "; standard deviation.\n",
	      out.stream);
	finding_print(out.stream, "; ", &places->finding);
	for (int lamp = 0; lamp < places->lamps.count; lamp++) {
		const struct lamp *l = &places->lamps.lamp[lamp];

		fprintf(out.stream, "\n; +- %.2g m; radius +- %.1g m%s\n[lamp lamp%d]\n",
			places->deviation_m[lamp], places->radius_deviation_m[lamp],
			places->radius_known[lamp] ? "" : ", or smaller", lamp + 1);
		fprintf(out.stream, "position = %.4f %.4f %.4f\nradius = %.4f\n", l->position[0],
			l->position[1], l->position[2], fmax(l->radius, 0.001));
	}
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}
