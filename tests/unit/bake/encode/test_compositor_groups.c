/* SPDX-License-Identifier: MIT */
/* A bake under many lights, with columns of groups, composited in fast mode: as near to double
 * precision as the file declares. */
#include <math.h>
#include <string.h>

#include <stdlib.h>

#include "bake/judge/ensemble.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define COLUMN_CUT 0.0004
/* Largest error that compositing adds: hal/compositor/README.md. */
#define COMPOSITING 0.78

static void write_ball(void)
{
	small_scene_write_sphere("ball.obj", 0.5, 16);
	small_scene_write(
		"ball.ini",
		"[camera]\nposition = 2 -3 1.6\nlook_at = 0 0 0.4\nfield_deg = 40\n"
		"width = %d\nheight = %d\n[dome]\nfrequency = %d\n"
		"[render]\nsamples = 4\nbounces = 2\ncoarse = 3\ncolumn_cut = %g\n[ground]\n"
		"[object ball]\nfile = ball.obj\nstand = yes\n",
		SANITIZED ? 28 : 48, SANITIZED ? 24 : 40, SANITIZED ? 7 : 8, COLUMN_CUT);
}

struct column_counts {
	int groups; /* columns of groups */
	int beside; /* columns of lights in blocks that have columns of groups */
	int across; /* columns of lights whose group has its column in another block */
};

static bool has_groups(const struct basis *basis, const struct basis_block *b)
{
	return b->columns && b->light[b->columns - 1] >= basis->info.lights;
}

static bool have_groups_in_common(const struct basis_block *a, const struct basis_block *b)
{
	return a->kind == b->kind && a->ground == b->ground && a->channels == b->channels &&
	       a->pixels == b->pixels &&
	       memcmp(a->pixel, b->pixel, (size_t)a->pixels * sizeof(*a->pixel)) == 0;
}

static struct column_counts count_columns(const struct basis *basis)
{
	const struct basis_layer *shown = &basis->poses[0].shown;
	struct column_counts counts = {0};

	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++)
		for (int k = 0; k < shown->tiles[t].block_count; k++) {
			const struct basis_block *b = &shown->tiles[t].blocks[k];
			int own = 0;

			for (int n = 0; n < b->columns; n++)
				own += b->light[n] >= basis->info.lights;
			counts.groups += own;
			counts.beside += own ? b->columns - own : 0;
			if (k && !own && has_groups(basis, &b[-1]) &&
			    have_groups_in_common(&b[-1], b))
				counts.across += b->columns;
		}
	return counts;
}

/* Light from a random direction, soft or a lamp, over a sky of some hue. */
static void light_up(const struct basis *basis, struct chance *chance, float (*radiance)[3])
{
	const double power = ldexp(1, chance_int(chance, 0, 9));
	double to[3], level = 0;

	chance_direction(chance, 0.1, to);
	for (uint32_t i = 0; i < basis->info.lights; i++) {
		const double *d = basis->lights[i].direction;
		const double near = to[0] * d[0] + to[1] * d[1] + to[2] * d[2];
		const double lobe = power * pow(near > 0 ? near : 0, power);

		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)(0.2 + 0.1 * c + lobe * (1 - 0.1 * c));
		level += (double)radiance[i][1] * d[2] * basis->lights[i].solid_angle_sr / M_PI;
	}
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] /= (float)level;
}

/* One light alone, so bright that white ground or the brightest pixel of the object is 1, or
 * dimmer. */
static void light_up_one(const struct basis *basis, struct chance *chance, float (*radiance)[3])
{
	const uint32_t cell = (uint32_t)chance_int(chance, 0, (int)basis->info.lights - 1);
	double brightest = 1e-9;

	for (int c = 0; c < 3; c++) {
		brightest = fmax(brightest, basis_ground(basis, 0, c)[cell]);
		brightest = fmax(brightest, (double)basis->poses[0].peak[cell][c]);
	}
	memset(radiance, 0, basis->info.lights * sizeof(*radiance));
	for (int c = 0; c < 3; c++)
		radiance[cell][c] = (float)ldexp(1 / brightest, -chance_int(chance, 0, 3));
}

/* One light that sends 16 times as much light to level ground as the rest of a grey sky. */
static void light_up_strongly(const struct basis *basis, struct chance *chance,
			      float (*radiance)[3])
{
	const uint32_t cell = (uint32_t)chance_int(chance, 0, (int)basis->info.lights - 1);
	double level = 0, brightest = 1e-9;

	for (uint32_t i = 0; i < basis->info.lights; i++)
		level += ensemble_projected_sr(&basis->lights[i]);
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] =
				(float)(i == cell ? 1 + 16 * level /
								    ensemble_projected_sr(
									    &basis->lights[i])
						  : 1);
	for (int c = 0; c < 3; c++)
		brightest = fmax(brightest,
				 fmax(17 * level / M_PI, (double)basis->poses[0].peak[cell][c] *
								 (double)radiance[cell][c]));
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] /= (float)brightest;
}

/* Largest difference in 8-bit levels. */
static double farthest(const struct random_frame *f, const double *truth, int width, int height)
{
	double most = 0;

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int c = 0; c < 3; c++) {
				const double is =
					truth[((size_t)y * (size_t)width + (size_t)x) * 3 +
					      (size_t)c];

				most = fmax(most, fabs(is - f->out[(size_t)y * f->stride +
								   (size_t)x * 4 + 2 - (size_t)c]));
			}
	return most;
}

#define RUNS 24		/* of each kind of light */
#define RUNS_STRONG 300 /* few lights are worst */
enum { SKY, ALONE, STRONG };

TEST_BETWEEN("fast is near exact", small_scene_begin, small_scene_end)
{
	static void (*const light[])(const struct basis *, struct chance *,
				     float(*)[3]) = {light_up, light_up_one, light_up_strongly};
	struct chance chance = chance_begin("groups in use");
	struct compositor_settings settings = {.background = {.named = TRANSFER_SRGB},
					       .output = {.named = TRANSFER_SRGB},
					       .gain = 1,
					       .object = true};
	struct basis basis;
	struct random_frame f;
	float(*radiance)[3];
	double *truth, worst[3] = {0};
	struct column_counts counts;
	int most_columns = 0;

	write_ball();
	basis = small_scene_bake("ball.ini");
	counts = count_columns(&basis);
	assert_true(counts.groups > 50 && counts.beside >= 2 * counts.groups);
	assert_true(counts.across > 50);
	radiance = calloc(basis.info.lights, sizeof(*radiance));
	truth = calloc((size_t)basis.info.width * basis.info.height * 3, sizeof(*truth));
	assert_true(radiance && truth);
	random_frame_begin(&f, &basis, NULL, &chance);
	for (int run = 0; run < 2 * RUNS + RUNS_STRONG; run++) {
		const int kind = run < 2 * RUNS ? run / RUNS : STRONG;
		double off;

		light[kind](&basis, &chance, radiance);
		if (kind == STRONG)
			memset(f.background, 255, f.bytes); /* shows most of what a shadow has */
		light_selection_choose(&f.lights, &basis, 0, (const float(*)[3])radiance, 0,
				       THRESHOLD_AMBIENT, 1);
		settings.mode = COMPOSITOR_EXACT;
		assert_int_equal(
			compositor_reference(&basis, 0, &settings, &f.lights, &f.picture, truth),
			0);
		settings.mode = COMPOSITOR_FAST;
		compositor_set(f.compositor, &settings);
		random_frame_run(&f, 0);
		off = farthest(&f, truth, (int)basis.info.width, (int)basis.info.height);
		worst[kind] = fmax(worst[kind], off);
		most_columns = compositor_last(f.compositor).columns > most_columns
				       ? compositor_last(f.compositor).columns
				       : most_columns;
	}
	print_message(
		"# %d columns of groups, %d beside, %d across; %d used at most; %.2f levels off, %.2f by one light, %.2f by a strong one\n",
		counts.groups, counts.beside, counts.across, most_columns, worst[SKY], worst[ALONE],
		worst[STRONG]);
	/* The declared errors, half as much again and more where these skies are others, and
	 * rounding. */
	expect_at_most(worst[SKY], 1.5 * basis.info.sky_max + COMPOSITING, "skies");
	expect_at_most(worst[ALONE], basis.info.cell_max + COMPOSITING, "lights alone");
	expect_at_most(worst[STRONG], 1.75 * basis.info.cell_max + COMPOSITING, "strong lights");
	assert_true(most_columns > 0);
	random_frame_end(&f);
	basis_close(&basis);
	free(radiance);
	free(truth);
}

/* Without a cut no column may be left out, so there are no groups. */
TEST_BETWEEN("without a cut", small_scene_begin, small_scene_end)
{
	struct basis basis;

	write_ball();
	small_scene_write(
		"whole.ini",
		"[camera]\nposition = 2 -3 1.6\nlook_at = 0 0 0.4\nfield_deg = 40\n"
		"width = 16\nheight = 16\n[dome]\nfrequency = 6\n"
		"[render]\nsamples = 2\nbounces = 2\ncoarse = 3\ncolumn_cut = 0\n[ground]\n"
		"[object ball]\nfile = ball.obj\nstand = yes\n");
	basis = small_scene_bake("whole.ini");
	assert_int_equal(count_columns(&basis).groups, 0);
	basis_close(&basis);
}
