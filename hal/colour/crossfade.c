/* SPDX-License-Identifier: MIT */
#include "hal/colour/crossfade.h"

void crossfade_init(struct crossfade *fade)
{
	fade->share = -1;
}

/* The wanted light ascends with b, so the search goes on where it ended for the b before. */
static void fill_mixed(struct crossfade *f, int a)
{
	int code = 0;

	for (int b = 0; b < 256; b++) {
		const double wanted = (1 - f->share) * f->linear[a] + f->share * f->linear[b];

		while (code < 255 && f->linear[code + 1] - wanted <= wanted - f->linear[code])
			code++;
		f->mixed[a][b] = (uint8_t)(a == b ? a : code);
	}
}

void crossfade_set(struct crossfade *fade, const struct transfer_curve *curve, double share)
{
	const bool same = fade->share >= 0 && transfer_curve_same(&fade->curve, curve);

	if (!same) {
		fade->curve = *curve;
		for (int code = 0; code < 256; code++)
			fade->linear[code] = transfer_curve_decode(curve, code / 255.0);
	}
	if (same && fade->share == share)
		return;
	fade->share = share;
	for (int a = 0; a < 256; a++)
		fill_mixed(fade, a);
}

void crossfade_row(const struct crossfade *fade, const uint8_t *first, const uint8_t *second,
		   int bytes, uint8_t *out)
{
	for (int i = 0; i < bytes; i++)
		out[i] = fade->mixed[first[i]][second[i]];
}
