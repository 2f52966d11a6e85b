#include "bake/encode_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Of |value - scale * row| in units of scale: half a step, and what float arithmetic adds to it
 * (hal/basis/README.md). */
#define STEP_ERROR 0.52

float values_peak(const float *value, int count)
{
	int32_t most = 0;
	float peak;

	for (int i = 0; i < count; i++) {
		int32_t bits; /* as integers, so that infinities and NaN come out on top */

		memcpy(&bits, &value[i], sizeof(bits));
		bits &= INT32_MAX;
		most = bits > most ? bits : most;
	}
	memcpy(&peak, &most, sizeof(peak));
	return peak;
}

bool values_any_negative(const float *value, int count)
{
	int any = 0;

	for (int i = 0; i < count; i++)
		any |= value[i] < 0;
	return any;
}

void values_raise_peaks(float *peak, const float *value, int count)
{
	for (int i = 0; i < count; i++) {
		const float magnitude = fabsf(value[i]);

		peak[i] = magnitude > peak[i] ? magnitude : peak[i];
	}
}

float values_mean_of_channels(float *mean, const float *value, int n)
{
	const float *r = value, *g = value + n, *b = value + 2 * (size_t)n;
	float spread = 0;

	for (int i = 0; i < n; i++) {
		/* Exactly theirs where all three are equal. */
		const float m = r[i] + ((g[i] - r[i]) + (b[i] - r[i])) * (1.0F / 3);
		const float dr = fabsf(r[i] - m), dg = fabsf(g[i] - m), db = fabsf(b[i] - m);
		const float rg = dr > dg ? dr : dg;
		const float d = rg > db ? rg : db;

		mean[i] = m;
		spread = d > spread ? d : spread;
	}
	return spread;
}

bool values_channels_equal(const float *value, int n)
{
	const size_t bytes = (size_t)n * sizeof(*value);

	return memcmp(value, value + n, bytes) == 0 &&
	       memcmp(value, value + 2 * (size_t)n, bytes) == 0;
}

double values_quantise(int16_t *row, float *scale, const float *value, int n)
{
	const float peak = values_peak(value, n);
	float inverse;

	*scale = peak / ENCODE_ROW_MAX;
	if (*scale < FLT_MIN) {
		*scale = 0;
		memset(row, 0, (size_t)n * sizeof(*row));
		return (double)peak;
	}
	inverse = 1 / *scale;
	for (int i = 0; i < n; i++) {
		const float x = value[i] * inverse;

		row[i] = (int16_t)(int)(x + copysignf(0.5F, x));
	}
	return STEP_ERROR * (double)*scale;
}
