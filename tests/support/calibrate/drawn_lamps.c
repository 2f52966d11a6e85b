/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/drawn_lamps.h"

#include <math.h>
#include <stdbool.h>

#include "hal/colour/transfer.h"
#include "hal/optics/vec.h"
#include "tests/support/test.h"

#define PARTS 4

static double light_along(const struct drawn_room *room, const double at[3], const double dir[3])
{
	double light = room->sky, nearest = INFINITY;

	for (int k = 0; k < room->lamps; k++) {
		const struct drawn_lamp *lamp = &room->lamp[k];
		double to[3], distance;

		for (int i = 0; i < 3; i++)
			to[i] = lamp->at[i] - at[i];
		distance = vec_normalize(to);
		if (distance < nearest && vec_angle(to, dir) < asin(lamp->radius / distance)) {
			light = lamp->radiance;
			nearest = distance;
		}
	}
	return light;
}

/* Whether a pixel may show a part of a lamp. */
static bool is_near_lamp(const struct drawn_room *room, const struct fisheye *lens,
			 const double px[2], const double at[3], const double turn[3])
{
	double dir[3], across[3];

	if (!fisheye_ray(lens, px, dir))
		return true; /* a part of it may be inside of the rim */
	vec_cross(turn, dir, across);
	for (int k = 0; k < room->lamps; k++) {
		double to[3], distance;

		for (int i = 0; i < 3; i++)
			to[i] = room->lamp[k].at[i] - at[i];
		distance = vec_normalize(to);
		if (vec_angle(to, dir) < asin(room->lamp[k].radius / distance) +
						 vec_length(across) +
						 2 * sqrt(fisheye_pixel_sr(lens, px)))
			return true;
	}
	return false;
}

void draw_lamps(struct image *picture, const struct drawn_room *room, const struct fisheye *lens,
		int side, const double at[3], const double turn[3])
{
	assert_int_equal(image_create_f32(picture, side, side), 0);
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			const double middle[2] = {x + 0.5, y + 0.5};
			const bool whole = is_near_lamp(room, lens, middle, at, turn);
			double sum = whole ? 0 : room->sky;

			for (int part = 0; whole && part < PARTS * PARTS; part++) {
				const double px[2] = {x + (part % PARTS + 0.5) / PARTS,
						      y + (part / PARTS + 0.5) / PARTS};
				double dir[3], more[3];

				if (!fisheye_ray(lens, px, dir))
					continue;
				vec_cross(turn, dir, more);
				for (int i = 0; i < 3; i++)
					dir[i] += more[i];
				vec_normalize(dir);
				sum += light_along(room, at, dir) / (PARTS * PARTS);
			}
			for (int c = 0; c < 3; c++)
				picture->f32[3 * (y * side + x) + c] = (float)sum;
		}
}

void encode_lamps(struct image *picture, double exposure)
{
	struct image codes;

	assert_int_equal(image_create_u8(&codes, picture->width, picture->height), 0);
	for (int i = 0; i < 3 * picture->width * picture->height; i++)
		codes.u8[i] = (uint8_t)lrint(
			255 * transfer_encode(TRANSFER_SRGB, exposure * (double)picture->f32[i]));
	image_free(picture);
	*picture = codes;
}
