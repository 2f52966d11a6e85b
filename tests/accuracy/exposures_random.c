/* SPDX-License-Identifier: MIT */
#include "tests/accuracy/exposures_random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_config.h"
#include "app/pipeline/pipeline_parts.h"
#include "app/settings.h"
#include "drivers/sim/sim.h"
#include "tests/support/chance.h"

#define SEED 1
#define PLACES 300
#define PLACES_QUICK 60
#define SIDE 480
#define PIXELS ((size_t)SIDE * SIDE)
#define THINGS_MAX 13
#define ALLOWED 0.05 /* largest share of places that may become worse */
#define SAME 0.05    /* levels; a smaller rise counts as no change */

enum kind { LAMP, WINDOW, WALL, KINDS };

struct thing {
	enum kind kind;
	double direction[3], radius_rad; /* lamps and walls */
	double azimuth_rad, half_rad, low_rad, high_rad;
	double rgb[3], glow;
};

struct random_place {
	struct thing thing[THINGS_MAX];
	int count, lamps;
	double zenith, horizon, warmth;
	double lamps_share; /* share of the light that the lamps give */
	double ground;	    /* radiance of a white ground */
};

/* ---- drawing one ---- */

static double decades(struct chance *c, double from, double to)
{
	return exp(chance_real(c, log(from), log(to)));
}

static void tint(double rgb[3], double radiance, double warmth)
{
	for (int c = 0; c < 3; c++)
		rgb[c] = radiance * exp((1 - c) * warmth);
}

static void draw_thing(struct chance *c, enum kind kind, struct thing *thing)
{
	static const double brightest[KINDS] = {1000, 100, 30}, dimmest[KINDS] = {1, 3, 1};
	const double z = kind == WALL ? sin(chance_real(c, 0, 0.9)) : chance_real(c, 0.02, 1);

	thing->kind = kind;
	thing->azimuth_rad = chance_real(c, -M_PI, M_PI);
	thing->direction[0] = sqrt(1 - z * z) * cos(thing->azimuth_rad);
	thing->direction[1] = sqrt(1 - z * z) * sin(thing->azimuth_rad);
	thing->direction[2] = z;
	thing->radius_rad = kind == WALL ? chance_real(c, 0.15, 0.6) : decades(c, 0.01, 0.1);
	thing->half_rad = chance_real(c, 0.08, 0.4);
	thing->low_rad = chance_real(c, 0.05, 0.7);
	thing->high_rad = thing->low_rad + chance_real(c, 0.15, 0.7);
	thing->glow = kind == LAMP ? decades(c, 1e-4, 3e-2) : 0;
	tint(thing->rgb, decades(c, dimmest[kind], brightest[kind]),
	     kind == WALL ? chance_real(c, -0.3, 0.3) : chance_real(c, -0.5, 0.5));
}

static void make_alike(struct random_place *place)
{
	for (int k = 1; k < place->lamps; k++) {
		place->thing[k].radius_rad = place->thing[0].radius_rad;
		memcpy(place->thing[k].rgb, place->thing[0].rgb, sizeof(place->thing[k].rgb));
	}
}

static void draw_place(struct chance *c, struct random_place *place)
{
	const int windows = (int)chance_real(c, 0, 3.5), walls = (int)chance_real(c, 0, 4.5);

	*place = (struct random_place){.lamps = (int)chance_real(c, 0, 7)};
	if (place->lamps + windows + walls == 0)
		place->lamps = 1;
	place->count = place->lamps + windows + walls;
	for (int k = 0; k < place->count; k++)
		draw_thing(c,
			   k < place->lamps		? LAMP
			   : k < place->lamps + windows ? WINDOW
							: WALL,
			   &place->thing[k]);
	if (chance_real(c, 0, 1) < 0.5)
		make_alike(place);
	place->zenith = decades(c, 0.5, 2);
	place->horizon = decades(c, 0.5, 2);
	place->warmth = chance_real(c, -0.2, 0.2);
	place->lamps_share = place->lamps ? chance_real(c, 0.1, 0.98) : 0;
	place->ground = chance_real(c, 0.4, 0.8);
}

/* ---- what it looks like ---- */

static double seen(const struct thing *thing, const double direction[3])
{
	const double cosine = direction[0] * thing->direction[0] +
			      direction[1] * thing->direction[1] +
			      direction[2] * thing->direction[2];
	const double away_rad = acos(fmin(cosine, 1)) / thing->radius_rad;
	const double turn = atan2(direction[1], direction[0]) - thing->azimuth_rad;
	const double height_rad = asin(direction[2]);

	if (thing->kind == WALL)
		return exp(-0.5 * away_rad * away_rad);
	if (thing->kind == LAMP)
		return away_rad < 1 ? 1 : thing->glow / (away_rad * away_rad);
	return fabs(remainder(turn, 2 * M_PI)) < thing->half_rad && height_rad > thing->low_rad &&
	       height_rad < thing->high_rad;
}

/* Paints everything but the lamps, or the lamps alone. Returns the radiance of a white ground under
 * it. */
static double paint(const struct random_place *place, const struct fisheye *lens, bool lamps,
		    float (*rgb)[3])
{
	double ground = 0;

	for (size_t i = 0; i < PIXELS; i++) {
		const double px[2] = {(double)(i % SIDE) + 0.5, (double)(i / SIDE) + 0.5};
		double direction[3], v[3] = {0};

		memset(rgb[i], 0, sizeof(rgb[i]));
		if (!fisheye_ray(lens, px, direction) || direction[2] < 0)
			continue;
		if (!lamps)
			tint(v, place->horizon + (place->zenith - place->horizon) * direction[2],
			     place->warmth);
		for (int k = lamps ? 0 : place->lamps; k < (lamps ? place->lamps : place->count);
		     k++)
			for (int c = 0; c < 3; c++)
				v[c] += place->thing[k].rgb[c] * seen(&place->thing[k], direction);
		for (int c = 0; c < 3; c++) {
			rgb[i][c] = (float)v[c];
			ground += v[c] / 3 * direction[2] * fisheye_pixel_sr(lens, px) / M_PI;
		}
	}
	return ground;
}

static void paint_place(const struct random_place *place, const struct fisheye *lens,
			float (*lamps)[3], float (*sky)[3])
{
	const double share = place->lamps_share * place->ground;
	const double rest = (place->ground - share) / paint(place, lens, false, sky);
	const double own = share > 0 ? share / paint(place, lens, true, lamps) : 0;

	for (size_t i = 0; i < PIXELS; i++)
		for (int c = 0; c < 3; c++)
			sky[i][c] = (float)(rest * (double)sky[i][c] +
					    (own > 0 ? own * (double)lamps[i][c] : 0));
}

/* ---- what is made of it ---- */

struct random_bench {
	const struct table *table;
	struct pipeline *pipeline;
	struct fisheye lens;
	struct exposures_truth truth;
	struct sensor *sensor;
	float (*sky)[3], (*lamps)[3];
	uint8_t *camera; /* [height][width], BGRX */
	struct canvas out;
};

static void exposures_random_prepare(struct random_bench *b, const struct table *t)
{
	const struct fisheye_settings ideal = {.field_deg = 90};
	struct fault fault = {.text = ""};
	struct pipeline_settings settings = {
		.sampler = {.gain = 1, .curve = {.named = TRANSFER_SRGB, .black = 16}},
		.lens = ideal,
		.background = {.named = TRANSFER_SRGB},
		.gain = 1,
		.patch = CARD_PATCH,
	};

	*b = (struct random_bench){.table = t};
	must(pipeline_create(&b->pipeline, &t->basis, &settings, &fault), &fault);
	must(fisheye_prepare(&b->lens, &ideal, SIDE, SIDE, &fault), &fault);
	truth_create(&b->truth, t, pipeline_dome(b->pipeline)->count);
	must(canvas_create(&b->out, t->scope.width, t->scope.height), &fault);
	b->sensor = room_for(1, sizeof(*b->sensor));
	sensor_prepare(b->sensor, &(struct sensor_settings){.exposure = 1,
							    .black_level = 16,
							    .read_noise = 0.4,
							    .shot_noise = 2,
							    .seed = SEED});
	b->sky = room_for(PIXELS, sizeof(*b->sky));
	b->lamps = room_for(PIXELS, sizeof(*b->lamps));
	b->camera = room_for(PIXELS, 4);
}

static void exposures_random_end(struct random_bench *b)
{
	pipeline_destroy(b->pipeline);
	free_truth(&b->truth);
	canvas_free(&b->out);
	free(b->sensor);
	free(b->sky);
	free(b->lamps);
	free(b->camera);
}

static void find_true_lights(struct random_bench *b)
{
	const struct image sky = {.width = SIDE, .height = SIDE, .f32 = &b->sky[0][0]};
	const struct view view = {.width = SIDE, .height = SIDE, .squash = 1};
	struct fault fault = {.text = ""};

	light_exposures_begin(b->pipeline->light.exposures);
	must(pipeline_light_linear(b->pipeline, &sky, &view, &fault), &fault);
	memcpy(b->truth.lights, pipeline_radiance(b->pipeline),
	       (size_t)pipeline_dome(b->pipeline)->count * sizeof(*b->truth.lights));
	irradiance_of(pipeline_dome(b->pipeline), (const float(*)[3])b->truth.lights,
		      b->truth.irradiance);
	truth_show(&b->truth, b->pipeline);
	light_exposures_begin(b->pipeline->light.exposures);
}

static double rms_of(struct random_bench *b)
{
	const struct picture card = whole(&b->truth.card);
	const struct backdrop backdrop = backdrop_of(&card);
	struct fault fault = {.text = ""};

	choose(b->pipeline);
	must(pipeline_composite(b->pipeline, &backdrop, b->out.pixels, b->out.stride, &fault),
	     &fault);
	return error_measure(&b->table->scope, b->truth.composite, &b->out, &card, TRANSFER_SRGB)
		.rms;
}

/* Judges one exposure, and one exposure with what the ground tells. */
static void judge_place(struct random_bench *b, int frame, double rms[2])
{
	const struct view view = {.width = SIDE, .height = SIDE, .squash = 1};
	const struct picture camera = view_picture(&view, b->camera, (size_t)SIDE * 4);
	struct fault fault = {.text = ""};

	find_true_lights(b);
	sensor_expose(b->sensor, (uint64_t)frame, &b->sky[0][0], PIXELS, b->camera);
	must(pipeline_light_picture(b->pipeline, &camera, &fault), &fault);
	rms[0] = rms_of(b);
	look_at_card(b->pipeline, &b->truth);
	rms[1] = rms_of(b);
}

/* ---- the table ---- */

struct random_figures {
	int places, rises;
	double sum[2], rise;
};

static void count_in(struct random_figures *f, const double rms[2])
{
	f->places++;
	f->rises += rms[1] > rms[0] + SAME;
	f->rise = fmax(f->rise, rms[1] - rms[0]);
	for (int k = 0; k < 2; k++)
		f->sum[k] += rms[k];
}

static void print_row(const char *name, const struct random_figures *f)
{
	const int n = f->places ? f->places : 1;

	printf("| %s | %d | %.2f | %.2f | %.1f | %.1f |\n", name, f->places, f->sum[0] / n,
	       f->sum[1] / n, 100.0 * f->rises / n, f->rise);
}

bool random_places(const struct table *t)
{
	static const char *const names[] = {"no lamp", "one lamp", "2 to 6 lamps", "all"};
	struct chance chance = {SEED * 2 + 1};
	struct random_figures f[4] = {{.places = 0}};
	struct random_bench b;

	exposures_random_prepare(&b, t);
	for (int k = 0; k < (t->quick ? PLACES_QUICK : PLACES); k++) {
		struct random_place place;
		double rms[2];

		draw_place(&chance, &place);
		paint_place(&place, &b.lens, b.lamps, b.sky);
		judge_place(&b, k, rms);
		count_in(&f[place.lamps < 2 ? place.lamps : 2], rms);
		count_in(&f[3], rms);
	}
	exposures_random_end(&b);
	puts("\n"
	     "| random places | how many | mean RMS: one exposure | one, recovered | worse for it, % | by at most |\n"
	     "|---|---|---|---|---|---|");
	for (int k = 0; k < 4; k++)
		print_row(names[k], &f[k]);
	return f[3].rises <= ALLOWED * f[3].places;
}
