/* SPDX-License-Identifier: MIT */
/*
 * What two cameras see in the simulated studio, at one moment, as linear light for camera_sim.c to
 * play:
 *     room CAMERA.ini EYE.ini FOLDER
 * CAMERA.ini is the background camera, EYE.ini the lens of a fisheye of 480 x 480 px that lies at
 * the studio's origin. Writes
 *     background.pfm, fisheye.pfm       the room
 *     background-1.pfm ... -9.pfm       a board 9x6:50mm, first on the ground around the
 *                                       origin, then held in front of the camera
 *     fisheye-1.pfm ... -9.pfm          a board 9x6:20mm, first level over the lens, then around it
 *     panorama.pfm                      the light that arrives at the origin, without lanterns
 * and prints a line for each lantern: x y z radius r g b, in metres and radiance.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/boards.h"
#include "bake/sky/sky_eye.h"
#include "drivers/sim/sim.h"
#include "hal/image/image.h"
#include "hal/optics/panorama.h"
#include "hal/optics/vec.h"

#define MOMENT_S 4 /* both lanterns stand well */
#define BOARDS 9
#define EYE_SIDE 480
#define PANORAMA_WIDTH 512
#define SIDE 8 /* samples across a pixel */

static const double paper = 0.45, ink = 0.03; /* radiance */

static const char *folder;

static int keep(const char *name, int number, struct image *image)
{
	char path[4096];
	struct fault fault = {.text = ""};
	int err;

	if (number)
		snprintf(path, sizeof(path), "%s/%s-%d.pfm", folder, name, number);
	else
		snprintf(path, sizeof(path), "%s/%s.pfm", folder, name);
	err = image_write(path, image, &fault);
	if (err)
		fprintf(stderr, "room: %s\n", fault.text);
	image_free(image);
	return err;
}

/* Radiance of the board where a ray meets it; below 0: it does not. */
static double board_light(const struct board *b, const double origin[3], const double dir[3])
{
	double at[3] = {0}, far[3] = {0}, mm[2];

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			at[i] += b->rotation[3 * j + i] * (origin[j] - b->position[j]) / b->unit;
			far[i] += b->rotation[3 * j + i] * dir[j];
		}
	if (far[2] < 1e-9 || at[2] >= 0)
		return -1;
	for (int i = 0; i < 2; i++)
		mm[i] = at[i] - at[2] / far[2] * far[i];
	if (mm[0] < -2 * b->step_mm || mm[1] < -2 * b->step_mm ||
	    mm[0] > (b->columns + 1) * b->step_mm || mm[1] > (b->rows + 1) * b->step_mm)
		return -1;
	return board_ink(b, mm[0], mm[1]) ? ink : paper;
}

/* The board at a point of the picture; below 0: something else, or nothing, is seen there. */
static double light_at(const struct sim_eye *eye, const struct board *board, double x, double y)
{
	const double px[2] = {x, y};
	double origin[3], dir[3];

	return eye_ray(eye, px, origin, dir) ? board_light(board, origin, dir) : -1;
}

/* Puts the board into a pixel of the room: the mean over it, or its first corner where all are
 * equal. */
static void cover(const struct sim_eye *eye, const struct board *board, int x, int y, float rgb[3])
{
	const double first = light_at(eye, board, x, y);
	double sum = 0;
	int hits = 0, same = 0;

	for (int k = 1; k < 4; k++)
		same += light_at(eye, board, x + k % 2, y + k / 2) == first;
	if (same == 3 && first < 0)
		return;
	for (int k = 0; k < SIDE * SIDE; k++) {
		const double i = k % SIDE, j = k / SIDE;
		const double light = same == 3 ? first
					       : light_at(eye, board,
							  x + (i + (j + 0.5) / SIDE) / SIDE,
							  y + (j + (i + 0.5) / SIDE) / SIDE);

		hits += light >= 0;
		sum += light >= 0 ? light : 0;
	}
	for (int c = 0; c < 3; c++)
		rgb[c] = (float)((sum + rgb[c] * (float)(SIDE * SIDE - hits)) / (SIDE * SIDE));
}

/* Writes the room, with a board unless that is NULL. */
static int photograph(const struct sim_eye *eye, const struct image *room,
		      const struct board *board, const char *name, int number)
{
	struct image image;
	int err = image_create_f32(&image, eye->width, eye->height);

	if (err)
		return err;
	memcpy(image.f32, room->f32, 3 * sizeof(float) * (size_t)eye->width * (size_t)eye->height);
	for (int p = 0; board && p < eye->width * eye->height; p++)
		cover(eye, board, p % eye->width, p / eye->width, image.f32 + 3 * p);
	return keep(name, number, &image);
}

/* Places the middle of the board, whose back looks along `away`, its rows as near to `right` as can
 * be. */
static void place(struct board *b, const double middle[3], const double away[3],
		  const double right[3])
{
	double x[3], y[3], z[3];

	memcpy(z, away, sizeof(z));
	vec_normalize(z);
	vec_cross(z, right, y);
	vec_normalize(y);
	vec_cross(y, z, x);
	for (int i = 0; i < 3; i++) {
		b->rotation[3 * i] = x[i];
		b->rotation[3 * i + 1] = y[i];
		b->rotation[3 * i + 2] = z[i];
		b->position[i] = middle[i] - b->step_mm * b->unit *
						     ((b->columns - 1) / 2.0 * x[i] +
						      (b->rows - 1) / 2.0 * y[i]);
	}
}

/* A board held in front of the camera: its middle is seen at px, in m from the camera; tilted about
 * the picture's rows and columns, in rad. */
static void hold(struct board *board, const struct sim_eye *eye, const double px[2],
		 double distance, double tilt_x, double tilt_y)
{
	const double *r = eye->camera.rotation;
	double origin[3], dir[3], middle[3], away[3];

	(void)eye_ray(eye, px, origin, dir);
	for (int i = 0; i < 3; i++) {
		middle[i] = origin[i] + distance * dir[i];
		away[i] = r[6 + i] + tan(tilt_y) * r[i] + tan(tilt_x) * r[3 + i];
	}
	place(board, middle, away, r);
}

static int film_background(const struct sim_eye *eye, const struct image *room)
{
	static const struct {
		double px[2], distance, tilt_x, tilt_y;
	} held[BOARDS - 1] = {
		{{320, 240}, 0.9, 0, 0},	{{195, 165}, 1.2, 0.6, 0.2},
		{{445, 165}, 1.2, -0.2, 0.6},	{{195, 315}, 1.15, 0.2, -0.6},
		{{445, 315}, 1.15, -0.6, -0.2}, {{320, 180}, 1.2, 0.7, 0},
		{{330, 280}, 1.2, 0, -0.7},	{{320, 220}, 1.3, -0.6, 0.5},
	};
	struct board board;
	int err = board_parse(&board, "9x6:50mm", NULL);

	if (err)
		return err;
	/* As it is parsed it lies on the ground; its middle comes to the origin. */
	board.position[0] = -0.2;
	board.position[1] = 0.125;
	err = photograph(eye, room, NULL, "background", 0);
	if (!err)
		err = photograph(eye, room, &board, "background", 1);
	for (int k = 0; k < BOARDS - 1 && !err; k++) {
		hold(&board, eye, held[k].px, held[k].distance, held[k].tilt_x, held[k].tilt_y);
		err = photograph(eye, room, &board, "background", k + 2);
	}
	return err;
}

static int film_fisheye(const struct sim_eye *eye, const struct image *room)
{
	struct board board;
	int err = board_parse(&board, "9x6:20mm", NULL);

	if (err)
		return err;
	place(&board, (double[]){0.01, -0.015, 0.13}, (double[]){0, 0, 1}, (double[]){1, 0, 0});
	err = photograph(eye, room, NULL, "fisheye", 0);
	if (!err)
		err = photograph(eye, room, &board, "fisheye", 1);
	for (int k = 0; k < BOARDS - 1 && !err; k++) {
		const double phi = 2 * M_PI * k / (BOARDS - 1), theta = k % 2 ? 0.75 : 1.05;
		const double away[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
		const double middle[3] = {0.15 * away[0], 0.15 * away[1], 0.15 * away[2]};
		const double tilted[3] = {away[0] + 0.3 * (k % 3 - 1), away[1] - 0.25 * (k % 2),
					  away[2] + 0.2};

		place(&board, middle, tilted, (double[]){-away[1], away[0], 0});
		err = photograph(eye, room, &board, "fisheye", k + 2);
	}
	return err;
}

static int film(const struct sim_eye *eye, const struct studio_lamps *lamps)
{
	struct studio_view *view;
	struct image room;
	int err = image_create_f32(&room, eye->width, eye->height);

	if (!err)
		err = studio_view_create(&view, eye);
	if (err)
		return err;
	studio_view_render(view, lamps, room.f32);
	studio_view_destroy(view);
	err = eye->fisheye ? film_fisheye(eye, &room) : film_background(eye, &room);
	image_free(&room);
	return err;
}

/* Walls, panels and window without the lanterns, which are lamps at places. */
static int paint_panorama(const struct studio_lamps *lamps)
{
	const double origin[3] = {0};
	struct image image;
	const struct panorama panorama = {.image = &image, .scale = 1};
	int err = image_create_f32(&image, PANORAMA_WIDTH, PANORAMA_WIDTH / 2);

	for (int p = 0; !err && p < PANORAMA_WIDTH * (PANORAMA_WIDTH / 4); p++) {
		double sum[3] = {0}, dir[3], rgb[3];
		struct studio_hit hit;

		for (int k = 0; k < 16; k++) {
			panorama_direction(&panorama, p % PANORAMA_WIDTH + (k % 4 + 0.5) / 4,
					   p / PANORAMA_WIDTH + (k / 4 + 0.5) / 4, dir);
			(void)studio_hit(origin, dir, &hit);
			/* From the wall itself: no lantern is in the way. */
			studio_radiance(hit.point, dir, lamps, rgb);
			for (int c = 0; c < 3; c++)
				sum[c] += rgb[c] / 16;
		}
		for (int c = 0; c < 3; c++)
			image.f32[3 * p + c] = (float)sum[c];
	}
	return err ? err : keep("panorama", 0, &image);
}

static void *camera_place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

int main(int argc, char **argv)
{
	static const struct ini_table tables[] = {
		{.section = "camera", .keys = tsai_keys, .place = camera_place}, INI_TABLES_END};
	const struct studio_lamps lamps = studio_lamps(MOMENT_S, 0);
	struct sim_eye background = {.fisheye = false}, fisheye = {.fisheye = true};
	struct ini_report report = {.count = 0};
	struct fisheye_settings lens;
	struct fault fault = {.text = ""};

	if (argc != 4)
		return EXIT_FAILURE;
	folder = argv[3];
	ini_defaults(tsai_keys, &background.camera);
	if (ini_read(argv[1], tables, &background.camera, &report)) {
		fprintf(stderr, "room: %s\n", report.first.text);
		return EXIT_FAILURE;
	}
	background.width = background.camera.width;
	background.height = background.camera.height;
	fisheye.width = fisheye.height = EYE_SIDE;
	if (tsai_check(&background.camera, &fault) || sky_eye_lens(&lens, argv[2], &fault) ||
	    fisheye_prepare(&fisheye.lens, &lens, EYE_SIDE, EYE_SIDE, &fault)) {
		fprintf(stderr, "room: %s\n", fault.text);
		return EXIT_FAILURE;
	}
	for (const struct studio_lantern *l = lamps.lantern; l < lamps.lantern + STUDIO_LANTERNS;
	     l++)
		printf("%f %f %f %g %g %g %g\n", l->centre[0], l->centre[1], l->centre[2],
		       l->radius, l->radiance[0], l->radiance[1], l->radiance[2]);
	return film(&background, &lamps) || film(&fisheye, &lamps) || paint_panorama(&lamps);
}
