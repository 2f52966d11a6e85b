#include "hal/compositor/weights.h"

#include <errno.h>
#include <stdlib.h>

/* Fraction bits of weights, unless the light is so strong that they would exceed 2^46. */
#define OBJECT_BITS 20
#define RECEIVER_BITS 34
/* Of shares, which sum to at most 1; and of the ambient one, whose product with a total is large.
 */
#define SHARE_BITS 34
#define AMBIENT_SHARE_BITS 30
#define TOTAL_BITS 15 /* of the totals of V rows */

/* e of compositor.h: 2^-20 of the sum of u. */
#define RESIDUE_BITS 20

int weights_create(struct weights *weights, int lights)
{
	*weights = (struct weights){0};
	for (int d = 0; d < WEIGHT_DIGITS; d++) {
		weights->digit[d] = calloc((size_t)lights, sizeof(**weights->digit));
		if (!weights->digit[d]) {
			weights_free(weights);
			return -ENOMEM;
		}
	}
	return 0;
}

void weights_free(struct weights *weights)
{
	for (int d = 0; d < WEIGHT_DIGITS; d++)
		free(weights->digit[d]);
	*weights = (struct weights){0};
}

/* weight in 0..2^47 - 2^35. */
static void split(int64_t weight, int16_t digit[WEIGHT_DIGITS])
{
	const int64_t half = 1 << (WEIGHT_DIGIT_BITS - 1);

	for (int d = 0; d < WEIGHT_DIGITS; d++) {
		digit[d] = (int16_t)(((weight + half) & (2 * half - 1)) - half);
		weight = (weight - digit[d]) >> WEIGHT_DIGIT_BITS;
	}
}

static void clear(struct weights *weights)
{
	weights->digits = 0;
	weights->sum = 0;
}

/* value >= 0, at most 2^47 - 2^35. */
static void put(struct weights *weights, int light, double value)
{
	const int64_t weight = (int64_t)(value + 0.5);
	int16_t digit[WEIGHT_DIGITS];

	split(weight, digit);
	for (int d = 0; d < WEIGHT_DIGITS; d++) {
		weights->digit[d][light] = digit[d];
		if (digit[d] && d >= weights->digits)
			weights->digits = d + 1;
	}
	weights->sum += weight;
}

/* How many fraction bits keep sum (L_i + ambient) below 2^46. */
static int fraction_bits(const struct light_selection *lights, int channel, int most)
{
	double sum = lights->count * lights->ambient[channel];
	int bits;

	for (int i = 0; i < lights->count; i++)
		sum += lights->radiance[i][channel];
	if (!(sum > 0))
		return most;
	bits = 45 - ilogb(sum);
	return bits < most ? bits : most;
}

static void put_radiance(struct weights *weights, const struct light_selection *lights, int channel,
			 int bits)
{
	const double one = ldexp(1, bits);

	clear(weights);
	for (int i = 0; i < lights->count; i++)
		put(weights, i, lights->radiance[i][channel] * one);
	weights->ambient = (int64_t)(lights->ambient[channel] * one + 0.5);
	weights->ambient_shift = 0;
}

void weights_object(struct weights *weights, const struct light_selection *lights, int channel,
		    double gain)
{
	const int bits = fraction_bits(lights, channel, OBJECT_BITS);

	put_radiance(weights, lights, channel, bits);
	weights->unit = multiplier_from_double(ldexp(gain * 65535, -bits));
}

void weights_receiver(struct weights *weights, const struct light_selection *lights, int channel)
{
	const int bits = fraction_bits(lights, channel, RECEIVER_BITS);

	put_radiance(weights, lights, channel, bits);
	weights->residue = bits >= RESIDUE_BITS ? INT64_C(1) << (bits - RESIDUE_BITS) : 1;
	weights->residue_shift = bits >= RESIDUE_BITS ? 0 : RESIDUE_BITS - bits;
	if (weights->residue_shift > 62) {
		weights->residue = 0;
		weights->residue_shift = 0;
	}
}

void weights_ground(struct weights *weights, const struct light_selection *lights, int channel,
		    const double *u)
{
	const double one = ldexp(1, SHARE_BITS), ambient = lights->ambient[channel];
	double lit = 0, all = 0;

	for (int i = 0; i < lights->count; i++) {
		lit += u[i] * lights->radiance[i][channel];
		all += u[i];
	}
	lit += all * ambient + ldexp(all, -RESIDUE_BITS);
	if (!(lit > 0))
		lit = 1; /* no light can reach this ground: all shares are 0 */
	clear(weights);
	for (int i = 0; i < lights->count; i++)
		put(weights, i, u[i] * lights->radiance[i][channel] / lit * one);
	weights->ambient = (int64_t)(ldexp(all * ambient / lit, AMBIENT_SHARE_BITS) + 0.5);
	weights->ambient_shift = TOTAL_BITS + AMBIENT_SHARE_BITS - SHARE_BITS;
	weights->unit = multiplier_from_double(ldexp(Q16_ONE, -SHARE_BITS));
}

int segments_create(struct segments *segments, int lights)
{
	const size_t runs = ((size_t)lights + BASIS_ROW_STEP - 1) / BASIS_ROW_STEP;
	const size_t most = runs * WEIGHT_DIGITS / 2;

	*segments = (struct segments){0};
	segments->start = calloc(most, sizeof(*segments->start));
	segments->weight = aligned_alloc(BASIS_ALIGN,
					 most * SEGMENT_WEIGHTS * sizeof(*segments->weight));
	if (!segments->start || !segments->weight) {
		segments_free(segments);
		return -ENOMEM;
	}
	return 0;
}

void segments_free(struct segments *segments)
{
	free(segments->start);
	free(segments->weight);
	*segments = (struct segments){0};
}

/* What a block gathers from. */
struct gathering {
	const struct weights *weights;
	const struct basis_block *block;
	int listed;		     /* lights, the rest not among them */
	int16_t rest[WEIGHT_DIGITS]; /* zeros where there is none */
};

/* Digit d of a run, zeros after its end; false when all of it is 0. */
static bool gather_run(int16_t *to, const struct gathering *g, int d, int start)
{
	const int16_t *digit = g->weights->digit[d];
	const uint16_t *light = g->block->light + start;
	const int left = g->listed - start;
	const int count = left < BASIS_ROW_STEP ? left : BASIS_ROW_STEP;
	int16_t any = 0;

	for (int i = 0; i < count; i++) {
		to[i] = digit[light[i]];
		any |= to[i];
	}
	for (int i = count; i < BASIS_ROW_STEP; i++)
		to[i] = 0;
	if (left < BASIS_ROW_STEP) {
		to[left] = g->rest[d];
		any |= to[left];
	}
	return any != 0;
}

/* The segments of digits d and d + 1, put after the first `count`; how many there are then. */
static int gather_pair(struct segments *segments, int count, const struct gathering *g, int d)
{
	for (int start = 0; start < g->block->lights; start += BASIS_ROW_STEP) {
		int16_t *to = segments->weight + (size_t)count * SEGMENT_WEIGHTS;
		const bool first = gather_run(to, g, d, start);
		const bool second = gather_run(to + BASIS_ROW_STEP, g, d + 1, start);

		if (first || second)
			segments->start[count++] = (uint32_t)start;
	}
	return count;
}

static int64_t weight_of_rest(const struct weights *weights, const uint16_t *light, int listed)
{
	int64_t weight = weights->sum;

	for (int i = 0; i < listed; i++) {
		for (int d = 0; d < weights->digits; d++)
			weight -= weights->digit[d][light[i]] *
				  (INT64_C(1) << d * WEIGHT_DIGIT_BITS);
	}
	return weight;
}

void segments_gather(struct segments *segments, const struct weights *weights,
		     const struct basis_block *block)
{
	struct gathering g = {weights, block, block->lights - block->rest, {0}};

	if (block->rest)
		split(weight_of_rest(weights, block->light, g.listed), g.rest);
	segments->low = gather_pair(segments, 0, &g, 0);
	segments->high = 0;
	if (weights->digits > 2 || g.rest[2] || g.rest[3])
		segments->high = gather_pair(segments, segments->low, &g, 2) - segments->low;
}
