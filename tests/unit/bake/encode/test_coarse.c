/* SPDX-License-Identifier: MIT */
/* The lights of a dome gathered in those of a coarser dome. */
#include <math.h>

#include "tests/support/bake/encode_rig.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

TEST("over coarse")
{
	static const int fine[] = {2, 5, 9, 12, 20, 36}, coarse[] = {1, 2, 3, 4, 9};

	for (size_t a = 0; a < 6; a++)
		for (size_t b = 0; b < 5; b++) {
			struct encode_rig e, few;

			if (coarse[b] >= fine[a])
				continue;
			e = encode_rig_dome(fine[a], coarse[b]);
			few = encode_rig_dome(coarse[b], coarse[b]);
			for (int i = 0; i < e.settings.lights; i++) {
				const struct basis_coarse *g = &e.gather[i];
				double mean[3] = {0, 0, 0};
				int sum = 0;

				for (int k = 0; k < 3; k++) {
					expect_below(g->index[k], e.settings.coarse,
						     "a=%zu, b=%zu, i=%d, k=%d", a, b, i, k);
					expect_that(!k || !g->weight[k] ||
							    (g->weight[k - 1] &&
							     g->index[k] > g->index[k - 1]),
						    "a=%zu, b=%zu, i=%d, k=%d", a, b, i, k);
					expect_that(g->weight[k] || !g->index[k],
						    "a=%zu, b=%zu, i=%d, k=%d", a, b, i, k);
					sum += g->weight[k];
					for (int x = 0; x < 3; x++)
						mean[x] += g->weight[k] *
							   few.light[g->index[k]].direction[x];
				}
				expect_equal(sum, BASIS_COARSE_ONE, "a=%zu, b=%zu, i=%d", a, b, i);
				/* inside the triangles, the weighted mean lies in the light's
				 * direction */
				if (e.light[i].direction[2] > 1.0 / coarse[b])
					expect_above(encode_rig_dot(mean, e.light[i].direction),
						     (1 - 1e-7) * sqrt(encode_rig_dot(mean, mean)),
						     "a=%zu, b=%zu, i=%d", a, b, i);
			}
			encode_rig_end(&e);
			encode_rig_end(&few);
		}
}
