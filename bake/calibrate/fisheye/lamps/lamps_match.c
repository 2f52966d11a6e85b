/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/lamps/lamps_match.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_turn.h"
#include "hal/optics/vec.h"

#define NEAR_RAD 0.15	/* error of a guess's lens and middle */
#define APART_RAD 0.3	/* lamps of a pair nearer than this do not determine a rotation */
#define OTHERWISE 0.15	/* rad: guesses with rotations nearer than this are the same */
#define HINT_SHARE 0.12 /* of the picture's width: error of a hint */
#define FIELDS 8	/* number of fields of view tried */
#define QUICK 8		/* lamps scored first */
#define SPOTS_TRIED 120

struct ray_set {
	int count;
	double ray[SPOTS_TRIED][3];
};

struct matching {
	const struct lamp_scene *scene;
	struct ray_set seen;
	struct lamp_guess *guess;
	int guesses;
	uint32_t chance;
};

void lamp_spot_px(const struct lamp_scene *scene, bool mirrored, int spot, double px[2])
{
	const double *at = scene->spots->spot[spot].px;

	px[0] = mirrored ? scene->width - at[0] : at[0];
	px[1] = at[1];
}

bool lamp_expect(const struct lamp_scene *scene, const struct lamp_guess *guess, int lamp,
		 double most_rad, double px[2])
{
	double camera[3];

	mat_apply(guess->rotation, scene->lamps->lamp[lamp].dir, camera);
	return camera[2] > cos(most_rad) &&
	       optics_project(&guess->optics, camera, px, NULL, NULL) && px[0] >= 0 && px[1] >= 0 &&
	       px[0] <= scene->width && px[1] <= scene->height;
}

/* ---- how well a guess does ---- */

static bool obeys_hints(const struct lamp_scene *scene, const struct lamp_guess *guess)
{
	for (int n = 0; n < scene->lamps->count; n++) {
		const struct lamp *lamp = &scene->lamps->lamp[n];
		double px[2], near_x = lamp->near_px[0];

		if (!lamp->hinted)
			continue;
		near_x = guess->mirrored ? scene->width - near_x : near_x;
		if (!lamp_expect(scene, guess, n, M_PI, px) ||
		    hypot(px[0] - near_x, px[1] - lamp->near_px[1]) > HINT_SHARE * scene->width)
			return false;
	}
	return true;
}

/* Returns 1 if a spot is at the ray, 0 if none is near. */
static double nearness_of_ray(const struct ray_set *seen, const double ray[3])
{
	const double near = 1 - cos(NEAR_RAD);
	double least = near;

	for (int n = 0; n < seen->count; n++)
		least = fmin(least, 1 - vec_dot(seen->ray[n], ray));
	return 1 - least / near;
}

static double score_of(const struct matching *matching, const double rotation[9], double enough)
{
	const struct lamps *lamps = matching->scene->lamps;
	const int stride = lamps->count / QUICK + 1;
	double score = 0, ray[3];
	int left = lamps->count;

	for (int first = 0; first < stride; first++)
		for (int n = first; n < lamps->count; n += stride) {
			mat_apply(rotation, lamps->lamp[n].dir, ray);
			score += nearness_of_ray(&matching->seen, ray);
			if (score + --left <= enough)
				return 0;
		}
	return score;
}

static double turned_by(const double a[9], const double b[9])
{
	double trace = 0;

	for (int i = 0; i < 9; i++)
		trace += a[i] * b[i];
	return acos(fmin(fmax((trace - 1) / 2, -1), 1));
}

static int by_score(const void *a, const void *b)
{
	const double x = ((const struct lamp_guess *)a)->score;
	const double y = ((const struct lamp_guess *)b)->score;

	return x < y ? 1 : x > y ? -1 : 0;
}

/* Keeps a guess if it is among the best; of guesses with similar rotations only the best stays. */
static void guesses_keep(struct matching *matching, const struct lamp_guess *guess)
{
	int at = 0;

	while (at < matching->guesses &&
	       (matching->guess[at].mirrored != guess->mirrored ||
		turned_by(matching->guess[at].rotation, guess->rotation) > OTHERWISE))
		at++;
	if (at == matching->guesses && at == GUESSES_MAX)
		at--; /* the worst, as they are sorted */
	if (at < matching->guesses && matching->guess[at].score >= guess->score)
		return;
	matching->guesses = at < matching->guesses ? matching->guesses : at + 1;
	matching->guess[at] = *guess;
	qsort(matching->guess, (size_t)matching->guesses, sizeof(*guess), by_score);
}

/* ---- where guesses come from ---- */

/* Orthonormal frame along the sum and the difference of two directions. */
static void frame_of(const double a[3], const double b[3], double frame[3][3])
{
	for (int i = 0; i < 3; i++) {
		frame[0][i] = a[i] + b[i];
		frame[1][i] = a[i] - b[i];
	}
	vec_normalize(frame[0]);
	vec_normalize(frame[1]);
	vec_cross(frame[0], frame[1], frame[2]);
}

static void turn_of(const double world[3][3], const double camera[3][3], double rotation[9])
{
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			rotation[3 * i + k] = camera[0][i] * world[0][k] +
					      camera[1][i] * world[1][k] +
					      camera[2][i] * world[2][k];
}

static void try_pair(struct matching *matching, struct lamp_guess *guess, int first, int second)
{
	const struct lamps *lamps = matching->scene->lamps;
	const struct ray_set *seen = &matching->seen;
	const double *a = lamps->lamp[first].dir, *b = lamps->lamp[second].dir;
	const double apart = acos(fmin(fmax(vec_dot(a, b), -1), 1));
	const double most = cos(apart + 1.5 * NEAR_RAD),
		     least = cos(fmax(apart - 1.5 * NEAR_RAD, 0));
	double world[3][3], camera[3][3];

	if (apart < APART_RAD || apart > M_PI - APART_RAD)
		return;
	frame_of(a, b, world);
	for (int i = 0; i < seen->count; i++)
		for (int k = 0; k < seen->count; k++) {
			const double dot = vec_dot(seen->ray[i], seen->ray[k]);
			const int kept = matching->guesses;
			const bool full = kept == GUESSES_MAX;

			if (i == k || dot > least || (dot < most && apart + 1.5 * NEAR_RAD < M_PI))
				continue;
			frame_of(seen->ray[i], seen->ray[k], camera);
			turn_of(world, camera, guess->rotation);
			guess->score = score_of(matching, guess->rotation,
						full ? matching->guess[kept - 1].score : 2);
			if (guess->score > 2 && obeys_hints(matching->scene, guess))
				guesses_keep(matching, guess);
		}
}

/* Returns a pseudo-random index, the same sequence in each run. */
static int choose_lamp(struct matching *matching, int count)
{
	matching->chance = matching->chance * 1664525 + 1013904223;
	return (int)((matching->chance >> 8) % (uint32_t)count);
}

static void try_pairs(struct matching *matching, struct lamp_guess *guess)
{
	const int lamps = matching->scene->lamps->count;
	const int all = lamps * (lamps - 1) / 2;
	const int tried = lamps > 12 ? 24 : all;

	if (tried == all) {
		for (int a = 1; a < lamps; a++)
			for (int b = 0; b < a; b++)
				try_pair(matching, guess, a, b);
		return;
	}
	for (int k = 0; k < tried; k++) {
		const int a = choose_lamp(matching, lamps), b = choose_lamp(matching, lamps);

		if (a != b)
			try_pair(matching, guess, a, b);
	}
}

/* Computes the rays of the spots for this lens. */
static void take_rays(struct matching *matching, const struct lamp_guess *guess)
{
	const struct spots *spots = matching->scene->spots;
	struct ray_set *seen = &matching->seen;

	seen->count = 0;
	for (int n = 0; n < spots->count && n < SPOTS_TRIED; n++) {
		double px[2];

		lamp_spot_px(matching->scene, guess->mirrored, n, px);
		seen->count += optics_ray(&guess->optics, px, seen->ray[seen->count]);
	}
}

int lamps_guess(const struct lamp_scene *scene, double squash, struct lamp_guess guess[GUESSES_MAX])
{
	static const enum fisheye_model models[] = {FISHEYE_EQUIDISTANT, FISHEYE_STEREOGRAPHIC,
						    FISHEYE_ORTHOGRAPHIC};
	const double side = fmin(scene->width, scene->height / squash);
	struct matching *matching = calloc(1, sizeof(*matching));
	int count;

	if (!matching)
		return -ENOMEM;
	matching->scene = scene;
	matching->guess = guess;
	for (int k = 0; k < 2 * 3 * FIELDS; k++) {
		const struct fisheye_curve curve = {.model = models[k / 2 % 3]};
		/* The radius at 90 degrees is 0.35 to 0.8 of the smaller side. */
		const double rim = side * 0.35 * pow(0.8 / 0.35, k / 6 / (FIELDS - 1.0));
		const double focal = rim / fisheye_curve_radius(&curve, M_PI / 2);
		struct lamp_guess trial = {
			.optics = {.model = curve.model,
				   .number = {focal, squash * focal, scene->width / 2.0,
					      scene->height / 2.0}},
			.mirrored = k % 2,
		};

		take_rays(matching, &trial);
		try_pairs(matching, &trial);
	}
	count = matching->guesses;
	free(matching);
	return count;
}
