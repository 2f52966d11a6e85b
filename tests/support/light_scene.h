/* SPDX-License-Identifier: MIT */
/*
 * Cameras for tests of the calibration of light: a curve, a pedestal, noise before the curve and
 * rounding after it, and scenes of even patches over many brightnesses.
 */
#ifndef INLAY_TESTS_LIGHT_SCENE_H
#define INLAY_TESTS_LIGHT_SCENE_H

#include <math.h>
#include <stdlib.h>

#include "hal/colour/transfer.h"
#include "hal/image/image.h"
#include "tests/support/chance.h"

enum light_shape { SHAPE_SRGB, SHAPE_BT709, SHAPE_POWER, SHAPE_FILM, SHAPE_LINEAR, SHAPE_COUNT };

static const char *const light_shape_names[] = {"srgb", "bt709", "power 2.2", "film", "linear"};

struct light_camera {
	enum light_shape shape;
	double black;	   /* code value */
	double read_noise; /* in linear light, of 1 */
	double shot_noise; /* at white; grows as the root */
};

/* Both of 0..1. Film: a toe and a shoulder on top of sRGB. */
static inline double light_shape_encode(enum light_shape shape, double l)
{
	const double g = transfer_encode(TRANSFER_SRGB, l);

	l = fmin(fmax(l, 0), 1);
	switch (shape) {
	case SHAPE_SRGB:
		return g;
	case SHAPE_BT709:
		return transfer_encode(TRANSFER_BT709, l);
	case SHAPE_POWER:
		return pow(l, 1 / 2.2);
	case SHAPE_FILM:
		return 0.4 * g + 0.6 * g * g * (3 - 2 * g);
	default:
		return l;
	}
}

static inline double light_shape_decode(enum light_shape shape, double u)
{
	double low = 0, high = 1;

	for (int i = 0; i < 60; i++) {
		const double middle = (low + high) / 2;

		if (light_shape_encode(shape, middle) < u)
			low = middle;
		else
			high = middle;
	}
	return (low + high) / 2;
}

/* About normal: the sum of twelve. */
static inline double light_noise(struct chance *chance)
{
	double sum = -6;

	for (int i = 0; i < 12; i++)
		sum += chance_real(chance, 0, 1);
	return sum;
}

static inline uint8_t light_code(const struct light_camera *camera, double linear,
				 struct chance *chance)
{
	const double seen = linear + camera->read_noise * light_noise(chance) +
			    camera->shot_noise * sqrt(fmin(fmax(linear, 0), 1)) *
				    light_noise(chance);
	const double e = light_shape_encode(camera->shape, seen);

	return (uint8_t)lrint(camera->black + (255 - camera->black) * e);
}

/* One exposure of patches of 16 x 16 px, logarithmic from 1 down to `range`, each channel in
 * another order. */
static inline void light_scene_take(const struct light_camera *camera, double time, double range,
				    struct chance *chance, struct image *picture)
{
	const int across = picture->width / 16, patches = across * (picture->height / 16);

	for (int y = 0; y < picture->height; y++) {
		for (int x = 0; x < picture->width; x++) {
			const int patch = y / 16 * across + x / 16;

			for (int c = 0; c < 3; c++) {
				const int place = (patch * (c ? 6 * c + 1 : 1) + 5 * c) % patches;
				const double l = pow(range, (double)place / patches);

				picture->u8[3 * (y * picture->width + x) + c] =
					light_code(camera, time * l, chance);
			}
		}
	}
}

#endif
