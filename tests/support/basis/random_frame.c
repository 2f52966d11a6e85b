/* SPDX-License-Identifier: MIT */
#include "tests/support/basis/random_frame.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

void random_frame_begin(struct random_frame *f, const struct basis *basis, struct pool *pool,
			struct chance *chance)
{
	const struct compositor_options options = {.pool = pool};
	const int w = (int)basis->info.width, h = (int)basis->info.height;
	float(*radiance)[3] = calloc(basis->info.lights, sizeof(*radiance));

	f->stride = (size_t)w * 4 + 4; /* one pixel more, which the compositor must not write */
	f->bytes = f->stride * (size_t)h;
	f->background = malloc(f->bytes);
	f->out = malloc(f->bytes);
	assert_true(radiance && f->background && f->out);
	for (size_t i = 0; i < f->bytes; i++)
		f->background[i] = (uint8_t)chance_bits(chance);
	memset(f->out, 0x5a, f->bytes);
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)chance_real(chance, 0, 1);
	f->picture = (struct picture){f->background, 4, (ptrdiff_t)f->stride, w, h};
	f->backdrop = backdrop_of(&f->picture);
	assert_int_equal(light_selection_create(&f->lights, basis), 0);
	light_selection_choose(&f->lights, basis, 0, (const float(*)[3])radiance, 0.3,
			       THRESHOLD_AMBIENT, 1);
	assert_int_equal(compositor_create(&f->compositor, basis, &options, NULL), 0);
	free(radiance);
}

void random_frame_end(struct random_frame *f)
{
	compositor_destroy(f->compositor);
	light_selection_free(&f->lights);
	free(f->background);
	free(f->out);
}

void random_frame_run(struct random_frame *f, int pose)
{
	assert_int_equal(
		compositor_run(f->compositor, pose, &f->lights, &f->backdrop, f->out, f->stride),
		0);
}
