/* SPDX-License-Identifier: MIT */
#include "app/bench/bench_look.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/frame/frame.h"
#include "hal/look/exposure.h"
#include "hal/look/flicker.h"
#include "hal/look/grain_tables.h"
#include "hal/look/neutral_light.h"
#include "hal/measure/lightings.h"
#include "hal/people/people.h"

#define LEARNING 100	  /* frames */
#define PERIOD 33333333	  /* ns */
#define LIGHT 0.3f	  /* of every cell */
#define VARIANCE 0.00004f /* of linear light: 2 levels of sRGB at mid-grey */

struct bench_look {
	struct grain_tables tables;
	struct grain grain;
	struct dome dome;
	float (*radiance)[3];
	double (*chosen)[3]; /* the same, as the compositor takes it */
	uint8_t *touched;
	struct tsai_camera camera;
	struct people *people; /* NULL: nobody is looked for */
	struct exposure *exposure;
	struct flicker *flicker;
	int64_t now_ns;
};

static int look_fill(struct bench_look *l, const struct basis *basis, struct fault *fault)
{
	const int tiles = basis->tiles_across * basis->tiles_down;
	const struct people_settings settings = {.width = (int)basis->info.width,
						 .height = (int)basis->info.height,
						 .curve = {.named = TRANSFER_SRGB},
						 .dome = &l->dome};
	struct people_object object = {.coverage = basis->poses[0].coverage};
	int err = lightings_dome(&l->dome, basis, fault);

	if (err)
		return err;
	l->radiance = calloc((size_t)l->dome.count, sizeof(*l->radiance));
	l->chosen = calloc((size_t)l->dome.count, sizeof(*l->chosen));
	l->touched = calloc((size_t)tiles, 1);
	if (!l->radiance || !l->chosen || !l->touched)
		return fault_say(fault, -ENOMEM, "not enough memory");
	for (int i = 0; i < l->dome.count; i++)
		for (int c = 0; c < 3; c++)
			l->chosen[i][c] = (double)(l->radiance[i][c] = LIGHT);
	for (int t = 0; t < tiles; t++)
		l->touched[t] = basis->poses[0].shown.tiles[t].block_count > 0;
	err = people_create(&l->people, &settings, fault);
	if (err)
		return err;
	if (exposure_create(&l->exposure, settings.width, settings.height, &settings.curve,
			    &l->dome) ||
	    flicker_create(&l->flicker, settings.width, settings.height, &settings.curve))
		return fault_say(fault, -ENOMEM, "not enough memory");
	if (!tsai_read_text(basis->camera, &l->camera, NULL))
		object.camera = &l->camera;
	object.touched = l->touched;
	object.foot = basis->feet;
	people_place(l->people, &object);
	return 0;
}

/* Learns the place, and then lets the visitors in. */
static void learn(struct bench_look *l, struct bench_frame *cameras,
		  const struct canvas *background)
{
	bench_frame_film(cameras, background, false);
	for (int n = 0; n < LEARNING; n++) {
		const struct picture picture = bench_frame_visited(cameras);

		bench_look_people(l, &picture);
		bench_look_exposure(l, &picture);
		bench_frame_next(cameras);
	}
	bench_frame_film(cameras, background, true);
}

int bench_look_create(struct bench_look **look, const struct basis *basis,
		      struct bench_frame *cameras, const struct canvas *background,
		      struct fault *fault)
{
	const struct sensor_noise_model noise = {
		.floor = {VARIANCE / 4, VARIANCE / 4, VARIANCE / 4},
		.slope = {VARIANCE * 3, VARIANCE * 3, VARIANCE * 3}};
	struct bench_look *l = calloc(1, sizeof(*l));
	int err;

	if (!l)
		return fault_say(fault, -ENOMEM, "not enough memory");
	grain_tables_fit(&l->tables, &noise, &l->grain);
	err = cameras ? look_fill(l, basis, fault) : 0;
	if (err) {
		bench_look_destroy(l);
		return err;
	}
	if (cameras)
		learn(l, cameras, background);
	*look = l;
	return 0;
}

void bench_look_destroy(struct bench_look *l)
{
	if (!l)
		return;
	people_destroy(l->people);
	exposure_destroy(l->exposure);
	flicker_destroy(l->flicker);
	dome_free(&l->dome);
	free(l->radiance);
	free(l->chosen);
	free(l->touched);
	free(l);
}

const struct grain *bench_look_grain(const struct bench_look *l)
{
	return &l->grain;
}

const struct veil *bench_look_people(struct bench_look *l, const struct picture *picture)
{
	people_look(l->people, picture, (const float(*)[3])l->radiance, l->now_ns);
	l->now_ns += PERIOD;
	return people_veil(l->people);
}

void bench_look_exposure(struct bench_look *l, const struct picture *picture)
{
	exposure_look(l->exposure, picture, (const float(*)[3])l->radiance);
}

void bench_look_flicker(struct bench_look *l, const struct picture *picture)
{
	static const float expected[3] = {1, 1, 1};

	flicker_look(l->flicker, picture, expected);
}

void bench_look_neutral(struct bench_look *l)
{
	neutral_light(l->chosen, l->dome.count, 0.2);
}
