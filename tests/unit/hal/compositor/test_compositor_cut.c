/* SPDX-License-Identifier: MIT */
/* Fast mode reads the columns at or above their block's share of the cut (basis_format.h), and no
 * others. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/compositor/light/light_vector.h"
#include "hal/optics/dome.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* ---- one pixel ---- */

enum { LIGHTS = 6, FREQUENCY = 1 };

#define CUT 0.1
#define VALUE 0.5 /* of the pixel, for a light of radiance 1 */

/* A black pixel that only light 2 makes brighter. */
static void write_pixel(const char *path, float cut_share)
{
	const struct basis_info_chunk info = {.width = 1,
					      .height = 1,
					      .lights = LIGHTS,
					      .dome_frequency = FREQUENCY,
					      .poses = 1,
					      .coarse = LIGHTS,
					      .column_cut = CUT};
	const uint16_t pixel = 0, coverage = 65535;
	struct basis_light lights[LIGHTS];
	float value[3][LIGHTS] = {{0}}, peak[LIGHTS + 1][3] = {{0}};
	struct basis_block_payload block;

	hand_block_lights(FREQUENCY, LIGHTS, lights);
	for (int c = 0; c < 3; c++)
		value[c][2] = peak[2][c] = peak[LIGHTS][c] = VALUE;
	block = hand_block_of_object(0, 1, &pixel, LIGHTS, lights, &value[0][0]);
	block.entry.cut_share = cut_share;
	hand_block_file(path, &info, lights, &block, &coverage, (const float(*)[3])peak);
}

/* Composites the pixel of a file under light 2 with this radiance in the green channel. Returns its
 * green code and sets *columns to the number of columns read. */
static int green_of(const char *path, double radiance, double gain, int *columns)
{
	const struct compositor_settings settings = {.mode = COMPOSITOR_FAST,
						     .background = {.named = TRANSFER_LINEAR},
						     .output = {.named = TRANSFER_LINEAR},
						     .gain = gain,
						     .object = true};
	const struct compositor_options options = {.kernel = "c"};
	const uint8_t background[4] = {0};
	const struct picture picture = {background, 4, 4, 1, 1};
	const struct backdrop backdrop = backdrop_of(&picture);
	float light[LIGHTS][3] = {{0}};
	struct light_selection selection;
	struct compositor *compositor;
	struct fault fault = {""};
	struct basis basis;
	uint8_t out[4];

	light[2][1] = (float)radiance;
	expect_success(basis_open(&basis, path, BASIS_SHOWN, &fault), &fault);
	assert_int_equal(light_selection_create(&selection, &basis), 0);
	light_selection_choose(&selection, &basis, 0, (const float(*)[3])light, 0, THRESHOLD_DROP,
			       gain);
	expect_success(compositor_create(&compositor, &basis, &options, &fault), &fault);
	compositor_set(compositor, &settings);
	assert_int_equal(compositor_run(compositor, 0, &selection, &backdrop, out, 4), 0);
	*columns = compositor_last(compositor).columns;
	assert_int_equal(compositor_last(compositor).columns_left_out, LIGHTS - *columns);
	compositor_destroy(compositor);
	light_selection_free(&selection);
	basis_close(&basis);
	return out[1];
}

/* A column counts from cut_share * column_cut on, also where it is below column_cut. */
TEST("a column counts from its share of the cut")
{
	static const float shares[] = {1, 0.7F, 0.5F, 0.125F, 1.0F / 4096};
	char folder[] = "/tmp/test_compositor_cut_XXXXXX", path[80];

	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/one.inlay", folder);
	for (size_t k = 0; k < sizeof(shares) / sizeof(*shares); k++) {
		const double limit = (double)shares[k] * CUT;

		write_pixel(path, shares[k]);
		for (double gain = 0.5; gain <= 2; gain *= 2) {
			for (double change = limit / 4; change < 1; change *= 1.3) {
				int columns, green;

				if (fabs(change / limit - 1) < 1e-3)
					continue;
				green = green_of(path, change / VALUE / gain, gain, &columns);
				expect_equal(columns, change > limit,
					     "columns: change %g, share %g, gain %g", change,
					     (double)shares[k], gain);
				expect_below(fabs(green - (change > limit ? 255 * change : 0)), 0.6,
					     "level: change %g, share %g, gain %g", change,
					     (double)shares[k], gain);
			}
		}
	}
	unlink(path);
	rmdir(folder);
}

/* A share so small that dividing by it overflows: every column whose light changes anything counts,
 * no other. */
TEST("the smallest share leaves out nothing")
{
	char folder[] = "/tmp/test_compositor_cut_XXXXXX", path[80];
	int columns;

	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/one.inlay", folder);
	write_pixel(path, FLT_TRUE_MIN);
	assert_int_equal(green_of(path, 0, 1, &columns), 0);
	assert_int_equal(columns, 0);
	for (double change = 1; change > 1e-4; change /= 3) {
		assert_int_equal(green_of(path, change / VALUE, 1, &columns), lrint(255 * change));
		assert_int_equal(columns, 1);
	}
	unlink(path);
	rmdir(folder);
}

/* ---- all columns of a file ---- */

/* Numbers of columns by the definition. */
struct counted {
	int least, most; /* read; they differ by the columns that are on the limit */
	int whole;	 /* that would be read with the whole cut in each block */
	int all;
};

static bool in_common(const struct basis_block *a, const struct basis_block *b)
{
	return a->kind == b->kind && a->ground == b->ground && a->channels == b->channels &&
	       a->pixels == b->pixels &&
	       memcmp(a->pixel, b->pixel, (size_t)a->pixels * sizeof(*a->pixel)) == 0;
}

/* Whether one of the blocks has the column of this number. */
static bool have_column(const struct basis_block *blocks, int count, int number)
{
	for (int k = 0; k < count; k++)
		for (int n = 0; n < blocks[k].columns; n++)
			if (blocks[k].light[n] == number)
				return true;
	return false;
}

static double largest_value(const struct basis_block *b, int column)
{
	int tint = BASIS_TINT_ONE;

	for (int p = 0; b->tint && p < 3 * b->pixels; p++)
		tint = b->tint[p] > tint ? b->tint[p] : tint;
	return (double)b->column_scale[column] * (b->bits == 8 ? 127 : 32767) * tint /
	       BASIS_TINT_ONE;
}

/* Counts the columns of blocks that share the columns of their groups. */
static void count_run(const struct light_vector *light, const struct basis_block *blocks, int count,
		      struct counted *counted)
{
	const struct basis_groups *groups = &light->terms->groups;
	const int lights = light->lights;

	for (int k = 0; k < count; k++) {
		for (int n = 0; n < blocks[k].columns; n++) {
			const int number = blocks[k].light[n];
			const bool beside =
				number >= lights ||
				(groups->count &&
				 have_column(blocks, count, lights + groups->of[number]));
			const double strength =
				light->sent[beside ? light_beside(lights, number) : number]
					.strength;
			const double worth = strength * largest_value(&blocks[k], n);

			counted->least += worth >= (double)blocks[k].cut_share * (1 + 1e-5);
			counted->most += worth >= (double)blocks[k].cut_share * (1 - 1e-5);
			counted->whole += worth >= 1;
			counted->all++;
		}
	}
}

/* Counts the columns of all blocks of this kind and ground. */
static void count_kind(const struct basis *basis, const struct light_selection *lights,
		       const struct light_order *order, struct counted *counted)
{
	struct light_terms terms;
	struct light_vector light;

	assert_int_equal(light_terms_create(&terms, basis), 0);
	assert_int_equal(light_vector_create(&light, &terms), 0);
	light_vector_make(&light, order, lights);
	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++) {
		const struct basis_tile *tile = &basis->poses[0].shown.tiles[t];

		for (int n = 0, next; n < tile->block_count; n = next) {
			const struct basis_block *b = &tile->blocks[n];

			for (next = n + 1;
			     next < tile->block_count && in_common(b, &tile->blocks[next]);)
				next++;
			if (b->kind == order->kind && b->ground == order->ground)
				count_run(&light, b, next - n, counted);
		}
	}
	light_vector_free(&light);
	light_terms_free(&terms);
}

/* Columns of lights and of groups, of blocks with various shares of the cut. */
TEST("shares decide which columns are read")
{
	struct synthetic_options o = {.width = 40,
				      .height = 23,
				      .lights = 60,
				      .grounds = 2,
				      .coarse = 9,
				      .patterns = 2,
				      .columns = 40,
				      .layers = 3,
				      .vary = true,
				      .object_share = 0.5,
				      .ground_share = 0.4,
				      .peak = 1,
				      .bounce = 0.3,
				      .seed = 21};

	for (int k = 0; k < 12; k++) {
		const double gain = k % 2 ? 1 : 1.7;
		const struct compositor_settings settings = {
			.mode = COMPOSITOR_FAST, .gain = gain, .object = true};
		struct chance chance = chance_begin("cuts");
		struct counted counted = {0};
		struct random_frame f;
		struct synthetic s;
		int columns;

		o.seed++;
		o.groups = k % 3 ? o.coarse : 0;
		o.column_cut = ldexp(1, -9 - k % 4);
		synthetic_open(&s, &o);
		random_frame_begin(&f, &s.basis, NULL, &chance);
		compositor_set(f.compositor, &settings);
		random_frame_run(&f, 0);
		columns = compositor_last(f.compositor).columns;
		for (int kind = 0; kind < 3; kind++)
			count_kind(&s.basis, &f.lights,
				   &(struct light_order){.kind = kind ? BASIS_KIND_V : BASIS_KIND_T,
							 .ground = kind == 2,
							 .gain = gain,
							 .cut = true,
							 .groups = o.groups > 0},
				   &counted);
		expect_at_least(columns, counted.least, "file %d", k);
		expect_at_most(columns, counted.most, "file %d", k);
		expect_below(counted.most - counted.least, 5, "file %d", k);
		expect_equal(compositor_last(f.compositor).columns_left_out, counted.all - columns,
			     "file %d", k);
		print_message("# cut %g: %d of %d columns, %d with the whole cut\n", o.column_cut,
			      columns, counted.all, counted.whole);
		expect_above(columns, counted.whole + counted.all / 20, "file %d", k);
		expect_below(columns, counted.all - counted.all / 20, "file %d", k);
		random_frame_end(&f);
		synthetic_close(&s);
	}
}
