/* SPDX-License-Identifier: MIT */
/*
 * A simulated sensor: converts linear light to the code values of a camera.
 *
 *     v    = exposure * gain * radiance + noise   clipped to 0..1
 *     code = black + (255 - black) * transfer(v)  rounded
 *
 * The noise is Gaussian, with a standard deviation of
 *
 *     sigma = sqrt(read^2 + shot^2 * exposure * gain * radiance)
 *
 * read and shot are given in 8-bit levels of linear light. The same seed and frame give the same
 * noise.
 */
#ifndef INLAY_DRIVERS_SIM_SENSOR_H
#define INLAY_DRIVERS_SIM_SENSOR_H

#include "hal/frame/frame.h"

struct sensor_settings {
	double exposure;
	enum transfer transfer;
	int black_level;
	double read_noise, shot_noise;
	int seed;
};

struct sensor {
	struct sensor_settings settings;
	float gain[3];	       /* of R, G, B; 1 until it is set */
	uint8_t encode[65536]; /* code value of i / 65535 of linear light */
};

void sensor_prepare(struct sensor *sensor, const struct sensor_settings *settings);

/* Converts a frame of linear light, rgb[count][3], to BGRX. frame selects the noise. */
void sensor_expose(const struct sensor *sensor, uint64_t frame, const float *rgb, size_t count,
		   uint8_t *bgrx);

/* Converts BGRX to YUYV; chroma is the mean of each pair of pixels. Neither has padding; the width
 * is even. */
void sensor_pack_yuyv(const uint8_t *bgrx, size_t pixels, enum colour_matrix matrix,
		      enum colour_range range, uint8_t *yuyv);

/*
 * A depth camera that triangulates: depths z in m become mm,
 *
 *     measured = z + noise z^2 gauss    rounded; noise: the standard deviation in mm at 1 m
 *
 * 0, not known: where z is 0 or beyond 65.534 m, and where a neighbour is nearer or farther by a
 * tenth, because at edges one of the two eyes sees something else.
 */
struct sensor_depth {
	double noise_mm;
	int seed;
};

/* Measures z[height][width] as words[height][width] of PIXEL_Z16; frame selects the noise. */
void sensor_measure(const struct sensor_depth *sensor, uint64_t frame, const float *z, int width,
		    int height, uint8_t *words);

#endif
