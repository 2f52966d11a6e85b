/* Runs of values and what the encoder does with each: loops that compilers turn into vectors.
 * Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_VALUES_H
#define INLAY_BAKE_ENCODE_VALUES_H

#include <stdbool.h>
#include <stdint.h>

#define ENCODE_ROW_MAX 32767

/* The largest |value|; NaN above infinity above all numbers. */
float values_peak(const float *value, int count);

bool values_any_negative(const float *value, int count);

/* peak[i] = max(peak[i], |value[i]|) */
void values_raise_peaks(float *peak, const float *value, int count);

/* value: [3][n]. Fills mean[n]; returns the largest distance of a channel from it. */
float values_mean_of_channels(float *mean, const float *value, int n);

/* value: [3][n]. */
bool values_channels_equal(const float *value, int n);

/* value[i] is about scale * row[i], |row[i]| <= ENCODE_ROW_MAX; a bound of the error is returned. A
 * row too faint for a normal float as its scale becomes zeros. */
double values_quantise(int16_t *row, float *scale, const float *value, int n);

#endif
