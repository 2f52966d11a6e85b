/* SPDX-License-Identifier: MIT */
/*
 * mix for SSE4.1 and AVX2; part of kernels_x86.h.
 *
 * Tables of bytes can be looked up 16 at a time from a register, so the encoding's 32 pieces are
 * two registers for each byte of a, b and c.
 */

struct tables {
	vector byte[6][2]; /* low and high byte of a, b, c; pieces 0-15 and 16-31 */
};

static inline void tables_load(struct tables *k, const struct kernel_curves *curves)
{
	for (int i = 0; i < 6; i++) {
		for (int half = 0; half < 2; half++)
			k->byte[i][half] = LANES(
				_mm_load_si128((const __m128i *)(curves->bytes[i] + 16 * half)));
	}
}

/* Of two vectors of pieces: a byte whose highest bit is set gives 0, so what the lower 16 do not
 * have the upper ones do. */
KERNEL_INLINE void looked_up(const struct tables *k, int which, vector lower, vector upper,
			     vector word[2])
{
	const vector low = SI(or)(I(shuffle_epi8)(k->byte[2 * which][0], lower),
				  I(shuffle_epi8)(k->byte[2 * which][1], upper));
	const vector high = SI(or)(I(shuffle_epi8)(k->byte[2 * which + 1][0], lower),
				   I(shuffle_epi8)(k->byte[2 * which + 1][1], upper));

	word[0] = I(unpacklo_epi8)(low, high);
	word[1] = I(unpackhi_epi8)(low, high);
}

/* Two vectors of keys, as words, to codes, as words. */
KERNEL_INLINE void encode(const struct tables *k, vector key[2])
{
	const vector piece = I(packus_epi16)(I(srli_epi16)(key[0], 11), I(srli_epi16)(key[1], 11));
	const vector lower = I(add_epi8)(piece, I(set1_epi8)(0x70));
	const vector upper = I(sub_epi8)(piece, I(set1_epi8)(16));
	vector a[2], b[2], c[2];

	looked_up(k, 0, lower, upper, a);
	looked_up(k, 1, lower, upper, b);
	looked_up(k, 2, lower, upper, c);
	for (int i = 0; i < 2; i++) {
		const vector t = I(srli_epi16)(I(slli_epi16)(key[i], 5), 1);
		const vector slope = I(add_epi16)(b[i], I(mulhi_epi16)(c[i], t));

		key[i] = I(srli_epi16)(I(add_epi16)(a[i], I(mulhi_epi16)(slope, t)), 8);
	}
}

KERNEL_INLINE vector_float left_of(const uint16_t *coverage)
{
	const vector a = LOAD_WIDE16(coverage);
	const vector rest = I(sub_epi32)(I(sub_epi32)(I(set1_epi32)(65536), a),
					 I(srli_epi32)(a, 15));

	return F(mul_ps)(F(cvtepi32_ps)(rest), F(set1_ps)(KERNEL_WHITE / 65535 / 65536));
}

/* Keys of a channel, not yet clamped. */
KERNEL_INLINE vector keys_of(const struct kernel_row *row, int c, int x, vector_float left)
{
	const vector_float object = F(cvtepi32_ps)(LOAD(row->object[c] + x));
	const vector_float taken = F(cvtepi32_ps)(LOAD(row->taken[c] + x));
	const vector_float raised = F(add_ps)(
		F(mul_ps)(object, F(set1_ps)(KERNEL_WHITE * 0x1p-24f)), F(set1_ps)(KERNEL_BLACK));
	vector_float ratio = F(sub_ps)(F(set1_ps)(1.0f), F(mul_ps)(taken, F(set1_ps)(0x1p-24f)));
	vector_float v;

	ratio = F(min_ps)(F(max_ps)(ratio, F(setzero_ps)()), F(set1_ps)(16.0f));
	v = F(add_ps)(F(mul_ps)(F(mul_ps)(ratio, left), linear_of(row, x, 2 - c)), raised);
	return I(sub_epi32)(I(srai_epi32)(SI(castps)(v), 10), I(set1_epi32)(KERNEL_KEY_BASE));
}

/* 2 * DWORDS pixels. Packing to words without signs clamps the keys to 0..65535. */
KERNEL_INLINE void mix_two(const struct kernel_row *row, const struct tables *k, int x)
{
	const vector opaque = I(set1_epi32)((int32_t)0xff000000);
	const vector pixels =
		LANES(_mm_setr_epi8(0, 4, 8, -1, 1, 5, 9, -1, 2, 6, 10, -1, 3, 7, 11, -1));
	vector bg[2], red[2], r[2];

	for (int i = 0; i < 2; i++) {
		const int at = x + i * DWORDS;
		const vector_float left = left_of(row->coverage + at);

		bg[i] = I(packus_epi32)(keys_of(row, 2, at, left), keys_of(row, 1, at, left));
		red[i] = keys_of(row, 0, at, left);
	}
	r[0] = r[1] = I(packus_epi32)(red[0], red[1]);
	encode(k, bg);
	encode(k, r);
	for (int i = 0; i < 2; i++) {
		/* Of each lane B B B B G G G G, and R of both vectors. */
		const vector reds = i ? I(unpackhi_epi64)(r[0], r[0]) : r[0];
		const vector bytes = I(packus_epi16)(bg[i], reds);

		STORE(row->out + (size_t)(x + i * DWORDS) * 4,
		      SI(or)(I(shuffle_epi8)(bytes, pixels), opaque));
	}
}

KERNEL_INLINE void mix_row(const struct kernel_row *row, const struct tables *k)
{
	int x = 0;

	for (; x + 2 * DWORDS <= row->count; x += 2 * DWORDS)
		mix_two(row, k, x);
	if (x < row->count) {
		struct kernel_rest rest;
		struct kernel_row all;

		kernel_rest_load(&rest, &all, row, x);
		for (int i = 0; i < row->count - x; i += 2 * DWORDS)
			mix_two(&all, k, i);
		memcpy(row->out + (size_t)x * 4, rest.out, (size_t)(row->count - x) * 4);
	}
}

static void mix(const struct kernel_row *rows)
{
	struct kernel_row row = *rows;
	struct tables k;

	tables_load(&k, row.curves);
	for (int y = 0; y < rows->rows; y++, kernel_row_next(&row))
		mix_row(&row, &k);
}
