/* SPDX-License-Identifier: MIT */
/*
 * Renders a room's frames into a file: recording.h.
 *     render NUMBER                      prints the scene file of the room's object
 *     render NUMBER BASIS.inlay FILE     renders; FILE.png shows some frames
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/image/image.h"
#include "tests/people/recording.h"
#include "tests/people/rooms.h"
#include "tests/people/subtractors.h"

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

struct render {
	struct room room;
	struct basis basis;
	struct dome dome;
	struct tsai_camera camera;
	struct filmed filmed;
	struct subtractors *others;
	struct recording recording;
	float *object_m; /* [h][w]: along the ray to the object; INFINITY: not there */
	uint8_t *mask[SUBTRACTORS];
	double exposure;
	struct image sheet;
};

enum { SHEET_ACROSS = 4, SHEET_DOWN = 3 };

static void die(const char *what)
{
	fprintf(stderr, "render: %s\n", what);
	exit(1);
}

static void *make_room(size_t bytes)
{
	void *p = calloc(bytes, 1);

	if (!p)
		die("not enough memory");
	return p;
}

/* Marks the tiles in which object and shadow change a pixel under an even sky by a level. */
static void mark_touched(struct render *r)
{
	const struct compositor_settings settings = {
		.background = srgb, .output = srgb, .gain = 1, .object = true};
	const int width = r->camera.width, pixels = width * r->camera.height;
	struct compositor *compositor;
	struct light_selection lights;
	float(*even)[3] = make_room((size_t)r->dome.count * sizeof(*even));
	uint8_t *grey = make_room((size_t)pixels * 4), *out = make_room((size_t)pixels * 4);
	const struct picture picture = {.origin = grey,
					.x_step = 4,
					.y_step = (ptrdiff_t)width * 4,
					width,
					r->camera.height};
	const struct backdrop backdrop = backdrop_of(&picture);
	struct fault fault = {{0}};

	memset(grey, 188, (size_t)pixels * 4);
	for (int i = 0; i < r->dome.count; i++)
		even[i][0] = even[i][1] = even[i][2] = (float)M_1_PI;
	if (compositor_create(&compositor, &r->basis, &(struct compositor_options){0}, &fault) ||
	    compositor_take_pose(compositor, 0, &fault))
		die(fault.text);
	if (light_selection_create(&lights, &r->basis))
		die("not enough memory");
	light_selection_choose(&lights, &r->basis, 0, (const float(*)[3])even, 0, THRESHOLD_DROP,
			       1);
	compositor_set(compositor, &settings);
	if (compositor_run(compositor, 0, &lights, &backdrop, out, (size_t)width * 4))
		die("cannot composite");
	for (int k = 0; k < pixels; k++)
		if (memcmp(out + 4 * k, grey + 4 * k, 3) != 0)
			r->recording.touched[k / width / BASIS_TILE * r->basis.tiles_across +
					     k % width / BASIS_TILE] = 1;
	light_selection_free(&lights);
	compositor_destroy(compositor);
	free(even);
	free(grey);
	free(out);
}

/* Distance to the box of room_print_scene() along a unit vector; INFINITY: it passes by. */
static double box_distance(const struct room *room, const double origin[3], const double dir[3])
{
	const double turn = room->box_turn_deg * M_PI / 180, half = room->box_m / 2;
	const double axis[3][3] = {
		{cos(turn), sin(turn), 0}, {-sin(turn), cos(turn), 0}, {0, 0, 1}};
	double enter = 0, leave = INFINITY;

	for (int i = 0; i < 3; i++) {
		double from = 0, way = 0;

		for (int c = 0; c < 3; c++) {
			from += axis[i][c] * origin[c];
			way += axis[i][c] * dir[c];
		}
		from -= i == 2 ? half : 0;
		enter = fmax(enter, fmin((-half - from) / way, (half - from) / way));
		leave = fmin(leave, fmax((-half - from) / way, (half - from) / way));
	}
	return enter < leave ? enter : INFINITY;
}

static void measure_object(struct render *r)
{
	const struct sim_eye eye = {
		.width = r->camera.width, .height = r->camera.height, .camera = r->camera};

	r->object_m = make_room((size_t)eye.width * (size_t)eye.height * sizeof(float));
	for (int k = 0; k < eye.width * eye.height; k++) {
		const double px[2] = {k % eye.width + 0.5, k / eye.width + 0.5};
		double origin[3], dir[3];

		r->object_m[k] = eye_ray(&eye, px, origin, dir)
					 ? (float)box_distance(&r->room, origin, dir)
					 : INFINITY;
	}
}

/* The exposure that gives the empty room its level. */
static void settle_exposure(struct render *r)
{
	const int values = 3 * r->camera.width * r->camera.height;
	struct filmed_moment moment;
	struct studio_lamps lamps;
	double sum = 0;

	room_moment(&r->room, 0, 1, &lamps, &moment);
	moment.walkers = 0;
	if (filmed_take(&r->filmed, &moment))
		die("not enough memory");
	for (int i = 0; i < values; i++)
		sum += fmin(r->filmed.ground[i], 8);
	r->exposure = r->room.level * values / sum;
}

static void render_open(struct render *r, const char *path)
{
	struct fault fault = {{0}};

	if (basis_open(&r->basis, path, BASIS_SHOWN, &fault) ||
	    tsai_read_text(r->basis.camera, &r->camera, &fault) ||
	    dome_create(&r->dome, (int)r->basis.info.dome_frequency, &fault))
		die(fault.text);
	r->recording.head = (struct recording_head){
		.room = r->room.number,
		.width = r->camera.width,
		.height = r->camera.height,
		.lights = r->dome.count,
		.tiles = r->basis.tiles_across * r->basis.tiles_down,
	};
	r->others = subtractors_create(r->camera.width, r->camera.height);
	if (filmed_open(&r->filmed, &r->camera, &r->dome) || !r->others ||
	    !recording_make_room(&r->recording))
		die("not enough memory");
	filmed_set_noise(&r->filmed, r->room.read_noise, r->room.shot_noise, r->room.number);
	filmed_paint(&r->filmed, room_paint, &r->room);
	for (int m = 0; m < SUBTRACTORS; m++)
		r->mask[m] = make_room((size_t)r->camera.width * (size_t)r->camera.height);
	r->sheet.width = SHEET_ACROSS * r->camera.width;
	r->sheet.height = SHEET_DOWN * r->camera.height;
	r->sheet.u8 = make_room((size_t)r->sheet.width * (size_t)r->sheet.height * 3);
	mark_touched(r);
	measure_object(r);
	settle_exposure(r);
}

static void render_close(struct render *r)
{
	image_free(&r->sheet);
	for (int m = 0; m < SUBTRACTORS; m++)
		free(r->mask[m]);
	free(r->object_m);
	subtractors_destroy(r->others);
	filmed_close(&r->filmed);
	dome_free(&r->dome);
	basis_close(&r->basis);
}

static void take_truth(struct render *r)
{
	struct recording *to = &r->recording;

	for (int i = 0; i < to->head.looked; i++) {
		const int k = to->looked[i];
		const struct studio_layer *layer = &r->filmed.people[k];

		to->alpha[i] = (uint8_t)lrintf(255 * layer->alpha);
		to->who[i] = (uint8_t)(layer->walker + 1);
		if (layer->walker >= 0 && layer->depth < r->object_m[k])
			to->who[i] |= TRUTH_BEFORE;
		to->others[i] = 0;
		for (int m = 0; m < SUBTRACTORS; m++)
			to->others[i] |= (uint8_t)((r->mask[m][k] == 255) << m);
	}
}

/* Numbers walkers in the order of the room, whoever is there. */
static void number_walkers(const struct room *room, const struct filmed_moment *moment,
			   struct studio_layer *layer, int pixels)
{
	int number[WALKER_STYLES];

	for (int i = 0; i < moment->walkers; i++)
		for (int w = 0; w < room->walkers; w++)
			if (moment->walker[i].cloth == room->walker[w].cloth)
				number[i] = w;
	for (int k = 0; k < pixels; k++)
		if (layer[k].walker >= 0)
			layer[k].walker = number[layer[k].walker];
}

static bool lamps_differ(const struct studio_lamps *a, const struct studio_lamps *b)
{
	return a->panels != b->panels || a->lantern[0].radiance[0] != b->lantern[0].radiance[0] ||
	       a->lantern[1].radiance[0] != b->lantern[1].radiance[0];
}

/* Half of the sheet shows people who are judged, the rest how they leave. */
static void keep_on_sheet(struct render *r, int frame)
{
	const int every = (ROOM_FRAMES - LEARNING) / (SHEET_ACROSS * SHEET_DOWN);
	const int cell = (frame - LEARNING) / every, w = r->camera.width;
	uint8_t *to = r->sheet.u8;

	if (frame < LEARNING || (frame - LEARNING) % every || cell >= SHEET_ACROSS * SHEET_DOWN)
		return;
	to += 3 * ((size_t)(cell / SHEET_ACROSS * r->camera.height) * (size_t)r->sheet.width +
		   (size_t)(cell % SHEET_ACROSS * w));
	for (int k = 0; k < w * r->camera.height; k++)
		for (int c = 0; c < 3; c++)
			to[3 * (k / w * r->sheet.width + k % w) + c] =
				r->filmed.bgrx[4 * k + 2 - c] / (isinf(r->object_m[k]) ? 1 : 2);
}

static void render_frame(struct render *r, int frame)
{
	const int pixels = r->camera.width * r->camera.height;
	const struct studio_lamps then = room_lamps(&r->room,
						    room_time_s(frame > 0 ? frame - 1 : 0));
	struct recording *to = &r->recording;
	struct filmed_moment moment;
	struct studio_lamps lamps;

	room_moment(&r->room, frame, r->exposure, &lamps, &moment);
	if (filmed_take(&r->filmed, &moment))
		die("not enough memory");
	subtractors_look(r->others, r->filmed.bgrx, r->mask);
	number_walkers(&r->room, &moment, r->filmed.people, pixels);
	to->moment = (struct recording_moment){
		.captured_ns = llrint(moment.time_s * 1e9),
		.walkers = moment.walkers,
		.switched = lamps_differ(&then, &lamps),
		.exposure = (float)(moment.exposure[1] / r->exposure),
	};
	memcpy(to->light, r->filmed.light, (size_t)r->dome.count * sizeof(*to->light));
	for (int k = 0; k < pixels; k++)
		memcpy(to->bgr + 3 * k, r->filmed.bgrx + 4 * k, 3);
	take_truth(r);
	keep_on_sheet(r, frame);
	if (!recording_write(to, frame))
		die("cannot write");
}

int main(int argc, char **argv)
{
	struct render render = {0};
	struct fault fault = {{0}};
	char part[512], sheet[512];

	if ((argc != 2 && argc != 4) || atoi(argv[1]) < 0 || atoi(argv[1]) >= ROOMS)
		die("expected NUMBER [BASIS.inlay FILE]");
	room_draw(atoi(argv[1]), &render.room);
	if (argc == 2) {
		room_print_scene(&render.room, stdout);
		return 0;
	}
	snprintf(part, sizeof(part), "%s.part", argv[3]);
	snprintf(sheet, sizeof(sheet), "%s.png", argv[3]);
	render_open(&render, argv[2]);
	if (!recording_write_head(&render.recording, part))
		die("cannot write");
	for (int frame = 0; frame < ROOM_FRAMES; frame++)
		render_frame(&render, frame);
	if (!recording_close(&render.recording) || rename(part, argv[3]))
		die("cannot write");
	if (image_write(sheet, &render.sheet, &fault))
		die(fault.text);
	render_close(&render);
	return 0;
}
