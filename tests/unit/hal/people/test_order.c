/* SPDX-License-Identifier: MIT */
/* Who stands before the object: walkers all around objects whose place on the ground has a closed form. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"
#include "tests/support/expect.h"

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
	double eye[2];
	struct slab slabs[2];
	int count;
	struct basis_footprint foot;
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
	struct people_object object;

	assert_int_equal(dome_create(&s->dome, 1, DOME_ANGLES, NULL), 0);
	assert_int_equal(tsai_look_at(&s->camera, WIDTH, HEIGHT, eye, target, 70, NULL), 0);
	s->eye[0] = eye[0];
	s->eye[1] = eye[1];
	settings.dome = &s->dome;
	assert_int_equal(people_create(&s->people, &settings, NULL), 0);
	s->coverage = calloc(WIDTH * HEIGHT, sizeof(*s->coverage));
	s->touched = calloc(WIDTH * HEIGHT / 256, 1);
	assert_true(s->coverage && s->touched);
	fill_footprint(s, size);
	object = (struct people_object){s->coverage, s->touched, &s->camera, &s->foot};
	people_place(s->people, &object);
}

static void stage_end(struct stage *s)
{
	people_destroy(s->people);
	dome_free(&s->dome);
	free(s->coverage);
	free(s->touched);
}

/* Whether somebody whose feet are in a cell is before the object. */
static bool is_front(const struct stage *s, int x, int y)
{
	const struct group group = {.foot_x = x + 0.5, .foot_y = y};

	return order_is_front(s->people, &group);
}

/* Walkers on all cells of the ground whose direction meets the object: those nearer than its far side
 * are in front. Near the border, by the squares' size and a cell's, either is right. */
static void all_around(struct stage *s, const double eye[3], double size)
{
	const double unsure = 2.5 * size / BASIS_FOOT_SQUARES;
	int before = 0, behind = 0, wrong = 0;

	stage_begin(s, eye, size);
	for (int y = 0; y < s->people->down - 1; y++)
		for (int x = 0; x < s->people->across; x++) {
			const double px[2] = {(x + 0.5) * s->people->side,
					      (y + 1) * s->people->side};
			double origin[3], dir[3], t, far = -1, is, direction;

			assert_int_equal(tsai_ray(&s->camera, px, origin, dir), 0);
			if (dir[2] > -0.02)
				continue;
			t = -origin[2] / dir[2];
			is = hypot(t * dir[0], t * dir[1]);
			direction = atan2(dir[1], dir[0]);
			for (int k = 0; k < s->count; k++)
				far = fmax(far, leaves(&s->slabs[k], s->eye, direction));
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

static void around_a_wide_wall(void **state)
{
	struct stage s = {.slabs = {{0, 0, 0, 4, 0.3}}, .count = 1};

	(void)state;
	all_around(&s, ahead, 4.2);
}

static void around_a_turned_wall(void **state)
{
	struct stage s = {.slabs = {{0, 0, 0.6, 3, 0.4}}, .count = 1};

	(void)state;
	all_around(&s, aside, 3.4);
}

static void around_two_parts(void **state)
{
	struct stage s = {.slabs = {{-1, 0.4, 0, 0.5, 0.5}, {1.1, -0.5, 0.3, 0.6, 0.4}},
			  .count = 2};

	(void)state;
	all_around(&s, ahead, 3.2);
}

/* An L, open away from the camera: who stands in its corner is behind it. */
static void in_the_corner_of_an_l(void **state)
{
	struct stage s = {.slabs = {{0, -0.9, 0, 2, 0.2}, {-0.9, 0, 0, 0.2, 2}}, .count = 2};

	(void)state;
	all_around(&s, ahead, 2.2);
}

/* The camera stands inside of a ring's outline, as under an arch. */
static void from_within(void **state)
{
	struct stage s = {.slabs = {{0, 2, 0, 5, 0.3}, {0, -6, 0, 5, 0.3}}, .count = 2};
	const double eye[3] = {0, -2, 1.8};

	(void)state;
	all_around(&s, eye, 13);
}

/* Beside the object, that part of it counts which is nearest in direction. */
static void beside_a_wall_its_end_counts(void **state)
{
	struct stage s = {.slabs = {{0, 0, 0.5, 2, 0.2}}, .count = 1};
	int front[2] = {0, 0}, all[2] = {0, 0};

	(void)state;
	stage_begin(&s, ahead, 2.2);
	for (int y = 0; y < s.people->down - 1; y++)
		for (int x = 0; x < s.people->across; x++) {
			const double px[2] = {(x + 0.5) * s.people->side, (y + 1) * s.people->side};
			double origin[3], dir[3], at[2];

			assert_int_equal(tsai_ray(&s.camera, px, origin, dir), 0);
			if (dir[2] > -0.02)
				continue;
			for (int k = 0; k < 2; k++)
				at[k] = origin[k] - origin[2] / dir[2] * dir[k];
			/* The wall's right end is 0.48 m farther than its middle, the left nearer. */
			if (at[1] < -0.2 || at[1] > 0.2 || fabs(at[0]) < 1.2 || fabs(at[0]) > 1.5)
				continue;
			all[at[0] > 0]++;
			front[at[0] > 0] += is_front(&s, x, y);
		}
	assert_true(all[0] > 20 && all[1] > 20);
	expect_equal(front[0], 0, "left: behind the near end");
	expect_equal(front[1], all[1], "right: before the far end");
	stage_end(&s);
}

/* The coverage's lower edge counts for files without a footprint. */
static void without_a_footprint_the_lower_edge_counts(void **state)
{
	struct stage s = {.count = 0};
	struct people_object object;

	(void)state;
	stage_begin(&s, ahead, 1);
	for (int y = 200; y < 320; y++)
		for (int x = 240; x < 400; x++)
			s.coverage[y * WIDTH + x] = 65535;
	object = (struct people_object){s.coverage, s.touched, &s.camera, NULL};
	people_place(s.people, &object);
	for (int x = 20; x < WIDTH - 20; x += 20) { /* beside it the nearest column counts */
		const int side = s.people->side, edge = 320 / side;
		const int off = x < 240 || x >= 400 ? 30 : 3; /* cells */

		assert_false(is_front(&s, x / side, edge - off));
		assert_true(is_front(&s, x / side, edge + off));
		assert_true(is_front(&s, x / side, s.people->down - 1));
	}
	object.camera = NULL;
	people_place(s.people, &object);
	assert_false(is_front(&s, WIDTH / 2 / s.people->side, 400 / s.people->side));
	stage_end(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(around_a_wide_wall),
		cmocka_unit_test(around_a_turned_wall),
		cmocka_unit_test(around_two_parts),
		cmocka_unit_test(in_the_corner_of_an_l),
		cmocka_unit_test(from_within),
		cmocka_unit_test(beside_a_wall_its_end_counts),
		cmocka_unit_test(without_a_footprint_the_lower_edge_counts),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
