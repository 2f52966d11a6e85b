#include "hal/compositor/kernels.h"

/* Compilers make multiply-and-add-pairs instructions of this (pmaddwd); the sum fits because
 * 32 * 32767 * 2048 < 2^31. */
static inline int32_t dot(const int16_t *row, const int16_t *weight)
{
	int32_t sum = 0;

	for (int i = 0; i < BASIS_ROW_STEP; i++)
		sum += row[i] * weight[i];
	return sum;
}

/* Unsigned, because parts of the sum may pass 2^63 and come back: the whole is exact. */
static int64_t row_sum(const int16_t *row, const struct segments *segments)
{
	const int16_t *weight = segments->weight;
	uint64_t sum = 0;

	for (int s = 0; s < segments->count; s++, weight += BASIS_ROW_STEP)
		sum += (uint64_t)(int64_t)dot(row + segments->start[s], weight)
		       << segments->shift[s];
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
