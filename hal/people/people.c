/* SPDX-License-Identifier: MIT */
#include "hal/people/people.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/people/people_parts.h"

#define CELLS_MOST 40000  /* of 2x2 pixels up to that many, else of twice the side, and so on */
#define AROUND 2	  /* tiles around those that the object touches */
#define PEOPLE_SIDE_MIN 8 /* pixels; the sensor's noise is measured in blocks of that side */
#define STEP_MS_MAX 500.0
#define PLANE_BEYOND 16
/* Until the noise is measured: 2 levels at mid-grey. */
#define STILL_FIRST 40000.0f
#define SHOT_FIRST 3.0f

/* ---- memory: one block, which is measured first and then divided ---- */

struct block {
	uint8_t *begin; /* NULL: it is being measured */
	size_t used;
};

static void *take(struct block *block, size_t bytes)
{
	void *at = block->begin ? block->begin + block->used : NULL;

	block->used += (bytes + 63) & ~(size_t)63;
	return at;
}

/* A plane whose cells may be read a row and a bit beyond both ends, too. */
static float *take_plane(struct block *block, const struct cells *cells)
{
	const size_t beyond = (size_t)cells->across + PLANE_BEYOND;
	float *plane = take(block, ((size_t)cells->count + 2 * beyond) * sizeof(*plane));

	return plane ? plane + beyond : NULL;
}

static void divide_planes(struct people *p, struct block *block)
{
	const struct cells *cells = &p->cells;

	for (int c = 0; c < 3; c++) {
		p->cells.seen[c] = take_plane(block, cells);
		p->cells.recent[c] = take_plane(block, cells);
		p->place.expected[c] = take_plane(block, cells);
		p->place.lit[c] = take_plane(block, cells);
		p->place.drift[c] = take_plane(block, cells);
		p->verdict.weight[c] = take_plane(block, cells);
		for (int k = 0; k < PLACE_TERMS; k++)
			p->place.coefficient[c][k] = take_plane(block, cells);
	}
	p->place.spread = take_plane(block, cells);
	p->verdict.bright = take_plane(block, cells);
	p->verdict.ratio = take_plane(block, cells);
	p->verdict.lit = take_plane(block, cells);
	p->verdict.chi = take_plane(block, cells);
	p->verdict.evidence = take_plane(block, cells);
	p->verdict.last = take_plane(block, cells);
	p->verdict.opinion = take_plane(block, cells);
	p->verdict.revised = take_plane(block, cells);
}

static void divide(struct people *p, struct block *block)
{
	const size_t cells = (size_t)p->cells.count, down = (size_t)p->cells.down;
	const size_t tiles = (size_t)(p->tiles_across * p->tiles_down);
	const size_t ratios = (size_t)((p->tiles_across + 1) * (p->tiles_down + 1));
	const size_t pixels = (size_t)p->settings.width * (size_t)p->settings.height;
	const size_t beyond = (size_t)p->cells.across + 1;
	struct crowd *crowd = &p->crowd;
	struct outline *outline = &p->outline;

	divide_planes(p, block);
	p->cells.spans = take(block, cells * sizeof(*p->cells.spans));
	p->cells.row_span = take(block, (down + 1) * sizeof(*p->cells.row_span));
	p->cells.watch = take(block, cells + 2 * beyond);
	if (p->cells.watch)
		p->cells.watch += beyond;
	p->cells.still_ms = take(block, cells * sizeof(*p->cells.still_ms));
	p->place.term = take(block, (size_t)p->settings.dome->count * sizeof(*p->place.term));
	p->place.lessons = take(block, (size_t)p->cells.across * sizeof(float));
	p->place.left = take(block, (size_t)p->settings.dome->count);
	p->place.known = take(block, cells);
	p->place.ratios = take(block, ratios * sizeof(*p->place.ratios));
	p->nudge.patch = take(block, NUDGE_PATCHES * sizeof(*p->nudge.patch));
	p->verdict.of = take(block, cells);
	p->verdict.copy = take(block, cells);
	crowd->runs = take(block, cells * sizeof(*crowd->runs));
	crowd->label = take(block, cells * sizeof(*crowd->label));
	crowd->groups = take(block, cells * sizeof(*crowd->groups));
	crowd->order = take(block, cells);
	crowd->covered = take(block, cells);
	crowd->far_side.column = take(block, (size_t)p->cells.across * sizeof(float));
	outline->side_of = take(block, cells);
	outline->tile = take(block, tiles);
	outline->front = take(block, pixels);
	outline->anybody = take(block, pixels);
	outline->foremost = take(block, 4 * pixels);
}

static int create_memory(struct people *p)
{
	struct block block = {NULL, 0};

	divide(p, &block);
	p->memory = calloc(block.used, 1);
	block = (struct block){p->memory, 0};
	if (!p->memory)
		return -ENOMEM;
	divide(p, &block);
	return 0;
}

int people_create(struct people **people, const struct people_settings *settings,
		  struct fault *fault)
{
	struct people *p;

	if (settings->width < PEOPLE_SIDE_MIN || settings->height < PEOPLE_SIDE_MIN)
		return fault_say(
			fault, -EINVAL,
			"people cannot be looked for in %dx%d pixels, expected at least %dx%d",
			settings->width, settings->height, PEOPLE_SIDE_MIN, PEOPLE_SIDE_MIN);
	p = calloc(1, sizeof(*p));
	if (!p)
		return fault_say(fault, -ENOMEM, "not enough memory to look for people");
	p->settings = *settings;
	p->settings.camera = p->settings.calibration = NULL;
	p->settings.depth_camera = NULL;
	p->camera = saved_camera(settings);
	for (int side = 2; side <= BASIS_TILE && (side == 2 || p->cells.count > CELLS_MOST);
	     side *= 2) {
		p->cells.side = side;
		p->cells.across = (settings->width + side - 1) / side;
		p->cells.down = (settings->height + side - 1) / side;
		p->cells.count = p->cells.across * p->cells.down;
	}
	p->tiles_across = (settings->width + BASIS_TILE - 1) / BASIS_TILE;
	p->tiles_down = (settings->height + BASIS_TILE - 1) / BASIS_TILE;
	transfer_tables_fill(&p->tables, &settings->curve);
	for (int n = 0; n <= 255 * CODE_STEPS; n++)
		p->cells.linear[n] = (float)transfer_curve_decode(&settings->curve,
								  n / (255.0 * CODE_STEPS)) *
				     WHITE;
	for (int c = 0; c < 3; c++) {
		p->cells.still[c] = STILL_FIRST;
		p->cells.shot[c] = SHOT_FIRST;
	}
	if (create_memory(p) || depths_create(p, settings->depth_camera) ||
	    sensor_noise_create(&p->cells.sensor, settings->width, settings->height,
				&settings->curve)) {
		people_destroy(p);
		return fault_say(fault, -ENOMEM,
				 "not enough memory to look for people in %dx%d pixels",
				 settings->width, settings->height);
	}
	p->outline.veil = (struct veil){p->outline.tile, p->outline.front, p->outline.anybody,
					p->outline.foremost};
	place_create(p);
	place_forget(p);
	*people = p;
	return 0;
}

void people_destroy(struct people *p)
{
	if (!p)
		return;
	sensor_noise_destroy(p->cells.sensor);
	depths_free(p);
	free(p->memory);
	free(p);
}

/* ---- what is watched ---- */

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
	const int per_tile = BASIS_TILE / p->cells.side, across = p->cells.across;
	uint8_t *watch = p->cells.watch;

	for (int y = 0; y < p->cells.down; y++)
		for (int x = 0; x < across; x++) {
			const int at = y * across + x;

			/* Asked once a tile; the row above in the same tile knows, too. */
			if (x % per_tile)
				watch[at] = watch[at - 1];
			else if (y % per_tile)
				watch[at] = watch[at - across];
			else
				watch[at] = is_near(p, p->object.touched, x / per_tile,
						    y / per_tile);
		}
}

/* Leaves out the cells whose first pixel cannot show a person, and finds those that the object
 * covers. */
static void ask_pixels(struct people *p)
{
	const size_t side = (size_t)p->cells.side, width = (size_t)p->settings.width;

	for (int y = 0; y < p->cells.down; y++)
		for (int x = 0; x < p->cells.across; x++) {
			const size_t pixel = (size_t)y * side * width + (size_t)x * side;
			const int at = y * p->cells.across + x;

			if (p->object.shown)
				p->cells.watch[at] &= p->object.shown[pixel];
			p->crowd.covered[at] = p->object.coverage[pixel] > 32767;
		}
}

static void list_spans(struct people *p)
{
	struct cells *cells = &p->cells;

	cells->span_count = cells->watched = 0;
	for (int y = 0; y < cells->down; y++) {
		bool open = false;

		cells->row_span[y] = cells->span_count;
		for (int x = 0; x < cells->across; x++) {
			const bool watched = cells->watch[y * cells->across + x];

			if (watched && !open)
				cells->spans[cells->span_count++] = (struct span){y, x, 0};
			open = watched;
			if (open)
				cells->spans[cells->span_count - 1].count++;
			else
				p->crowd.order[y * cells->across + x] = 0;
			cells->watched += open;
		}
	}
	cells->row_span[cells->down] = cells->span_count;
}

void people_place(struct people *p, const struct people_object *object)
{
	p->object = *object;
	watch_tiles(p);
	ask_pixels(p);
	list_spans(p);
	place_count_unknown(p);
	/* Nothing is predicted of new cells. */
	memset(p->place.light_then, 0, sizeof(p->place.light_then));
	nudge_place(p);
	far_side_measure(p);
}

void people_take_depth(struct people *p, const struct depth_map *depth)
{
	p->crowd.depth = depth;
}

/* ---- a frame ---- */

static void report(struct people *p)
{
	p->report.learned = p->cells.watched ? 1 - (double)p->place.unknown / p->cells.watched : 1;
	for (int c = 0; c < 3; c++)
		p->report.gain[c] = (double)p->place.gain[c];
	for (int k = 0; k < 2; k++)
		p->report.moved_px[k] = (double)p->nudge.told[k];
	p->report.sure = (double)p->nudge.sure;
	p->report.lost = p->nudge.lost;
}

static void find_people(struct people *p, const struct picture *background)
{
	verdict_judge(p);
	groups_find(p);
	persons_follow(p);
	groups_order(p);
	outline_draw(p, background);
	/* A frame that is looked at again, as another pose has come, teaches nothing twice. */
	if (p->step_ms > 0) {
		cells_follow_noise(p, background);
		place_learn(p);
		p->frame++;
	}
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
	gain_follow(p);
	cells_follow_stillness(p);
	if (!p->nudge.lost)
		find_people(p, background);
	nudge_follow(p);
	report(p);
}

void people_look(struct people *p, const struct picture *background, const float (*radiance)[3],
		 int64_t captured_ns)
{
	look_at_frame(p, background, radiance, captured_ns);
	p->crowd.depth = NULL;
}

const struct veil *people_veil(const struct people *p)
{
	return p->visited ? &p->outline.veil : NULL;
}

void people_learn(struct people *p)
{
	p->place.learn_now = true;
	nudge_forget(&p->nudge);
}

void people_forget(struct people *p)
{
	place_forget(p);
	p->report.learned = 0;
}

const struct sensor_noise *people_noise(const struct people *p)
{
	return p->cells.sensor;
}

struct people_report people_report(const struct people *p)
{
	return p->report;
}
