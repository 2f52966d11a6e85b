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

/* value >= 0, at most 2^47 - 2^35. */
static void put(struct weights *weights, int light, double value)
{
	const int64_t half = 1 << (WEIGHT_DIGIT_BITS - 1);
	int64_t rest = (int64_t)(value + 0.5);

	for (int d = 0; d < WEIGHT_DIGITS; d++) {
		const int64_t digit = ((rest + half) & (2 * half - 1)) - half;

		weights->digit[d][light] = (int16_t)digit;
		rest = (rest - digit) >> WEIGHT_DIGIT_BITS;
		if (digit && d >= weights->digits)
			weights->digits = d + 1;
	}
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

	weights->digits = 0;
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
	weights->digits = 0;
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

/* One digit of a run, zeros after its end; false when all of it is 0. */
static bool gather_run(int16_t *to, const int16_t *digit, const uint16_t *light, int count)
{
	int16_t any = 0;

	for (int i = 0; i < count; i++) {
		to[i] = digit[light[i]];
		any |= to[i];
	}
	for (int i = count; i < BASIS_ROW_STEP; i++)
		to[i] = 0;
	return any != 0;
}

/* The segments of two digits, put after the first `count`; how many there are then. */
static int gather_pair(struct segments *segments, int count, const int16_t *const digit[2],
		       const struct basis_block *block)
{
	for (int start = 0; start < block->lights; start += BASIS_ROW_STEP) {
		int16_t *to = segments->weight + (size_t)count * SEGMENT_WEIGHTS;
		const int rest = block->lights - start;
		const int n = rest < BASIS_ROW_STEP ? rest : BASIS_ROW_STEP;
		const bool first = gather_run(to, digit[0], block->light + start, n);
		const bool second = gather_run(to + BASIS_ROW_STEP, digit[1], block->light + start,
					       n);

		if (first || second)
			segments->start[count++] = (uint32_t)start;
	}
	return count;
}

void segments_gather(struct segments *segments, const struct weights *weights,
		     const struct basis_block *block)
{
	const int16_t *const low[2] = {weights->digit[0], weights->digit[1]};
	const int16_t *const high[2] = {weights->digit[2], weights->digit[3]};

	segments->low = gather_pair(segments, 0, low, block);
	segments->high = 0;
	if (weights->digits > 2)
		segments->high = gather_pair(segments, segments->low, high, block) - segments->low;
}
