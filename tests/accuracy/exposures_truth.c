/* SPDX-License-Identifier: MIT */
#include "tests/accuracy/exposures_truth.h"
#include "tests/support/studio_lights.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/truth/truth_views.h"
#include "drivers/sim/sim.h"

#define TRUE_SIDE 1024	 /* pixels a side of the fisheye that sees the true lights */
#define TRUE_SAMPLES 256 /* samples a pixel */

void die(const char *format, ...)
{
	va_list args;

	fputs("exposures: ", stderr);
	va_start(args, format);
	vfprintf(stderr, format, args);
	va_end(args);
	fputc('\n', stderr);
	exit(EXIT_FAILURE);
}

void must(int err, const struct fault *fault)
{
	if (err)
		die("%s", *fault->text ? fault->text : strerror(-err));
}

void *room_for(size_t count, size_t bytes)
{
	void *room = calloc(count, bytes);

	if (!room)
		die("not enough memory");
	return room;
}

static struct panorama panorama_of(const struct exposures_place *place,
				   const struct exposures_truth *truth)
{
	return (struct panorama){.image = &truth->panorama, .scale = place->exposure};
}

static void true_lights_of_panorama(const struct exposures_place *place,
				    struct exposures_truth *truth, const struct dome *dome)
{
	const struct light_sampler_settings settings = {.gain = 1};
	const struct fisheye_settings ideal = {.field_deg = 90};
	const struct panorama panorama = panorama_of(place, truth);
	struct fault fault = {.text = ""};
	struct light_sampler *sampler;
	struct image sky;
	struct sky whole;
	struct fisheye lens;

	must(truth_fisheye(&panorama, TRUE_SIDE, &sky), &fault);
	must(fisheye_prepare(&lens, &ideal, TRUE_SIDE, TRUE_SIDE, &fault), &fault);
	must(light_sampler_create(&sampler, dome, &lens, TRUE_SIDE, TRUE_SIDE, &settings, &fault),
	     &fault);
	must(light_sampler_read_linear(sampler, &sky, truth->lights), &fault);
	must(sky_create(&whole, &panorama, place->file, &fault), &fault);
	for (int c = 0; c < 3; c++)
		truth->irradiance[c] = M_PI * (double)whole.ground.c[c];
	sky_free(&whole);
	light_sampler_destroy(sampler);
	image_free(&sky);
}

void irradiance_of(const struct dome *dome, const float (*radiance)[3], double rgb[3])
{
	for (int c = 0; c < 3; c++) {
		rgb[c] = 0;
		for (int i = 0; i < dome->count; i++)
			rgb[c] += (double)radiance[i][c] * dome->projected_sr[i];
	}
}

static void true_lights_of_room(const struct exposures_place *place, struct exposures_truth *truth,
				const struct dome *dome)
{
	static const double origin[3] = {0, 0, 0};
	const struct studio_lamps lamps = studio_lamps((PICTURES - 1) / RATE_HZ, 0);
	double(*exact)[3] = room_for((size_t)dome->count, sizeof(*exact));

	if (studio_lights(dome, origin, &lamps, exact))
		die("not enough memory");
	for (int i = 0; i < dome->count; i++)
		for (int c = 0; c < 3; c++)
			truth->lights[i][c] = (float)(place->exposure * exact[i][c]);
	free(exact);
	irradiance_of(dome, (const float(*)[3])truth->lights, truth->irradiance);
}

static double card_radiance(const struct exposures_truth *truth, int c)
{
	return CARD / M_PI * truth->irradiance[c];
}

static void fill_card(struct exposures_truth *truth)
{
	for (int y = 0; y < truth->card.height; y++) {
		uint8_t *row = truth->card.pixels + (size_t)y * truth->card.stride;

		for (int x = 0; x < truth->card.width; x++, row += 4)
			for (int c = 0; c < 3; c++)
				row[2 - c] = (uint8_t)lrint(
					255 * transfer_encode(TRANSFER_SRGB,
							      fmin(card_radiance(truth, c), 1)));
	}
}

struct picture whole(const struct canvas *canvas)
{
	const struct view view = {.width = canvas->width, .height = canvas->height, .squash = 1};

	return view_picture(&view, canvas->pixels, canvas->stride);
}

/* Traces paths for the object on the card. */
static void trace(const struct table *t, const struct exposures_place *place,
		  struct exposures_truth *truth)
{
	const struct truth_settings settings = {.samples = TRUE_SAMPLES,
						.bounces = t->scene->file->render.bounces,
						.seed = 1,
						.quiet = true};
	const struct panorama panorama = panorama_of(place, truth);
	const size_t values = 3 * (size_t)truth->card.width * (size_t)truth->card.height;
	struct truth_report report = {.rays = 0};
	struct fault fault = {.text = ""};
	struct image background, out;
	struct sky sky;

	must(image_create_f32(&background, truth->card.width, truth->card.height), &fault);
	for (size_t i = 0; i < values; i++)
		background.f32[i] = (float)transfer_decode(TRANSFER_SRGB,
							   truth->card.pixels[2 - i % 3] / 255.0);
	must(sky_create(&sky, &panorama, place->file, &fault), &fault);
	must(truth_run(t->scene, &sky, &background, &settings, &out, &report, &fault), &fault);
	truth->traced = room_for(values, sizeof(double));
	for (size_t i = 0; i < values; i++)
		truth->traced[i] = 255 * transfer_encode(TRANSFER_SRGB, (double)out.f32[i]);
	sky_free(&sky);
	image_free(&out);
	image_free(&background);
}

void choose(struct pipeline *p)
{
	const struct pipeline_choice choice = {.object = true};
	struct fault fault = {.text = ""};

	must(pipeline_choose(p, &choice, &fault), &fault);
}

void truth_create(struct exposures_truth *truth, const struct table *t, int lights)
{
	*truth = (struct exposures_truth){.traced = NULL};
	truth->lights = room_for((size_t)lights, sizeof(*truth->lights));
	truth->composite = room_for((size_t)t->scope.width * (size_t)t->scope.height,
				    3 * sizeof(double));
	if (canvas_create(&truth->card, t->scope.width, t->scope.height))
		die("not enough memory");
}

void truth_show(struct exposures_truth *truth, struct pipeline *p)
{
	struct fault fault = {.text = ""};
	struct picture card;

	fill_card(truth);
	card = whole(&truth->card);
	pipeline_light_given(p, (const float(*)[3])truth->lights);
	choose(p);
	must(pipeline_reference(p, &card, truth->composite, &fault), &fault);
}

void look_at_card(struct pipeline *pipeline, const struct exposures_truth *truth)
{
	const size_t pixels = (size_t)truth->card.width * (size_t)truth->card.height;
	float *linear = room_for(3 * pixels, sizeof(*linear));
	struct sensor *sensor = room_for(1, sizeof(*sensor));
	struct frame_reader reader;
	struct picture picture;
	struct canvas seen;
	struct view view;

	for (size_t i = 0; i < 3 * pixels; i++)
		linear[i] = (float)card_radiance(truth, (int)(i % 3));
	if (canvas_create(&seen, truth->card.width, truth->card.height))
		die("not enough memory");
	sensor_prepare(sensor,
		       &(struct sensor_settings){
			       .exposure = 1, .read_noise = 0.4, .shot_noise = 2, .seed = 7});
	view = (struct view){.width = seen.width, .height = seen.height, .squash = 1};
	sensor_expose(sensor, 0, linear, pixels, seen.pixels);
	picture = view_picture(&view, seen.pixels, 4 * (size_t)seen.width);
	reader = frame_reader_of(&picture);
	pipeline_recover(pipeline, &reader);
	canvas_free(&seen);
	free(sensor);
	free(linear);
}

void find_truth(const struct table *t, const struct exposures_place *place,
		struct exposures_truth *truth)
{
	const struct pipeline_settings settings = {.sampler = {.gain = 1},
						   .lens = {.field_deg = 90},
						   .background = {.named = TRANSFER_SRGB},
						   .gain = 1};
	struct fault fault = {.text = ""};
	struct pipeline *p;
	char path[INI_PATH_MAX];

	must(pipeline_create(&p, &t->basis, &settings, &fault), &fault);
	truth_create(truth, t, pipeline_dome(p)->count);
	if (place->file) {
		snprintf(path, sizeof(path), "%s/%s", t->folder, place->file);
		must(image_read(path, &truth->panorama, &fault), &fault);
		true_lights_of_panorama(place, truth, pipeline_dome(p));
	} else {
		true_lights_of_room(place, truth, pipeline_dome(p));
	}
	truth_show(truth, p);
	if (place->file && !t->quick)
		trace(t, place, truth);
	pipeline_destroy(p);
}

void free_truth(struct exposures_truth *truth)
{
	free(truth->lights);
	free(truth->composite);
	free(truth->traced);
	canvas_free(&truth->card);
	image_free(&truth->panorama);
}
