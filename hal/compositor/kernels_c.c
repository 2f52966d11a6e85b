#include "hal/compositor/kernels.h"

/*
 * A row times the two digits of some segments, each digit summed apart.
 *
 * Compilers make multiply-and-add-pairs instructions (pmaddwd) of the inner loop. Its sums fit
 * because 32 * 32767 * 2048 < 2^31.
 */
static void digit_sums(const int16_t *row, const uint32_t *start, const int16_t *weight, int count,
		       int64_t digit[2])
{
	int64_t first = 0, second = 0;

	for (int s = 0; s < count; s++, weight += SEGMENT_WEIGHTS) {
		const int16_t *r = __builtin_assume_aligned(row + start[s], BASIS_ALIGN);
		const int16_t *w = __builtin_assume_aligned(weight, BASIS_ALIGN);
		int32_t a = 0, b = 0;

		for (int i = 0; i < BASIS_ROW_STEP; i++) {
			a += r[i] * w[i];
			b += r[i] * w[i + BASIS_ROW_STEP];
		}
		first += a;
		second += b;
	}
	digit[0] = first;
	digit[1] = second;
}

/* Unsigned, because parts may pass 2^63 and come back: the whole does not, and is exact. */
static int64_t row_sum(const int16_t *row, const struct segments *s)
{
	int64_t digit[2];
	uint64_t sum;

	digit_sums(row, s->start, s->weight, s->low, digit);
	sum = (uint64_t)digit[0] + ((uint64_t)digit[1] << WEIGHT_DIGIT_BITS);
	if (s->high) {
		digit_sums(row, s->start + s->low, s->weight + (size_t)s->low * SEGMENT_WEIGHTS,
			   s->high, digit);
		sum += (uint64_t)digit[0] << (2 * WEIGHT_DIGIT_BITS);
		sum += (uint64_t)digit[1] << (3 * WEIGHT_DIGIT_BITS);
	}
	return (int64_t)sum;
}

void kernel_sums_c(const struct basis_block *block, const struct segments segments[3],
		   int64_t (*sum)[3])
{
	const size_t next = block->channels == 3 ? (size_t)block->stride : 0;
	const int16_t *row = block->row;

	for (int p = 0; p < block->pixels; p++) {
		for (int c = 0; c < 3; c++)
			sum[p][c] = row_sum(row + (size_t)c * next, &segments[c]);
		row += (size_t)block->channels * (size_t)block->stride;
	}
}
