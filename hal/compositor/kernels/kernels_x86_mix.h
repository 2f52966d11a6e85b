/* SPDX-License-Identifier: MIT */
/*
 * mix() for SSE4.1 and AVX2; included after kernels_x86.h.
 *
 * pshufb looks up in a register of 16 bytes. So the 32 pieces of the encoding curve take two
 * registers for each byte of a, b and c.
 */

struct x86_tables {
	vector byte[6][2]; /* low and high byte of a, b, c; pieces 0-15 and 16-31 */
};

static inline void x86_tables_load(struct x86_tables *k, const struct kernel_curves *curves)
{
	for (int i = 0; i < 6; i++) {
		for (int half = 0; half < 2; half++)
			k->byte[i][half] = LANES(
				_mm_load_si128((const __m128i *)(curves->bytes[i] + 16 * half)));
	}
}

/* Looks up the words of two vectors of pieces. An index with its highest bit set gives 0, so each
 * piece is found in one half of the table and gives 0 in the other. */
KERNEL_INLINE void x86_looked_up(const struct x86_tables *k, int which, vector lower, vector upper,
				 vector word[2])
{
	const vector low = SIMD_BITS(or)(SIMD(shuffle_epi8)(k->byte[2 * which][0], lower),
					 SIMD(shuffle_epi8)(k->byte[2 * which][1], upper));
	const vector high = SIMD_BITS(or)(SIMD(shuffle_epi8)(k->byte[2 * which + 1][0], lower),
					  SIMD(shuffle_epi8)(k->byte[2 * which + 1][1], upper));

	word[0] = SIMD(unpacklo_epi8)(low, high);
	word[1] = SIMD(unpackhi_epi8)(low, high);
}

/* Encodes two vectors of keys to codes; all are words. */
KERNEL_INLINE void x86_encode(const struct x86_tables *k, vector key[2])
{
	const vector piece = SIMD(packus_epi16)(SIMD(srli_epi16)(key[0], 11),
						SIMD(srli_epi16)(key[1], 11));
	const vector lower = SIMD(add_epi8)(piece, SIMD(set1_epi8)(0x70));
	const vector upper = SIMD(sub_epi8)(piece, SIMD(set1_epi8)(16));
	vector a[2], b[2], c[2];

	x86_looked_up(k, 0, lower, upper, a);
	x86_looked_up(k, 1, lower, upper, b);
	x86_looked_up(k, 2, lower, upper, c);
	for (int i = 0; i < 2; i++) {
		const vector t = SIMD(srli_epi16)(SIMD(slli_epi16)(key[i], 5), 1);
		const vector slope = SIMD(add_epi16)(b[i], SIMD(mulhi_epi16)(c[i], t));

		key[i] = SIMD(srli_epi16)(SIMD(add_epi16)(a[i], SIMD(mulhi_epi16)(slope, t)), 8);
	}
}

KERNEL_INLINE vector_float x86_left_of(const uint16_t *coverage)
{
	const vector a = LOAD_WIDE16(coverage);
	const vector rest = SIMD(sub_epi32)(SIMD(sub_epi32)(SIMD(set1_epi32)(65536), a),
					    SIMD(srli_epi32)(a, 15));

	return SIMD(mul_ps)(SIMD(cvtepi32_ps)(rest), SIMD(set1_ps)(KERNEL_WHITE / 65535 / 65536));
}

/* Computes the keys of a channel, not yet clamped. */
KERNEL_INLINE vector x86_keys_of(const struct kernel_row *row, int c, int x, vector_float left,
				 const bool bare)
{
	const vector_float taken = SIMD(cvtepi32_ps)(LOAD(row->taken[c] + x));
	vector_float raised = SIMD(set1_ps)(KERNEL_BLACK), ratio, v;

	if (!bare)
		raised = SIMD(add_ps)(SIMD(mul_ps)(SIMD(cvtepi32_ps)(LOAD(row->object[c] + x)),
						   SIMD(set1_ps)(KERNEL_WHITE * 0x1p-24f)),
				      raised);
	ratio = SIMD(sub_ps)(SIMD(set1_ps)(1.0f), SIMD(mul_ps)(taken, SIMD(set1_ps)(0x1p-24f)));
	ratio = SIMD(min_ps)(SIMD(max_ps)(ratio, SIMD(setzero_ps)()), SIMD(set1_ps)(16.0f));
	v = SIMD(add_ps)(SIMD(mul_ps)(SIMD(mul_ps)(ratio, left), x86_linear_of(row, x, 2 - c)),
			 raised);
	return SIMD(sub_epi32)(SIMD(srai_epi32)(SIMD_BITS(castps)(v), 10),
			       SIMD(set1_epi32)(KERNEL_KEY_BASE));
}

/* Mixes 2 * DWORDS pixels. Packing to unsigned words clamps the keys to 0..65535. */
KERNEL_INLINE void x86_mix_two(const struct kernel_row *row, const struct x86_tables *k, int x,
			       const bool bare)
{
	const vector opaque = SIMD(set1_epi32)((int32_t)0xff000000);
	const vector pixels =
		LANES(_mm_setr_epi8(0, 4, 8, -1, 1, 5, 9, -1, 2, 6, 10, -1, 3, 7, 11, -1));
	vector bg[2], red[2], r[2];

	for (int i = 0; i < 2; i++) {
		const int at = x + i * DWORDS;
		const vector_float left = bare ? SIMD(set1_ps)(KERNEL_WHITE / 65535)
					       : x86_left_of(row->coverage + at);

		bg[i] = SIMD(packus_epi32)(x86_keys_of(row, 2, at, left, bare),
					   x86_keys_of(row, 1, at, left, bare));
		red[i] = x86_keys_of(row, 0, at, left, bare);
	}
	r[0] = r[1] = SIMD(packus_epi32)(red[0], red[1]);
	x86_encode(k, bg);
	x86_encode(k, r);
	for (int i = 0; i < 2; i++) {
		/* Each lane holds B B B B G G G G; reds holds R of both vectors. */
		const vector reds = i ? SIMD(unpackhi_epi64)(r[0], r[0]) : r[0];
		const vector bytes = SIMD(packus_epi16)(bg[i], reds);

		STORE(row->out + (size_t)(x + i * DWORDS) * 4,
		      SIMD_BITS(or)(SIMD(shuffle_epi8)(bytes, pixels), opaque));
	}
}

KERNEL_INLINE void x86_mix_row(const struct kernel_row *row, const struct x86_tables *k,
			       const bool bare)
{
	int x = 0;

	for (; x + 2 * DWORDS <= row->count; x += 2 * DWORDS)
		x86_mix_two(row, k, x, bare);
	if (x < row->count) {
		struct kernel_rest rest;
		struct kernel_row all;

		kernel_rest_load(&rest, &all, row, x);
		for (int i = 0; i < row->count - x; i += 2 * DWORDS)
			x86_mix_two(&all, k, i, bare);
		memcpy(row->out + (size_t)x * 4, rest.out, (size_t)(row->count - x) * 4);
	}
}

static void x86_mix(const struct kernel_row *rows)
{
	struct kernel_row row = *rows;
	struct x86_tables k;

	x86_tables_load(&k, row.curves);
	for (int y = 0; y < rows->rows; y++, kernel_row_next(&row))
		if (row.coverage)
			x86_mix_row(&row, &k, false);
		else
			x86_mix_row(&row, &k, true);
}
