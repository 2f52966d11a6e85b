/* SPDX-License-Identifier: MIT */
/* Who stands before the object: walkers all around objects whose place on the ground has a closed
 * form. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define WIDTH 640
#define HEIGHT 480

/* A rectangle of the ground, turned. */
struct slab {
	double x, y, turn_rad, width, depth;
};

struct stage {
	struct people *people;
	struct dome dome;
	struct tsai_camera camera;
	const struct tsai_camera *depth_camera; /* NULL: in the camera's place */
	struct slab slabs[2];
	int count;
	struct basis_footprint foot;
	struct people_object object;
	uint16_t *coverage;
	uint8_t *touched;
};

static bool is_in(const struct slab *s, double x, double y)
{
	const double c = cos(s->turn_rad), n = sin(s->turn_rad);

	return fabs(c * (x - s->x) + n * (y - s->y)) <= s->width / 2 &&
	       fabs(-n * (x - s->x) + c * (y - s->y)) <= s->depth / 2;
}

/* Where the ray from the eye in a direction leaves a slab for good; < 0: it misses it. */
static double leaves(const struct slab *s, const double eye[2], double direction)
{
	const double c = cos(s->turn_rad), n = sin(s->turn_rad);
	const double from[2] = {c * (eye[0] - s->x) + n * (eye[1] - s->y),
				-n * (eye[0] - s->x) + c * (eye[1] - s->y)};
	const double way[2] = {cos(direction - s->turn_rad), sin(direction - s->turn_rad)};
	const double half[2] = {s->width / 2, s->depth / 2};
	double enter = 0, leave = INFINITY;

	for (int k = 0; k < 2; k++) {
		const double a = (-half[k] - from[k]) / way[k], b = (half[k] - from[k]) / way[k];

		enter = fmax(enter, fmin(a, b));
		leave = fmin(leave, fmax(a, b));
	}
	return enter < leave ? leave : -1;
}

static void fill_footprint(struct stage *s, double size)
{
	s->foot.side = (float)(size / BASIS_FOOT_SQUARES);
	s->foot.corner[0] = s->foot.corner[1] = (float)(-size / 2);
	for (int j = 0; j < 16 * BASIS_FOOT_SQUARES; j++)
		for (int i = 0; i < 16 * BASIS_FOOT_SQUARES; i++)
			for (int k = 0; k < s->count; k++)
				if (is_in(&s->slabs[k],
					  size * ((i + 0.5) / 16 / BASIS_FOOT_SQUARES - 0.5),
					  size * ((j + 0.5) / 16 / BASIS_FOOT_SQUARES - 0.5)))
					s->foot.row[j / 16] |= UINT64_C(1) << i / 16;
}

static void stage_begin(struct stage *s, const double eye[3], double size)
{
	const double target[3] = {0, 0, 0.3};
	struct people_settings settings = {
		.width = WIDTH, .height = HEIGHT, .curve = {.named = TRANSFER_SRGB}};

	assert_int_equal(dome_create(&s->dome, 1, NULL), 0);
	assert_int_equal(tsai_look_at(&s->camera, WIDTH, HEIGHT, eye, target, 70, NULL), 0);
	settings.dome = &s->dome;
	settings.depth_camera = s->depth_camera;
	assert_int_equal(people_create(&s->people, &settings, NULL), 0);
	s->coverage = calloc(WIDTH * HEIGHT, sizeof(*s->coverage));
	s->touched = calloc(WIDTH * HEIGHT / 256, 1);
	assert_true(s->coverage && s->touched);
	memset(s->touched, 1, WIDTH * HEIGHT / 256);
	fill_footprint(s, size);
	s->object = (struct people_object){.coverage = s->coverage,
					   .touched = s->touched,
					   .camera = &s->camera,
					   .foot = &s->foot};
	people_place(s->people, &s->object);
}

static void stage_end(struct stage *s)
{
	people_destroy(s->people);
	dome_free(&s->dome);
	free(s->coverage);
	free(s->touched);
}

/* Where the lower edge of a cell is on the ground. False: it is too near the horizon. */
static bool ground_at(const struct stage *s, int x, int y, double at[2])
{
	const double px[2] = {(x + 0.5) * s->people->cells.side, (y + 1) * s->people->cells.side};
	double origin[3], dir[3];

	assert_int_equal(tsai_ray(&s->camera, px, origin, dir), 0);
	for (int k = 0; k < 2; k++)
		at[k] = origin[k] - origin[2] / dir[2] * dir[k];
	return dir[2] <= -0.02;
}

/* Whether somebody whose feet are in a cell is before the object. */
static bool is_front(const struct stage *s, int x, int y)
{
	double direction;
	float far;

	return far_side_point(s->people, x + 0.5, y + 1, 0, &direction, &far) &&
	       far < far_side_at(s->people, x + 0.5, direction);
}

/* Walkers on all cells of the ground whose direction meets the object: those nearer than its far
 * side are in front. Near the border, by the squares' size and a cell's, either is right. */
static void all_around(struct stage *s, const double eye[3], double size)
{
	const double unsure = 2.5 * size / BASIS_FOOT_SQUARES;
	int before = 0, behind = 0, wrong = 0;

	stage_begin(s, eye, size);
	for (int y = 0; y < s->people->cells.down - 1; y++)
		for (int x = 0; x < s->people->cells.across; x++) {
			double at[2], far = -1, is, direction;

			if (!ground_at(s, x, y, at))
				continue;
			is = hypot(at[0] - eye[0], at[1] - eye[1]);
			direction = atan2(at[1] - eye[1], at[0] - eye[0]);
			for (int k = 0; k < s->count; k++)
				far = fmax(far, leaves(&s->slabs[k], eye, direction));
			if (far < 0 || fabs(is - far) < unsure + 0.01 * far)
				continue;
			before += is < far;
			behind += is > far;
			wrong += is_front(s, x, y) != (is < far);
		}
	expect_above(before, 300, "walkers before");
	expect_above(behind, 300, "walkers behind");
	/* Where the ray grazes a corner, a square more or less is another far side. */
	expect_at_most(wrong, 0.002 * (before + behind), "walkers on the wrong side");
	stage_end(s);
}

static const double ahead[3] = {0, -5, 1.8}, aside[3] = {4, -4, 2.5};

TEST("around a wide wall")
{
	struct stage s = {.slabs = {{0, 0, 0, 4, 0.3}}, .count = 1};

	all_around(&s, ahead, 4.2);
}

TEST("around a turned wall")
{
	struct stage s = {.slabs = {{0, 0, 0.6, 3, 0.4}}, .count = 1};

	all_around(&s, aside, 3.4);
}

TEST("around two parts")
{
	struct stage s = {.slabs = {{-1, 0.4, 0, 0.5, 0.5}, {1.1, -0.5, 0.3, 0.6, 0.4}},
			  .count = 2};

	all_around(&s, ahead, 3.2);
}

/* An L, open away from the camera: who stands in its corner is behind it. */
TEST("in the corner of an l")
{
	struct stage s = {.slabs = {{0, -0.9, 0, 2, 0.2}, {-0.9, 0, 0, 0.2, 2}}, .count = 2};

	all_around(&s, ahead, 2.2);
}

/* The camera stands inside of a ring's outline, as under an arch. */
TEST("from within")
{
	struct stage s = {.slabs = {{0, 2, 0, 5, 0.3}, {0, -6, 0, 5, 0.3}}, .count = 2};
	const double eye[3] = {0, -2, 1.8};

	all_around(&s, eye, 13);
}

/* Beside the object, that part of it counts which is nearest in direction. */
TEST("beside a wall its end counts")
{
	struct stage s = {.slabs = {{0, 0, 0.5, 2, 0.2}}, .count = 1};
	int front[2] = {0, 0}, all[2] = {0, 0};

	stage_begin(&s, ahead, 2.2);
	for (int y = 0; y < s.people->cells.down - 1; y++)
		for (int x = 0; x < s.people->cells.across; x++) {
			double at[2];

			if (!ground_at(&s, x, y, at))
				continue;
			/* The wall's right end is 0.48 m farther than its middle, the left
			 * nearer. */
			if (fabs(at[1]) > 0.25 || fabs(at[0]) < 1.1 || fabs(at[0]) > 1.6)
				continue;
			all[at[0] > 0]++;
			front[at[0] > 0] += is_front(&s, x, y);
		}
	assert_true(all[0] > 20 && all[1] > 20);
	expect_equal(front[0], 0, "left: behind the near end");
	expect_equal(front[1], all[1], "right: before the far end");
	stage_end(&s);
}

/* ---- bodies, by their feet and by depth ---- */

enum { MAP_WIDTH = 212, MAP_HEIGHT = 120 }; /* not the background's shape, either */

/* What the depth camera measures, in mm. */
static uint8_t words[2 * MAP_WIDTH * MAP_HEIGHT];
static const struct depth_map map = {words, 2, 2 * MAP_WIDTH, MAP_WIDTH, MAP_HEIGHT, 0.001};

/* An upright body of the depth camera's and of the background's picture. */
struct standing {
	double x, y;	 /* ground; m */
	double hidden_m; /* so much of it is hidden, from its feet on */
	double unknown;	 /* share of its pixels whose depth is 0 */
	double shift; /* the depth camera sees it so much farther right, as a share of the width */
	uint16_t flying; /* what is measured around it, mm: what is behind */
};

/* Where the ray through a point of the picture, as shares of it, meets the body: its depth in m; 0:
 * it does not. */
static double depth_of_body(const struct tsai_camera *camera, const struct standing *b, double u,
			    double v)
{
	const double px[2] = {u * camera->width, v * camera->height}, *axis = &camera->rotation[6];
	double origin[3], dir[3], t, to[2], far, lateral, height;

	assert_int_equal(tsai_ray(camera, px, origin, dir), 0);
	to[0] = b->x - origin[0];
	to[1] = b->y - origin[1];
	far = hypot(to[0], to[1]);
	t = far * far / (to[0] * dir[0] + to[1] * dir[1]);
	lateral = (to[0] * dir[1] - to[1] * dir[0]) / far * t;
	height = origin[2] + t * dir[2];
	return t > 0 && fabs(lateral) < 0.25 && height > b->hidden_m && height < 1.7
		       ? t * (axis[0] * dir[0] + axis[1] * dir[1] + axis[2] * dir[2])
		       : 0;
}

/* Lets the depth camera measure a body. */
static void measure_body(const struct tsai_camera *camera, const struct standing *b,
			 struct chance *chance)
{
	for (int k = 0; k < MAP_WIDTH * MAP_HEIGHT; k++) {
		const double u = (k % MAP_WIDTH + 0.5) / MAP_WIDTH - b->shift;
		const double v = (k / MAP_WIDTH + 0.5) / MAP_HEIGHT;
		const double depth = depth_of_body(camera, b, u, v);
		unsigned mm = depth > 0 ? (unsigned)lround(1000 * depth) : b->flying;

		if (depth > 0 && chance_real(chance, 0, 1) < b->unknown)
			mm = 0;
		words[2 * k] = (uint8_t)mm;
		words[2 * k + 1] = (uint8_t)(mm >> 8);
	}
}

/* Has the body followed as the only group of a frame, of a camera with depths where depth is not
 * NULL; whether it is before the object. */
static bool follow_body(struct stage *s, const struct standing *b, const struct depth_map *depth)
{
	struct people *p = s->people;
	struct group *g = &p->crowd.groups[0];

	*g = (struct group){.left = p->cells.across, .top = p->cells.down};
	for (int y = 0; y < p->cells.down; y++)
		for (int x = 0; x < p->cells.across; x++) {
			const double u = (x + 0.5) / p->cells.across;
			const double v = (y + 0.5) / p->cells.down;
			const bool in = depth_of_body(&s->camera, b, u, v) > 0;

			p->crowd.label[y * p->cells.across + x] = in ? 0 : -1;
			if (!in)
				continue;
			g->cells++;
			g->top = y < g->top ? y : g->top;
			g->left = x < g->left ? x : g->left;
			g->right = x > g->right ? x : g->right;
			g->bottom = y;
		}
	p->crowd.group_count = 1;
	p->verdict.box = (struct box){g->left, g->right, g->top, g->bottom};
	p->visited = true;
	p->step_ms = 33;
	people_take_depth(p, depth);
	persons_follow(p);
	assert_int_equal(p->crowd.persons, 1);
	return p->crowd.person[0].front;
}

/* The coverage's lower edge counts for files without a footprint, and without a calibrated
 * camera nobody is before the object. */
TEST("without a footprint the lower edge counts")
{
	const struct standing near = {.y = -1.5};
	struct stage s = {.count = 0};

	stage_begin(&s, ahead, 1);
	for (int y = 200; y < 320; y++)
		for (int x = 240; x < 400; x++)
			s.coverage[y * WIDTH + x] = 65535;
	s.object.foot = NULL;
	people_place(s.people, &s.object);
	for (int x = 20; x < WIDTH - 20; x += 20) { /* beside it the nearest column counts */
		const int side = s.people->cells.side, edge = 320 / side;
		const int off = x < 240 || x >= 400 ? 30 : 3; /* cells */

		assert_false(is_front(&s, x / side, edge - off));
		assert_true(is_front(&s, x / side, edge + off));
		assert_true(is_front(&s, x / side, s.people->cells.down - 1));
	}
	assert_true(follow_body(&s, &near, NULL));
	s.object.camera = NULL;
	people_place(s.people, &s.object);
	assert_false(follow_body(&s, &near, NULL));
	stage_end(&s);
}

struct placed_count {
	int all, wrong, front_taken_for_behind;
};

/* Bodies before and behind a wall of 4 m by 0.3 m, with and without depths, which another camera
 * measures where `by` is one; told: people_create() knows where it stands. */
static struct placed_count place_by(struct standing body, bool depth, const struct tsai_camera *by,
				    bool told)
{
	struct stage s = {
		.slabs = {{0, 0, 0, 4, 0.3}}, .count = 1, .depth_camera = told ? by : NULL};
	struct placed_count count = {0, 0, 0};
	struct chance chance = chance_begin("holes");

	stage_begin(&s, ahead, 4.2);
	for (double y = -1.5; y < 1.6; y += 0.35)
		for (double x = -1.2; x < 1.3; x += 0.8) {
			bool front;

			if (fabs(y) < 0.4)
				continue;
			body.x = x;
			body.y = y;
			measure_body(by ? by : &s.camera, &body, &chance);
			s.people->crowd.persons = 0;
			front = follow_body(&s, &body, depth ? &map : NULL);
			count.all++;
			count.wrong += front != (y < 0);
			count.front_taken_for_behind += y < 0 && !front;
		}
	stage_end(&s);
	return count;
}

static struct placed_count place_all(struct standing body, bool depth)
{
	return place_by(body, depth, NULL, false);
}

TEST("feet that a low wall hides do not matter to depth")
{
	const struct standing body = {.hidden_m = 0.9};
	const struct placed_count feet = place_all(body, false), depth = place_all(body, true);

	expect_above(feet.all, 25, "bodies");
	expect_above(feet.front_taken_for_behind, 12, "by the feet");
	expect_equal(depth.wrong, 0, "by depth");
}

TEST("feet that are seen tell the same")
{
	const struct standing body = {.hidden_m = 0};

	expect_equal(place_all(body, false).wrong, 0, "by the feet");
	expect_equal(place_all(body, true).wrong, 0, "by depth");
}

/* Holes, and a depth camera a little beside, with the wall of a room behind the outline. */
TEST("holes and a shift do not matter")
{
	const struct standing holes = {.hidden_m = 0.9, .unknown = 0.7};
	const struct standing beside = {.hidden_m = 0.9, .shift = 4.0 / WIDTH, .flying = 9000};

	expect_equal(place_all(holes, true).wrong, 0, "7 of 10 unknown");
	expect_equal(place_all(beside, true).wrong, 0, "4 pixels beside");
}

TEST("where depths are not known the feet count")
{
	struct standing body = {.hidden_m = 0.9, .unknown = 0.9};

	expect_equal(place_all(body, true).wrong, place_all(body, false).wrong, "9 of 10 unknown");
	body.hidden_m = 0;
	expect_equal(place_all(body, true).wrong, 0, "feet that are seen");
}

/* Cameras that stand elsewhere, of another size and lens, and what they show behind people. */
TEST("a depth camera elsewhere is calibrated")
{
	static const double eyes[][3] = {{0.5, -5, 1.8}, {-2.5, -4.5, 2.4}, {0, -3.5, 2.6}};
	const struct standing body = {.hidden_m = 0.9, .flying = 9000};
	const double target[3] = {0, 0, 0.6};

	for (size_t n = 0; n < sizeof(eyes) / sizeof(*eyes); n++) {
		struct tsai_camera camera;

		assert_int_equal(tsai_look_at(&camera, 424, 240, eyes[n], target, 85, NULL), 0);
		camera.kappa1 = 2e-4; /* 6 % at the edge */
		expect_equal(place_by(body, true, &camera, true).wrong, 0, "camera %zu", n);
		expect_above(place_by(body, true, &camera, false).wrong, 0,
			     "camera %zu, taken for one in the background's place", n);
	}
}

/* Who was before the object stays there until he is farther than the far side by a share. */
TEST("somebody keeps his side by depth")
{
	static const struct {
		double y; /* the far side is at 0.15 */
		bool front;
	} step[] = {{0.2, false}, {-0.2, true}, {0.2, true}, {0.5, false}, {0.2, false}};
	struct stage s = {.slabs = {{0, 0, 0, 4, 0.3}}, .count = 1};
	struct chance chance = chance_begin("holes");

	stage_begin(&s, ahead, 4.2);
	for (size_t n = 0; n < sizeof(step) / sizeof(*step); n++) {
		const struct standing body = {.y = step[n].y, .hidden_m = 0.9};

		measure_body(&s.camera, &body, &chance);
		expect_equal(follow_body(&s, &body, &map), step[n].front, "step %zu", n);
	}
	stage_end(&s);
}
