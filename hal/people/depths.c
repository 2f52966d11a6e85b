/* SPDX-License-Identifier: MIT */
/*
 * Depths of a camera that stands elsewhere, as the background's camera would measure them: some of
 * its pixels, each at its place in the world, in a coarse picture of the background's view, in
 * which the nearest counts.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define ASKED_MOST 1024 /* so many cells of a person's box, about, are asked for their depth */
#define KNOWN_LEAST 4	/* with fewer known ones, or */
#define KNOWN_SHARE 0.2 /* a smaller share of those asked, depths tell nothing */

enum {
	SAMPLES_ACROSS = 160,
	SAMPLES_DOWN = 120,
	SAMPLES = SAMPLES_ACROSS * SAMPLES_DOWN,
	MOVED_ACROSS = 80,
	MOVED_DOWN = 60,
};

struct depths {
	double origin[3];
	float ray[SAMPLES][3]; /* what a metre along the camera's axis is in the world; 0: no ray */
	struct depth_map moved;
	uint8_t words[2 * MOVED_ACROSS * MOVED_DOWN]; /* mm */
};

static void prepare_ray(struct depths *d, const struct tsai_camera *camera, int k)
{
	const double *axis = &camera->rotation[6];
	const double px[2] = {(k % SAMPLES_ACROSS + 0.5) * camera->width / SAMPLES_ACROSS,
			      (k / SAMPLES_ACROSS + 0.5) * camera->height / SAMPLES_DOWN};
	double dir[3], along;

	if (tsai_ray(camera, px, d->origin, dir))
		return;
	along = axis[0] * dir[0] + axis[1] * dir[1] + axis[2] * dir[2];
	for (int i = 0; i < 3; i++)
		d->ray[k][i] = (float)(dir[i] / along);
}

int depths_create(struct people *p, const struct tsai_camera *camera)
{
	struct depths *d = camera ? calloc(1, sizeof(*d)) : NULL;

	if (camera && !d)
		return -ENOMEM;
	for (int k = 0; d && k < SAMPLES; k++)
		prepare_ray(d, camera, k);
	if (d)
		d->moved = (struct depth_map){d->words,	    2,		2 * MOVED_ACROSS,
					      MOVED_ACROSS, MOVED_DOWN, 0.001};
	p->crowd.depths = d;
	return 0;
}

/* Puts a place in the world into the background's view. */
static void move_place(struct depths *d, const struct people *p, const double world[3])
{
	const struct tsai_camera *camera = p->object.camera;
	const double *axis = &camera->rotation[6];
	const double m = axis[0] * world[0] + axis[1] * world[1] + axis[2] * world[2] +
			 camera->translation[2];
	uint8_t *word;
	double px[2];
	int x, y, mm, before;

	if (!(m > 0 && m < 65) || tsai_project(camera, world, px) || px[0] < 0 || px[1] < 0)
		return;
	x = (int)fmin(px[0] * MOVED_ACROSS / p->settings.width, MOVED_ACROSS);
	y = (int)fmin(px[1] * MOVED_DOWN / p->settings.height, MOVED_DOWN);
	if (x == MOVED_ACROSS || y == MOVED_DOWN)
		return;
	word = &d->words[2 * (y * MOVED_ACROSS + x)];
	mm = (int)(1000 * m + 0.5);
	before = word[0] | word[1] << 8;
	if (before && before <= mm)
		return;
	word[0] = (uint8_t)mm;
	word[1] = (uint8_t)(mm >> 8);
}

static void move_depths(struct depths *d, const struct people *p)
{
	const struct depth_map *map = p->crowd.depth;

	memset(d->words, 0, sizeof(d->words));
	for (int k = 0; k < SAMPLES; k++) {
		const int x = (2 * (k % SAMPLES_ACROSS) + 1) * map->width / (2 * SAMPLES_ACROSS);
		const int y = (2 * (k / SAMPLES_ACROSS) + 1) * map->height / (2 * SAMPLES_DOWN);
		const double depth = depth_map_at(map, x, y);
		double world[3];

		if (!(depth > 0))
			continue;
		for (int i = 0; i < 3; i++)
			world[i] = d->origin[i] + depth * (double)d->ray[k][i];
		move_place(d, p, world);
	}
}

void depths_move(struct people *p)
{
	struct depths *d = p->crowd.depths;

	if (d && p->crowd.depth && p->crowd.depth != &d->moved) {
		move_depths(d, p);
		p->crowd.depth = &d->moved;
	}
}

void depths_free(struct people *p)
{
	free(p->crowd.depths);
	p->crowd.depths = NULL;
}

/* ---- order ---- */

/* Where what a cell shows is, seen from above: its direction and its distance from the camera.
 * False: its depth is not known. */
static bool cell_by_depth(const struct people *p, const struct depth_map *map, int x, int y,
			  double *direction_rad, float *far)
{
	const double *axis = &p->object.camera->rotation[6];
	const double px[2] = {(x + 0.5) * p->cells.side, (y + 0.5) * p->cells.side};
	const int u = (int)(px[0] * map->width / p->settings.width);
	const int v = (int)(px[1] * map->height / p->settings.height);
	const double depth = depth_map_at(map, u < map->width ? u : map->width - 1,
					  v < map->height ? v : map->height - 1);
	double origin[3], dir[3], t;

	if (!(depth > 0) || tsai_ray(p->object.camera, px, origin, dir))
		return false;
	t = depth / (axis[0] * dir[0] + axis[1] * dir[1] + axis[2] * dir[2]);
	*direction_rad = atan2(dir[1], dir[0]);
	*far = (float)(t * hypot(dir[0], dir[1]));
	return true;
}

enum told depths_ask(const struct people *p, int person, const struct box *box, float lean)
{
	const struct depth_map *map = p->crowd.depth;
	const int area = (box->right + 1 - box->left) * (box->bottom + 1 - box->top);
	int step = 1, asked = 0, known = 0, nearer = 0;

	while (map && step * step * ASKED_MOST < area)
		step++;
	for (int y = box->top; map && y <= box->bottom; y += step)
		for (int x = box->left; x <= box->right; x += step) {
			double direction;
			float far;

			if (p->crowd.label[y * p->cells.across + x] != person)
				continue;
			asked++;
			if (!cell_by_depth(p, map, x, y, &direction, &far))
				continue;
			known++;
			nearer += far < far_side_at(p, x, direction) * (1 + lean);
		}
	if (known < KNOWN_LEAST || known < KNOWN_SHARE * asked)
		return TOLD_NOTHING;
	return 2 * nearer > known ? TOLD_FRONT : TOLD_BEHIND;
}
