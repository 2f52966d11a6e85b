/* SPDX-License-Identifier: MIT */
/* Frames that start from the sums of the frame before are the same, bit for bit, as frames that
 * start anew. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"

/* Two compositors over the same lights; `fresh` never reuses sums. */
struct pair {
	struct random_frame f;
	struct compositor *fresh;
	uint8_t *out;
	float (*radiance)[3];
	int reused;
};

static void pair_begin(struct pair *p, const struct basis *basis, struct pool *pool,
		       struct chance *chance)
{
	const struct compositor_options options = {.kernel = NULL};

	*p = (struct pair){.reused = 0};
	random_frame_begin(&p->f, basis, pool, chance);
	p->out = malloc(p->f.bytes);
	p->radiance = calloc(basis->info.lights, sizeof(*p->radiance));
	assert_true(p->out && p->radiance);
	memset(p->out, 0x5a, p->f.bytes);
	assert_int_equal(compositor_create(&p->fresh, basis, &options, NULL), 0);
}

static void pair_end(struct pair *p)
{
	compositor_destroy(p->fresh);
	free(p->out);
	free(p->radiance);
	random_frame_end(&p->f);
}

static void pair_set(struct pair *p, struct compositor_settings settings)
{
	compositor_set(p->f.compositor, &settings);
	settings.reuse = REUSE_NEVER;
	compositor_set(p->fresh, &settings);
}

static void pair_reuse(struct pair *p, const struct basis *basis, int pose, double threshold,
		       enum threshold_mode mode)
{
	light_selection_choose(&p->f.lights, basis, pose, (const float(*)[3])p->radiance, threshold,
			       mode, 1);
	random_frame_run(&p->f, pose);
	p->reused += compositor_last(p->f.compositor).reused;
}

static void pair_compare(struct pair *p, int pose)
{
	assert_int_equal(
		compositor_run(p->fresh, pose, &p->f.lights, &p->f.backdrop, p->out, p->f.stride),
		0);
	assert_false(compositor_last(p->fresh).reused);
	expect_same_picture(p->f.out, p->out, p->f.stride, p->f.bytes,
			    "pose %d, after %d frames from sums", pose, p->reused);
}

static const struct synthetic_options many_lines = {
	.width = 20,
	.height = 17,
	.lights = 150,
	.coarse = 40,
	.patterns = 5,
	.columns = 120,
	.layers = 2,
	.exact = true,
	.grounds = 2,
	.column_cut = 0.001,
	.object_share = 0.4,
	.ground_share = 0.5,
	.stand_in_share = 0.3,
	.peak = 1,
	.bounce = 0.3,
	.seed = 8,
};

/* ---- whether sums are kept ---- */

/* Predicts from the text of compositor.h which frames reuse sums. */
struct keeping {
	double (*before)[3]; /* [lights]: amounts in the last frame that could keep sums */
	bool kept;	     /* the frame before kept its sums */
};

/* Counts changed lights as the compositor does: selected lights, and shadows of dropped lights. */
static int count_changed(struct keeping *k, const struct light_selection *lights)
{
	int changed = 0;

	for (int i = 0; i < lights->count; i++) {
		double now[3];

		for (int c = 0; c < 3; c++)
			now[c] = lights->radiance[i][c] + lights->ambient[c];
		changed += memcmp(now, k->before[i], sizeof(now)) != 0;
		memcpy(k->before[i], now, sizeof(now));
	}
	return changed;
}

enum expected { REUSED_NOT, REUSED_MAYBE, REUSED };

/* Predicts the next frame. With `auto`, reuse of kept sums is decided by the cost of each block. */
static enum expected reuse_expect(struct keeping *k, const struct compositor_settings *settings,
				  const struct light_selection *lights)
{
	const bool had = k->kept;
	bool few;

	if (!settings->object)
		return REUSED_NOT; /* the kept sums stay */
	k->kept = false;
	if (settings->mode != COMPOSITOR_EXACT || settings->reuse == REUSE_NEVER)
		return REUSED_NOT;
	few = count_changed(k, lights) * 4 <= lights->count;
	k->kept = settings->reuse == REUSE_ALWAYS || few;
	if (!had || !k->kept)
		return REUSED_NOT;
	return settings->reuse == REUSE_ALWAYS ? REUSED : REUSED_MAYBE;
}

/* ---- one change after the other ---- */

struct changes {
	struct compositor_settings settings;
	double threshold;
	enum threshold_mode mode;
};

static void change_settings(struct changes *now, struct chance *chance, int what)
{
	if (what == 0)
		now->settings.mode = (enum compositor_mode)chance_int(chance, 0, 1);
	else if (what == 1)
		now->settings.gain = chance_real(chance, 0, 5);
	else if (what == 2)
		now->settings.reuse = (enum compositor_reuse)chance_int(chance, 0, 2);
	else if (what == 3)
		now->settings.object = !now->settings.object;
	else if (what < 8)
		now->threshold = chance_real(chance, 0, 1);
	else if (what == 8)
		now->mode = (enum threshold_mode)chance_int(chance, 0, 1);
}

static void change_lights(float (*radiance)[3], struct chance *chance, int what)
{
	const int light = chance_int(chance, 0, 149);

	if (what == 9)
		memset(radiance, 0, sizeof(*radiance) * 150);
	else if (what == 10)
		for (int i = 0; i < 150; i++)
			radiance[i][1] = (float)chance_real(chance, 0, 1);
	for (int c = 0; c < 3; c++)
		radiance[light][c] = what % 7 ? (float)chance_real(chance, 0, 1) : 0;
	if (what == 11)
		radiance[light][0] = 1e30F;
}

/* Lights change, appear and vanish; threshold, gain, mode and reuse change too. Each frame must be
 * the one of its own light, and must start from kept sums where it should. */
static void reused_sums_give_the_same_frames(void **state)
{
	struct chance chance = chance_begin("reuse");
	struct changes now = {
		.settings = {.gain = 1,
			     .object = true,
			     .reuse = REUSE_ALWAYS,
			     .mode = COMPOSITOR_EXACT},
		.mode = THRESHOLD_DROP,
	};
	int frames[3] = {0};
	struct keeping keeping = {.before = calloc(150, sizeof(*keeping.before))};
	struct synthetic s;
	struct pool *pool;
	struct pair p;

	(void)state;
	assert_non_null(keeping.before);
	synthetic_open(&s, &many_lines);
	assert_int_equal(pool_create(&pool, 2), 0);
	pair_begin(&p, &s.basis, pool, &chance);
	for (int k = 0; k < 1500; k++) {
		/* At first only lights change, so that some frames do reuse sums. */
		const int what = chance_int(&chance, k < 20 ? 9 : 0, 60), before = p.reused;
		enum expected expected;

		change_settings(&now, &chance, what);
		change_lights(p.radiance, &chance, what);
		pair_set(&p, now.settings);
		pair_reuse(&p, &s.basis, 0, now.threshold, now.mode);
		expected = reuse_expect(&keeping, &now.settings, &p.f.lights);
		if (expected != REUSED_MAYBE)
			expect_equal(p.reused - before, expected == REUSED, "k=%d", k);
		frames[expected]++;
		pair_compare(&p, 0);
	}
	printf("# %d of 1500 frames reused sums: all of %d that had to, and of %d that might\n",
	       p.reused, frames[REUSED], frames[REUSED_MAYBE]);
	assert_true(frames[REUSED] >= 19); /* all of the first 20 but the first */
	pair_end(&p);
	pool_destroy(pool);
	synthetic_close(&s);
	free(keeping.before);
}

/* A drift of one bit in a million updates would show. */
static void a_million_updates_leave_no_trace(void **state)
{
	struct synthetic_options o = many_lines;
	struct chance chance = chance_begin("a million updates");
	const struct compositor_settings settings = {
		.gain = 1, .object = true, .reuse = REUSE_ALWAYS, .mode = COMPOSITOR_EXACT};
	struct synthetic s;
	struct pair p;

	(void)state;
	o.width = o.height = 3;
	o.lights = 70;
	o.coarse = 20;
	o.columns = 60;
	o.layers = 1;
	synthetic_open(&s, &o);
	pair_begin(&p, &s.basis, NULL, &chance);
	pair_set(&p, settings);
	for (int k = 0; k < 1000000; k++) {
		/* A frame after every change would take minutes, so some changes share one. */
		const int light = chance_int(&chance, 0, 69), c = chance_int(&chance, 0, 2);

		p.radiance[light][c] = k % 11 ? (float)chance_real(&chance, 0, 1) : 0;
		if (k % 20 == 0)
			pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
		if (k % 5000 == 0)
			pair_compare(&p, 0);
	}
	pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
	pair_compare(&p, 0);
	assert_true(p.reused >= 49999);
	pair_end(&p);
	synthetic_close(&s);
}

/* When no light has changed, no line is read; basis_bytes counts what is read. */
static void less_is_read_where_less_has_changed(void **state)
{
	struct chance chance = chance_begin("less is read");
	const struct compositor_settings settings = {
		.gain = 1, .object = true, .reuse = REUSE_AUTO, .mode = COMPOSITOR_EXACT};
	uint64_t all, one;
	struct synthetic s;
	struct pair p;

	(void)state;
	synthetic_open(&s, &many_lines);
	pair_begin(&p, &s.basis, NULL, &chance);
	for (int i = 0; i < 150; i++)
		for (int c = 0; c < 3; c++)
			p.radiance[i][c] = (float)chance_real(&chance, 0.1, 1);
	pair_set(&p, settings);
	pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
	all = compositor_last(p.f.compositor).basis_bytes;
	assert_int_equal(p.reused, 0);
	/* From here on light is steady: the first such frame keeps sums ... */
	pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
	assert_int_equal(compositor_last(p.f.compositor).basis_bytes, all);
	assert_int_equal(p.reused, 0);
	/* ... and the next one uses them. */
	pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
	assert_int_equal(compositor_last(p.f.compositor).basis_bytes, 0);
	p.radiance[7][1] *= 1.01F;
	pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
	one = compositor_last(p.f.compositor).basis_bytes;
	assert_true(one > 0 && one < all / 70); /* one line of 150, and its neighbour */
	pair_compare(&p, 0);
	for (int i = 0; i < 150; i++)
		p.radiance[i][2] *= 1.01F;
	pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
	assert_int_equal(compositor_last(p.f.compositor).basis_bytes, all);
	pair_compare(&p, 0);
	pair_end(&p);
	synthetic_close(&s);
}

/* In a fast frame reuse would not pay, so nothing is compared or kept: everything is read each
 * time, whatever the setting. */
static void fast_frames_keep_nothing(void **state)
{
	struct chance chance = chance_begin("fast frames");
	struct compositor_settings settings = {.gain = 1, .object = true};
	struct synthetic s;
	uint64_t all = 0;
	struct pair p;

	(void)state;
	synthetic_open(&s, &many_lines);
	pair_begin(&p, &s.basis, NULL, &chance);
	for (int i = 0; i < 150; i++)
		for (int c = 0; c < 3; c++)
			p.radiance[i][c] = (float)chance_real(&chance, 0.1, 1);
	for (int k = 0; k < 3 * REUSE_COUNT; k++) {
		settings.reuse = (enum compositor_reuse)(k / 3);
		pair_set(&p, settings);
		pair_reuse(&p, &s.basis, 0, 0, THRESHOLD_DROP);
		all = k ? all : compositor_last(p.f.compositor).basis_bytes;
		expect_above(all, 0, "k=%d", k);
		expect_equal(compositor_last(p.f.compositor).basis_bytes, all, "k=%d", k);
	}
	assert_int_equal(p.reused, 0);
	pair_end(&p);
	synthetic_close(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reused_sums_give_the_same_frames),
		cmocka_unit_test(a_million_updates_leave_no_trace),
		cmocka_unit_test(less_is_read_where_less_has_changed),
		cmocka_unit_test(fast_frames_keep_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
