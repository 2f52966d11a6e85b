/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>

void sensor_prepare(struct sensor *sensor, const struct sensor_settings *settings)
{
	const int black = settings->black_level;

	sensor->settings = *settings;
	for (int c = 0; c < 3; c++)
		sensor->gain[c] = 1;
	for (int i = 0; i < 65536; i++)
		sensor->encode[i] = (uint8_t)lrint(
			black + (255 - black) * transfer_encode(settings->transfer, i / 65535.0));
}

/* Hashes a counter into a random number (SplitMix64). */
static uint64_t noise_scramble(uint64_t z)
{
	z += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

/* Returns a nearly Gaussian number of mean 0 and variance 1: the sum of four 16-bit uniforms. */
static float noise_gauss(uint64_t counter)
{
	const uint64_t z = noise_scramble(counter);
	const int sum = (int)(z & 0xffff) + (int)(z >> 16 & 0xffff) + (int)(z >> 32 & 0xffff) +
			(int)(z >> 48);

	return (float)(sum - 131070) * (1 / 37837.2f);
}

static uint8_t sensor_code(const struct sensor *sensor, float v)
{
	if (!(v > 0))
		return sensor->encode[0];
	return sensor->encode[v < 1 ? (int)(v * 65535 + 0.5f) : 65535];
}

static void expose_noisy(const struct sensor *sensor, uint64_t frame, const float *rgb,
			 size_t count, uint8_t *bgrx)
{
	const float exposure = (float)sensor->settings.exposure;
	const float read = (float)(sensor->settings.read_noise / 255);
	const float shot = (float)(sensor->settings.shot_noise / 255);
	const uint64_t key = noise_scramble((uint64_t)(int64_t)sensor->settings.seed ^ frame << 32);

	for (size_t i = 0; i < 3 * count; i++) {
		const float v = exposure * sensor->gain[i % 3] * rgb[i];
		const float deviation = sqrtf(read * read + shot * shot * fabsf(v));

		bgrx[4 * (i / 3) + 2 - i % 3] = sensor_code(sensor,
							    v + deviation * noise_gauss(key + i));
	}
}

void sensor_expose(const struct sensor *sensor, uint64_t frame, const float *rgb, size_t count,
		   uint8_t *bgrx)
{
	const float exposure = (float)sensor->settings.exposure;

	for (size_t i = 0; i < count; i++)
		bgrx[4 * i + 3] = 255;
	if (sensor->settings.read_noise > 0 || sensor->settings.shot_noise > 0) {
		expose_noisy(sensor, frame, rgb, count, bgrx);
		return;
	}
	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			bgrx[4 * i + 2 - (size_t)c] = sensor_code(
				sensor, exposure * sensor->gain[c] * rgb[3 * i + (size_t)c]);
}

/* Y'CbCr from code values (ITU-R BT.601-7 2.5, BT.709-6 3). */
struct luma {
	float kr, kg, kb;
	float y_scale, y_offset, b_scale, r_scale; /* of Y', Y', B' - Y' and R' - Y' */
};

static struct luma sensor_luma(enum colour_matrix matrix, enum colour_range range)
{
	const float kr = matrix == MATRIX_BT709 ? 0.2126f : 0.299f;
	const float kb = matrix == MATRIX_BT709 ? 0.0722f : 0.114f;
	const float chroma = range == RANGE_FULL ? 1 : 224 / 255.f;

	return (struct luma){
		.kr = kr,
		.kg = 1 - kr - kb,
		.kb = kb,
		.y_scale = range == RANGE_FULL ? 1 : 219 / 255.f,
		.y_offset = range == RANGE_FULL ? 0 : 16,
		.b_scale = chroma / (2 * (1 - kb)),
		.r_scale = chroma / (2 * (1 - kr)),
	};
}

static uint8_t clamp_to_byte(float v)
{
	return (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : (int)(v + 0.5f));
}

void sensor_pack_yuyv(const uint8_t *bgrx, size_t pixels, enum colour_matrix matrix,
		      enum colour_range range, uint8_t *yuyv)
{
	const struct luma k = sensor_luma(matrix, range);

	for (size_t i = 0; i + 1 < pixels; i += 2, bgrx += 8, yuyv += 4) {
		const float b[2] = {bgrx[0], bgrx[4]}, g[2] = {bgrx[1], bgrx[5]};
		const float r[2] = {bgrx[2], bgrx[6]};
		const float y0 = k.kr * r[0] + k.kg * g[0] + k.kb * b[0];
		const float y1 = k.kr * r[1] + k.kg * g[1] + k.kb * b[1];

		yuyv[0] = clamp_to_byte(k.y_offset + k.y_scale * y0);
		yuyv[1] = clamp_to_byte(128 + k.b_scale * (b[0] + b[1] - y0 - y1) / 2);
		yuyv[2] = clamp_to_byte(k.y_offset + k.y_scale * y1);
		yuyv[3] = clamp_to_byte(128 + k.r_scale * (r[0] + r[1] - y0 - y1) / 2);
	}
}

#define DEPTH_EDGE 0.1f

static bool is_edge(const float *z, int width, int height, int x, int y)
{
	const float here = z[y * width + x];

	for (int n = 0; n < 4; n++) {
		const int u = x + (n == 0) - (n == 1), v = y + (n == 2) - (n == 3);

		if (u >= 0 && v >= 0 && u < width && v < height &&
		    fabsf(z[v * width + u] - here) > DEPTH_EDGE * here)
			return true;
	}
	return false;
}

void sensor_measure(const struct sensor_depth *sensor, uint64_t frame, const float *z, int width,
		    int height, uint8_t *words)
{
	const uint64_t key = noise_scramble((uint64_t)(int64_t)sensor->seed ^ frame << 32);

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const int k = y * width + x;
			const double m = (double)z[k];
			const double gauss = (double)noise_gauss(key + (uint64_t)k);
			const double mm = 1000 * m + sensor->noise_mm * m * m * gauss;
			const bool known = m > 0 && mm >= 1 && mm < 65535 &&
					   !is_edge(z, width, height, x, y);
			const int word = known ? (int)(mm + 0.5) : 0;

			words[2 * k] = (uint8_t)word;
			words[2 * k + 1] = (uint8_t)(word >> 8);
		}
}
