#include "bake/encode_rest.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

/* Lights whose median is a row's first value. */
#define PROBES 31
/* Rounds in which lights may come back, and after which none leaves. */
#define ROUNDS_BOTH 3
#define ROUNDS_ALL 8
/* Sums that run side by side, for the compiler to make vectors of. */
#define LANES 16

int rest_create(struct rest *rest, int lights)
{
	const size_t n = (size_t)lights;

	*rest = (struct rest){.lights = lights};
	rest->value = calloc(TILE_PIXELS, sizeof(*rest->value));
	rest->shares = calloc(n, sizeof(*rest->shares));
	rest->weight = calloc(3 * n, sizeof(*rest->weight));
	rest->distance = calloc(n, sizeof(*rest->distance));
	if (!rest->value || !rest->shares || !rest->weight || !rest->distance) {
		rest_free(rest);
		return -ENOMEM;
	}
	return 0;
}

void rest_free(struct rest *rest)
{
	free(rest->value);
	free(rest->shares);
	free(rest->weight);
	free(rest->distance);
	*rest = (struct rest){0};
}

static float median_of_probes(const float *value, int lights)
{
	const int count = lights < PROBES ? lights : PROBES;
	float sorted[PROBES] = {0};

	for (int k = 0; k < count; k++) {
		const float v = value[(int64_t)k * lights / count];
		int at = k;

		for (; at && sorted[at - 1] > v; at--)
			sorted[at] = sorted[at - 1];
		sorted[at] = v;
	}
	return sorted[count / 2];
}

static float weighted_sum(const float *value, const float *weight, int count)
{
	float lane[LANES] = {0}, sum = 0;
	int i = 0;

	for (; i + LANES <= count; i += LANES) {
		for (int k = 0; k < LANES; k++)
			lane[k] += value[i + k] * weight[i + k];
	}
	for (; i < count; i++)
		sum += value[i] * weight[i];
	for (int k = 0; k < LANES; k++)
		sum += lane[k];
	return sum;
}

/* The weights of a mean over the lights that share; where the ground gets nothing of these, all
 * alike. */
static void set_weights(struct rest *rest, const double *ground)
{
	const int n = rest->lights;

	for (int c = 0; c < 3; c++, ground += n) {
		float *weight = rest->weight + (size_t)c * (size_t)n;
		double sum = 0;

		for (int i = 0; i < n; i++)
			sum += rest->shares[i] ? ground[i] : 0;
		for (int i = 0; i < n; i++) {
			const double share = sum > 0 ? ground[i] / sum : 1.0 / (n - rest->listed);

			weight[i] = rest->shares[i] ? (float)share : 0;
		}
	}
}

static void set_values(struct rest *rest, const struct encode_samples *s, const bool *keep,
		       bool first, bool merged)
{
	const size_t n = (size_t)rest->lights;

	for (int p = 0; p < s->pixels; p++) {
		float *r = rest->value[p];

		for (size_t c = 0; keep[p] && c < 3; c++) {
			const float *value = s->value + ((size_t)p * 3 + c) * n;

			r[c] = first ? median_of_probes(value, rest->lights)
				     : weighted_sum(value, rest->weight + c * n, rest->lights);
		}
		if (merged)
			r[0] = r[1] = r[2] = (r[0] + r[1] + r[2]) / 3;
	}
}

/* Each light's largest distance from the values of its rows. */
static void measure(struct rest *rest, const struct encode_samples *s, const bool *keep)
{
	const int n = rest->lights;
	float *distance = rest->distance;

	memset(distance, 0, (size_t)n * sizeof(*distance));
	for (int p = 0; p < s->pixels; p++) {
		const float *value = s->value + (size_t)p * 3 * (size_t)n;

		for (int c = 0; keep[p] && c < 3; c++, value += n) {
			const float r = rest->value[p][c];

			for (int i = 0; i < n; i++) {
				const float d = fabsf(value[i] - r);

				distance[i] = d > distance[i] ? d : distance[i];
			}
		}
	}
}

/* Who shares is chosen again; true when that changed. */
static bool choose(struct rest *rest, double cut, bool back)
{
	bool changed = false;

	rest->listed = 0;
	rest->error = 0;
	for (int i = 0; i < rest->lights; i++) {
		const double distance = (double)rest->distance[i];
		const bool shares = distance <= cut && (back || rest->shares[i]);

		changed |= shares != rest->shares[i];
		rest->shares[i] = shares;
		if (shares)
			rest->error = fmax(rest->error, distance);
		else
			rest->listed++;
	}
	return changed;
}

void rest_choose(struct rest *rest, const struct encode_samples *samples, const bool *keep,
		 const double *ground, double cut, bool merged)
{
	memset(rest->shares, 0, (size_t)rest->lights * sizeof(*rest->shares));
	set_values(rest, samples, keep, true, merged);
	measure(rest, samples, keep);
	choose(rest, cut, true);
	for (int round = 0; round < ROUNDS_ALL && rest->listed < rest->lights; round++) {
		set_weights(rest, ground);
		set_values(rest, samples, keep, false, merged);
		measure(rest, samples, keep);
		if (!choose(rest, cut, round < ROUNDS_BOTH))
			break;
	}
}
