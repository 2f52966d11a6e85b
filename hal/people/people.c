/* SPDX-License-Identifier: MIT */
#include "hal/people/people.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/people/people_parts.h"

#define FINE_CELLS 40000  /* cells of 2x2 pixels up to that many, else of 4x4 */
#define AROUND 2	  /* tiles around those that the object touches */
#define PEOPLE_SIDE_MIN 8 /* pixels; the sensor's noise is measured in blocks of that side */
#define STEP_MS_MAX 500.0
#define PLANE_BEYOND 16
/* Until the noise is measured: 2 levels at mid-grey. */
#define STILL_FIRST 40000.0f
#define SHOT_FIRST 3.0f

/* Cells that may be read, and a row and a bit beyond their ends, too. */
static int create_cells(const struct people *p, int cells, float **plane)
{
	const size_t beyond = (size_t)p->across + PLANE_BEYOND;

	*plane = calloc((size_t)cells + 2 * beyond, sizeof(**plane));
	if (!*plane)
		return -ENOMEM;
	*plane += beyond;
	return 0;
}

static int create_plane(const struct people *p, float **plane)
{
	return create_cells(p, p->cells, plane);
}

static void free_plane(const struct people *p, float *plane)
{
	if (plane)
		free(plane - p->across - PLANE_BEYOND);
}

static int create_planes(struct people *p)
{
	int err = 0;

	for (int c = 0; c < 3; c++) {
		err |= create_plane(p, &p->seen[c]) | create_plane(p, &p->place[c]) |
		       create_plane(p, &p->lit[c]) | create_plane(p, &p->drift[c]);
		for (int k = 0; k < PLACE_TERMS; k++)
			err |= create_plane(p, &p->coefficient[c][k]);
		for (int n = 0; n < 3; n++)
			err |= create_plane(p, &p->product[c][n]) |
			       create_cells(p, p->across, &p->column[c][n]);
	}
	return err;
}

static int create_lists(struct people *p)
{
	const size_t cells = (size_t)p->cells, tiles = (size_t)(p->tiles_across * p->tiles_down);
	const size_t pixels = (size_t)p->settings.width * (size_t)p->settings.height;
	/* Cells above and below may be asked for, too. */
	const size_t beyond = (size_t)p->across + 1;

	p->watch = calloc(cells + 2 * beyond, 1);
	if (p->watch)
		p->watch += beyond;
	p->known = calloc(cells, 1);
	p->unknown = calloc((size_t)p->down, sizeof(*p->unknown));
	p->verdict = calloc(cells, 1);
	p->raw = calloc(cells, 1);
	p->before = calloc(cells, 1);
	p->side_of = calloc(cells, 1);
	p->last_differs = calloc((size_t)p->down, sizeof(*p->last_differs));
	p->count = calloc((size_t)p->across + 2 * PLANE_BEYOND, 1);
	if (p->count)
		p->count += PLANE_BEYOND;
	p->order = calloc(cells, 1);
	p->order_before = calloc(cells, 1);
	p->stable_ms = calloc(cells, sizeof(*p->stable_ms));
	p->label = calloc(cells, sizeof(*p->label));
	p->runs = calloc(cells, sizeof(*p->runs));
	p->groups = calloc(cells, sizeof(*p->groups));
	p->spans = calloc(cells, sizeof(*p->spans));
	p->row_span = calloc((size_t)p->down + 1, sizeof(*p->row_span));
	p->object_far = calloc((size_t)p->across, sizeof(float));
	p->tile = calloc(tiles, 1);
	p->front = calloc(pixels, 1);
	p->anybody = calloc(pixels, 1);
	p->foremost = calloc(pixels, 4);
	return p->watch && p->known && p->unknown && p->verdict && p->raw && p->before &&
			       p->side_of && p->last_differs && p->count && p->order &&
			       p->order_before && p->stable_ms && p->label && p->runs &&
			       p->groups && p->spans && p->row_span && p->object_far && p->tile &&
			       p->front && p->anybody && p->foremost
		       ? 0
		       : -ENOMEM;
}

int people_create(struct people **people, const struct people_settings *settings,
		  struct fault *fault)
{
	struct people *p = calloc(1, sizeof(*p));
	const int fine = (settings->width + 1) / 2 * ((settings->height + 1) / 2);

	if (!p)
		return fault_say(fault, -ENOMEM, "not enough memory to look for people");
	if (settings->width < PEOPLE_SIDE_MIN || settings->height < PEOPLE_SIDE_MIN) {
		free(p);
		return fault_say(
			fault, -EINVAL,
			"people cannot be looked for in %dx%d pixels, expected at least %dx%d",
			settings->width, settings->height, PEOPLE_SIDE_MIN, PEOPLE_SIDE_MIN);
	}
	p->settings = *settings;
	p->settings.camera = p->settings.calibration = NULL;
	p->settings.depth_camera = NULL;
	p->camera = saved_camera(settings);
	p->side = fine <= FINE_CELLS ? 2 : 4;
	p->across = (settings->width + p->side - 1) / p->side;
	p->down = (settings->height + p->side - 1) / p->side;
	p->cells = p->across * p->down;
	p->tiles_across = (settings->width + BASIS_TILE - 1) / BASIS_TILE;
	p->tiles_down = (settings->height + BASIS_TILE - 1) / BASIS_TILE;
	transfer_tables_fill(&p->tables, &settings->curve);
	for (int n = 0; n <= 255 * CODE_STEPS; n++)
		p->linear[n] = (float)transfer_curve_decode(&settings->curve,
							    n / (255.0 * CODE_STEPS)) *
			       WHITE;
	for (int c = 0; c < 3; c++) {
		p->still[c] = STILL_FIRST;
		p->shot[c] = SHOT_FIRST;
	}
	if (create_planes(p) || create_lists(p) || place_create(p) ||
	    depths_create(p, settings->depth_camera) ||
	    sensor_noise_create(&p->sensor, settings->width, settings->height, &settings->curve)) {
		people_destroy(p);
		return fault_say(fault, -ENOMEM,
				 "not enough memory to look for people in %dx%d pixels",
				 settings->width, settings->height);
	}
	p->veil = (struct veil){p->tile, p->front, p->anybody, p->foremost};
	place_forget(p);
	*people = p;
	return 0;
}

void people_destroy(struct people *p)
{
	if (!p)
		return;
	for (int c = 0; c < 3; c++) {
		free_plane(p, p->seen[c]);
		free_plane(p, p->place[c]);
		free_plane(p, p->lit[c]);
		free_plane(p, p->drift[c]);
		for (int k = 0; k < PLACE_TERMS; k++)
			free_plane(p, p->coefficient[c][k]);
		for (int n = 0; n < 3; n++) {
			free_plane(p, p->product[c][n]);
			free_plane(p, p->column[c][n]);
		}
	}
	sensor_noise_destroy(p->sensor);
	depths_free(p);
	free(p->term);
	free(p->ratios);
	if (p->watch)
		free(p->watch - p->across - 1);
	free(p->unknown);
	free(p->last_differs);
	if (p->count)
		free(p->count - PLANE_BEYOND);
	free(p->known);
	free(p->verdict);
	free(p->raw);
	free(p->before);
	free(p->side_of);
	free(p->order);
	free(p->order_before);
	free(p->stable_ms);
	free(p->label);
	free(p->runs);
	free(p->groups);
	free(p->spans);
	free(p->row_span);
	free(p->object_far);
	free(p->tile);
	free(p->front);
	free(p->anybody);
	free(p->foremost);
	free(p);
}

static bool is_near(const struct people *p, const uint8_t *touched, int tx, int ty)
{
	for (int y = ty - AROUND; y <= ty + AROUND; y++)
		for (int x = tx - AROUND; x <= tx + AROUND; x++)
			if (y >= 0 && x >= 0 && y < p->tiles_down && x < p->tiles_across &&
			    touched[y * p->tiles_across + x])
				return true;
	return false;
}

/* Marks the cells of tiles that are near the object's. */
static void watch_tiles(struct people *p)
{
	const int per_tile = BASIS_TILE / p->side;

	for (int y = 0; y < p->down; y++)
		for (int x = 0; x < p->across; x++) {
			const int at = y * p->across + x;

			/* Asked once a tile; the row above in the same tile knows, too. */
			if (x % per_tile)
				p->watch[at] = p->watch[at - 1];
			else if (y % per_tile)
				p->watch[at] = p->watch[at - p->across];
			else
				p->watch[at] = is_near(p, p->object.touched, x / per_tile,
						       y / per_tile);
		}
}

/* Leaves out the cells whose first pixel cannot show a person. */
static void leave_out_masked(struct people *p)
{
	const size_t side = (size_t)p->side, width = (size_t)p->settings.width;

	for (int y = 0; p->object.shown && y < p->down; y++) {
		const uint8_t *shown = p->object.shown + (size_t)y * side * width;

		for (int x = 0; x < p->across; x++)
			p->watch[y * p->across + x] &= shown[(size_t)x * side];
	}
}

void people_place(struct people *p, const struct people_object *object)
{
	p->object = *object;
	watch_tiles(p);
	leave_out_masked(p);
	p->span_count = p->watched = 0;
	for (int y = 0; y < p->down; y++) {
		bool open = false;

		p->row_span[y] = p->span_count;
		for (int x = 0; x < p->across; x++) {
			const bool watched = p->watch[y * p->across + x];

			if (watched && !open)
				p->spans[p->span_count++] = (struct span){y, x, 0};
			open = watched;
			if (open)
				p->spans[p->span_count - 1].count++;
			else
				p->order[y * p->across + x] = 0;
			p->watched += open;
		}
	}
	p->row_span[p->down] = p->span_count;
	place_count_unknown(p);
	memset(p->light_then, 0, sizeof(p->light_then)); /* nothing is predicted of new cells */
	order_measure_object(p);
}

void people_take_depth(struct people *p, const struct depth_map *depth)
{
	p->depth = depth;
}

static void report_learned(struct people *p)
{
	int unknown = 0;

	for (int y = 0; y < p->down; y++)
		unknown += p->unknown[y];
	p->report.learned = p->watched ? 1 - (double)unknown / p->watched : 1;
	for (int c = 0; c < 3; c++)
		p->report.gain[c] = (double)p->gain[c];
}

static void look_at_frame(struct people *p, const struct picture *background,
			  const float (*radiance)[3], int64_t captured_ns)
{
	const double step_ms = (double)(captured_ns - p->captured_ns) / NS_PER_MS;

	p->step_ms = step_ms > 0 && step_ms < STEP_MS_MAX ? step_ms : step_ms > 0 ? STEP_MS_MAX : 0;
	p->captured_ns = captured_ns;
	p->visited = false;
	p->report.parts = p->report.in_front = 0;
	if (!place_light(p, radiance))
		return;
	cells_read(p, background);
	place_predict(p);
	cells_follow_gain(p);
	judge_cells(p);
	groups_find(p);
	outline_draw(p, background);
	/* A frame that is looked at again, as another pose has come, teaches nothing twice. */
	if (p->step_ms > 0) {
		cells_follow_noise(p, background);
		place_learn(p);
		p->frame++;
	}
	report_learned(p);
}

void people_look(struct people *p, const struct picture *background, const float (*radiance)[3],
		 int64_t captured_ns)
{
	look_at_frame(p, background, radiance, captured_ns);
	p->depth = NULL;
}

const struct veil *people_veil(const struct people *p)
{
	return p->visited ? &p->veil : NULL;
}

void people_learn(struct people *p)
{
	p->learn_now = true;
}

void people_forget(struct people *p)
{
	place_forget(p);
	p->report.learned = 0;
}

const struct sensor_noise *people_noise(const struct people *p)
{
	return p->sensor;
}

struct people_report people_report(const struct people *p)
{
	return p->report;
}
