/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/lamps/fisheye_lamps.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_doubts.h"
#include "bake/calibrate/fisheye/lamps/lamps_trace.h"

/* Least share of lamps that must be found. */
#define FOUND_SHARE 0.6
/* Largest number of lenses expected to fit as well by chance. */
#define CHANCE_MOST 1e-3
/* Distance of a spot from its lamp, in deviations, that counts as a match, and its least value. */
#define NEAR 3.0
#define NEAREST_PX 0.5
/* Assignments are equally likely if the logarithms of their chances differ by less. */
#define SURER 1e-6
/* Limits for another assignment of the lamps to fit about as well. */
#define OTHERWISE_TIMES 2.0
#define OTHERWISE_PX 0.3

static const double squashes[] = {1, 0.5, 2};

/* ---- whether it is chance ---- */

/* Area where spots may be: the image circle within the picture. */
static double area_px2(const struct lamp_scene *scene, const struct optics *optics)
{
	const struct fisheye_curve curve = optics_curve(optics);
	const double rim = fisheye_curve_radius(&curve, M_PI / 2);

	return fmin(M_PI * optics->number[OPTICS_FOCAL] * optics->number[OPTICS_FOCAL + 1] * rim *
			    rim,
		    (double)scene->width * scene->height);
}

/*
 * Among many spots, some are where some lens shows lamps. Returns ln of the number of lenses that
 * would be expected to match as many lamps as well if the spots were random (the number of false
 * alarms of Moisan and Stival 2004). The number of lenses tried is the number of ways to choose the
 * lamps that its parameters can be fitted to, without those that hints determine; the others match
 * by luck, with a probability bounded by Chernoff.
 */
static double chance_log(const struct lamp_scene *scene, const struct lamp_trace *trace)
{
	const int parameters = 3 + (trace->lens.optics.model == FISHEYE_POLYNOMIAL ? OPTICS_COUNT
										   : OPTICS_TERMS);
	const double lamps = scene->lamps->count, spots = scene->spots->count;
	double bent = parameters / 2.0, beyond, left, near, luck, log_luck = 0;

	for (int n = 0; n < scene->lamps->count; n++)
		bent -= trace->spot[n] >= 0 && scene->lamps->lamp[n].hinted;
	bent = fmax(bent, 0);
	beyond = fmax(trace->found - bent, 0);
	left = fmax(fmin(lamps, spots) - bent, 0);
	/* lamps that the lens was fitted to are nearer than its true error */
	near = fmax(NEAREST_PX, NEAR * trace->deviation_px * sqrt(trace->found / beyond));
	near = fmin(near, trace->reach_px);
	luck = fmin(1,
		    fmax(lamps, spots) * M_PI * near * near / area_px2(scene, &trace->lens.optics));
	if (beyond > luck * left)
		log_luck = -beyond * log(beyond / (luck * left));
	if (beyond > luck * left && beyond < left)
		log_luck -= (left - beyond) * log((left - beyond) / ((1 - luck) * left));
	return bent * log(lamps * spots) - lgamma(bent + 1) + log_luck;
}

/* Whether the match may be chance; finding every lamp or spot is none, however few there are. */
static bool is_chance(const struct lamp_scene *scene, const struct lamp_trace *trace)
{
	return trace->found < scene->lamps->count && trace->found < scene->spots->count &&
	       chance_log(scene, trace) > log(CHANCE_MOST);
}

/* ---- the best of all ways to see it ---- */

static bool is_better(const struct lamp_scene *scene, const struct lamp_trace *a,
		      const struct lamp_trace *b)
{
	const double more = chance_log(scene, b) - chance_log(scene, a);

	if (fabs(more) > SURER)
		return more > 0;
	if (a->lens.mirrored != b->lens.mirrored)
		return b->lens.mirrored;
	return a->deviation_px < b->deviation_px;
}

static bool is_other(const struct lamp_trace *a, const struct lamp_trace *b, int lamps)
{
	return a->lens.mirrored == b->lens.mirrored &&
	       memcmp(a->spot, b->spot, (size_t)lamps * sizeof(*a->spot)) != 0;
}

/* Follows every guess; *best is the one that explains most, *otherwise whether another one does as
 * well. */
static int follow_guesses(struct lamp_trace *best, bool *otherwise, const struct lamp_scene *scene,
			  double squash, int wanted)
{
	struct lamp_guess guess[GUESSES_MAX];
	struct lamp_trace trace[GUESSES_MAX] = {{.spot = NULL}};
	const int guesses = lamps_guess(scene, squash, guess);
	int which = -1, err = guesses < 0 ? guesses : 0;

	for (int k = 0; k < guesses && !err; k++) {
		err = lamps_trace(&trace[k], scene, &guess[k], wanted);
		if (!err && trace[k].found &&
		    (which < 0 || is_better(scene, &trace[k], &trace[which])))
			which = k;
	}
	for (int k = 0; k < guesses && !err && which >= 0; k++)
		if (trace[k].found == trace[which].found &&
		    is_other(&trace[k], &trace[which], scene->lamps->count) &&
		    trace[k].deviation_px <
			    OTHERWISE_TIMES * trace[which].deviation_px + OTHERWISE_PX)
			*otherwise = true;
	if (!err && which >= 0) {
		*best = trace[which];
		trace[which].spot = NULL;
	}
	for (int k = 0; k < GUESSES_MAX; k++)
		lamps_trace_free(&trace[k]);
	return err;
}

/* Whether the match explains enough: some spots are no lamps, and some lamps are hidden. */
static bool explains_enough(const struct lamp_trace *trace, const struct lamp_scene *scene)
{
	const double all = fmin(scene->lamps->count, scene->spots->count);

	return trace->found > FOUND_SHARE * all;
}

static int search_squashes(struct lamp_trace *best, bool *otherwise, const struct lamp_scene *scene,
			   int wanted)
{
	int err = 0;

	for (size_t k = 0; k < sizeof(squashes) / sizeof(*squashes) && !err; k++) {
		struct lamp_trace trace = {.spot = NULL};
		bool either = false;

		if (k && best->found && explains_enough(best, scene) && !is_chance(scene, best))
			break;
		err = follow_guesses(&trace, &either, scene, squashes[k], wanted);
		if (!err && trace.found && (!best->found || is_better(scene, &trace, best))) {
			lamps_trace_free(best);
			*best = trace;
			*otherwise = either;
		} else {
			lamps_trace_free(&trace);
		}
	}
	return err;
}

/* ---- what is said ---- */

__attribute__((format(printf, 3, 4))) static void told_list(char *text, size_t room,
							    const char *format, ...)
{
	const size_t used = strlen(text);
	va_list args;

	va_start(args, format);
	if (used)
		snprintf(text + used, room - used, ", ");
	vsnprintf(text + strlen(text), room - strlen(text), format, args);
	va_end(args);
}

static bool is_lamp(const struct lamp_trace *trace, int lamps, int spot)
{
	for (int n = 0; n < lamps; n++)
		if (trace->spot[n] == spot)
			return true;
	return false;
}

/* Whether a spot holds merged lamps. */
static bool holds_lamps(const struct lamp_scene *scene, const struct lamp_trace *trace, int spot)
{
	const struct spot *s = &scene->spots->spot[spot];
	double at[2], px[2];

	lamp_spot_px(scene, trace->lens.mirrored, spot, at);
	for (int n = 0; n < scene->lamps->count; n++)
		if (trace->spot[n] == SPOT_MERGED &&
		    lamp_expect(scene, &trace->lens, n, M_PI, px) &&
		    hypot(px[0] - at[0], px[1] - at[1]) < s->radius_px + 3)
			return true;
	return false;
}

static void tell_lamps(struct lamps_told *told, const struct lamp_scene *scene,
		       const struct lamp_trace *trace, double field_deg)
{
	const int lamps = scene->lamps->count;

	for (int n = 0; n < lamps; n++) {
		double px[2];
		const bool inside = lamp_expect(scene, &trace->lens, n, field_deg * (M_PI / 180),
						px);

		told->expected += inside || trace->spot[n] >= 0;
		if (trace->spot[n] == SPOT_MERGED)
			told_list(told->merged, sizeof(told->merged), "%d",
				  scene->lamps->lamp[n].line);
		else if (trace->spot[n] < 0 && inside)
			told_list(told->missing, sizeof(told->missing), "%d at (%.0f, %.0f)",
				  scene->lamps->lamp[n].line,
				  trace->lens.mirrored ? scene->width - px[0] : px[0], px[1]);
	}
	for (int k = 0; k < scene->spots->count; k++)
		if (!is_lamp(trace, lamps, k) && !holds_lamps(scene, trace, k))
			told_list(told->strange, sizeof(told->strange), "(%.0f, %.0f)",
				  scene->spots->spot[k].px[0], scene->spots->spot[k].px[1]);
}

static void doubt_none(struct verdict *verdict, const struct lamp_scene *scene, const char *name,
		       const struct fisheye_wanted *wanted)
{
	const int fewest = fisheye_fewest(&(struct lens_problem){.directions = true}, wanted);

	if (scene->spots->count < 4)
		verdict_doubt(verdict,
			      "expose so that lamps alone are white, in a darker room, and none of "
			      "them cut by the picture's edge",
			      "%s shows %d bright spots, fewer than 4", name, scene->spots->count);
	if (scene->lamps->count < fewest)
		verdict_doubt(verdict, "add lamps in other directions, out to the rim",
			      "there are %d lamps, fewer than the %d that tell a lens",
			      scene->lamps->count, fewest);
	verdict_doubt(verdict,
		      "check azimuth and elevation, and their axes; or say in the file about "
		      "where lamps are seen: xf yf",
		      "the bright spots of %s are not where any fisheye shows the lamps", name);
}

static void doubt_matches(struct verdict *verdict, const struct lamps_told *told,
			  const char *lamps_name)
{
	if (told->otherwise)
		verdict_doubt(
			verdict,
			"say in the file about where two of them are seen (xf yf), or move one",
			"the lamps look alike when the picture is turned: which is which "
			"cannot be told");
	if (told->found < FOUND_SHARE * told->expected)
		verdict_doubt(verdict,
			      "see that all are lit and white, and check the directions of those "
			      "that are missing",
			      "only %d of the %d lamps of %s were found", told->found,
			      told->expected, lamps_name);
}

static int lamps_conclude(struct fisheye_result *result, struct observations *seen,
			  struct lamps_told *told, const struct lamp_scene *scene,
			  const struct lamp_trace *trace, const char *lamps_name, const char *name,
			  const struct fisheye_wanted *wanted, struct fault *fault)
{
	struct fisheye_wanted own = *wanted;
	int err;

	own.directions = true;
	told->lamps = scene->lamps->count;
	told->found = trace->found;
	if (!trace->found || is_chance(scene, trace)) {
		told->found = 0;
		*seen = (struct observations){.width = scene->width, .height = scene->height};
		err = observations_begin_view(seen, name);
		if (!err)
			err = finding_create(&result->finding, "fisheye", seen);
		if (!err)
			doubt_none(&result->finding.verdict, scene, name, &own);
		return err;
	}
	tell_lamps(told, scene, trace, wanted->field_deg);
	err = lamps_observe(seen, scene, trace, false, lamps_name, name);
	if (!err)
		err = fisheye_find(result, seen, &own, fault);
	if (!err)
		doubt_matches(&result->finding.verdict, told, lamps_name);
	return err;
}

int fisheye_lamps(struct fisheye_result *result, struct observations *seen, struct lamps_told *told,
		  const struct lamps *lamps, const char *lamps_name, const struct image *picture,
		  const char *name, const struct fisheye_wanted *wanted, struct fault *fault)
{
	struct spots spots;
	struct lamp_trace best = {.spot = NULL};
	const struct lamp_scene scene = {.lamps = lamps,
					 .spots = &spots,
					 .width = picture->width,
					 .height = picture->height};
	int err = spots_find(&spots, picture);

	*told = (struct lamps_told){.lamps = 0};
	*result = (struct fisheye_result){.oriented = false};
	if (!err)
		err = search_squashes(&best, &told->otherwise, &scene, wanted->model);
	if (!err)
		err = lamps_conclude(result, seen, told, &scene, &best, lamps_name, name, wanted,
				     fault);
	if (err == -ENOMEM)
		fault_say(fault, err, "%s: out of memory", name);
	lamps_trace_free(&best);
	spots_free(&spots);
	return err;
}

void lamps_print(FILE *to, const char *before, const struct lamps_told *told, const char *name)
{
	fprintf(to, "%s%d of %d lamps found", before, told->found, told->lamps);
	if (told->expected < told->lamps)
		fprintf(to, ", %d of which the picture can show", told->expected);
	fprintf(to, "\n");
	if (*told->missing)
		fprintf(to, "%snot seen: %s, lines %s\n", before, name, told->missing);
	if (*told->merged)
		fprintf(to, "%smerged, and left out: %s, lines %s\n", before, name, told->merged);
	if (*told->strange)
		fprintf(to, "%sbright, but no lamps: %s\n", before, told->strange);
}
