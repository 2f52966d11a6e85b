/* SPDX-License-Identifier: MIT */
/* inlay-bake info: what a basis file holds. */
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "hal/base/json.h"
#include "hal/base/log.h"
#include "hal/basis/basis.h"
#include "hal/compositor/near/near_sky.h"
#include "hal/optics/dome.h"

static const char *const kind_names[BASIS_KIND_COUNT] = {"T", "V", "D", "U"};
static const char *const kind_meanings[BASIS_KIND_COUNT] = {
	"object", "shadow on shared ground", "change of own surfaces", "light of own surfaces"};

/* Sums over the blocks of one kind, or of all kinds, in one layer. */
struct block_sum {
	long blocks, blocks_of_bytes, tinted; /* blocks_of_bytes: those with columns of 8 bits */
	long pixels;			      /* each counted once */
	double patterns, columns;	      /* summed over blocks */
	int patterns_most, columns_most;
	double pixel_patterns, pixel_columns; /* summed over blocks and their pixels */
	uint64_t bytes;			      /* payloads, and entries in the list of blocks */
};

struct layer_sum {
	struct block_sum kind[BASIS_KIND_COUNT], all;
	long tiles_used;
};

struct summary {
	struct layer_sum shown, exact;
	bool has_exact; /* in any pose */
	long tiles, covered, seen_through;
	long mirrored, look_ups; /* pixels that mirror the fisheye's picture; their look-ups */
	uint64_t bytes;		 /* of the file */
};

static void block_sum_add(struct block_sum *sum, const struct basis_block *block)
{
	sum->blocks++;
	sum->blocks_of_bytes += block->bits == 8;
	sum->tinted += block->tint != NULL;
	sum->patterns += block->patterns;
	sum->columns += block->columns;
	if (block->patterns > sum->patterns_most)
		sum->patterns_most = block->patterns;
	if (block->columns > sum->columns_most)
		sum->columns_most = block->columns;
	sum->pixel_patterns += (double)block->patterns * block->pixels;
	sum->pixel_columns += (double)block->columns * block->pixels;
	sum->bytes += block->bytes + sizeof(struct basis_block_entry);
}

static void layer_sum_add_tile(struct layer_sum *layer, const struct basis_tile *tile)
{
	bool listed[BASIS_KIND_COUNT][BASIS_TILE * BASIS_TILE] = {{false}};

	layer->tiles_used += tile->block_count > 0;
	for (int b = 0; b < tile->block_count; b++) {
		const struct basis_block *block = &tile->blocks[b];

		block_sum_add(&layer->kind[block->kind], block);
		block_sum_add(&layer->all, block);
		for (int p = 0; p < block->pixels; p++)
			listed[block->kind][block->pixel[p]] = true;
	}
	for (int p = 0; p < BASIS_TILE * BASIS_TILE; p++) {
		bool any = false;

		for (int k = 0; k < BASIS_KIND_COUNT; k++) {
			layer->kind[k].pixels += listed[k][p];
			any |= listed[k][p];
		}
		layer->all.pixels += any;
	}
}

static void summary_add_pose(struct summary *s, const struct basis *basis,
			     const struct basis_pose *pose)
{
	const int tiles = basis->tiles_across * basis->tiles_down;
	const long pixels = (long)basis->info.width * basis->info.height;

	s->tiles += tiles;
	for (int t = 0; t < tiles; t++)
		layer_sum_add_tile(&s->shown, &pose->shown.tiles[t]);
	for (int t = 0; pose->exact.tiles && t < tiles; t++)
		layer_sum_add_tile(&s->exact, &pose->exact.tiles[t]);
	s->has_exact |= pose->exact.tiles != NULL;
	for (long i = 0; i < pixels; i++)
		s->covered += pose->coverage[i] > 0;
	s->seen_through += (long)pose->glass_count;
	s->look_ups += (long)pose->mirror_count;
	s->mirrored += basis_pose_mirrored(pose);
}

/* Loads one pose after the other, so that only one is in memory at a time. */
static int summary_fill(const struct basis *basis, struct summary *s, struct fault *fault)
{
	int err = 0;

	*s = (struct summary){.bytes = basis->map_bytes};
	for (int p = 0; p < (int)basis->info.poses && !err; p++) {
		basis_poses_expect(basis, NULL, 0);
		err = basis_pose_load(basis, p, fault);
		if (!err)
			summary_add_pose(s, basis, &basis->poses[p]);
	}
	return err;
}

/* Bytes that the same pixels would take with one byte for each light and channel. */
static double dense_bytes(const struct basis *basis, const struct layer_sum *layer, int kind)
{
	double pixels = 0;

	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		if (kind == k || kind == BASIS_KIND_COUNT)
			pixels += (double)layer->kind[k].pixels;
	return pixels * 3 * basis->info.lights;
}

static double safe_ratio(double sum, double count)
{
	return count > 0 ? sum / count : 0;
}

static void print_kind(const struct basis *basis, const struct layer_sum *layer, int kind,
		       const char *before)
{
	const struct block_sum *s = &layer->kind[kind];
	const double dense = dense_bytes(basis, layer, kind);

	printf("%s%s (%s): %ld blocks, %ld pixels, %.1f patterns a block (largest %d), %.1f columns (largest %d",
	       before, kind_names[kind], kind_meanings[kind], s->blocks, s->pixels,
	       safe_ratio(s->patterns, (double)s->blocks), s->patterns_most,
	       safe_ratio(s->columns, (double)s->blocks), s->columns_most);
	if (s->blocks_of_bytes)
		printf("; of 8 bits in %ld blocks", s->blocks_of_bytes);
	printf(")");
	if (s->tinted)
		printf(", %ld tinted", s->tinted);
	printf(", %.2f MB, %.1f bytes a pixel; dense 8-bit %.2f MB, %.1f times as much\n",
	       (double)s->bytes * 1e-6, safe_ratio((double)s->bytes, (double)s->pixels),
	       dense * 1e-6, safe_ratio(dense, (double)s->bytes));
}

static void print_layer(const struct basis *basis, const struct summary *all, bool exact)
{
	const struct layer_sum *layer = exact ? &all->exact : &all->shown;
	const double dense = dense_bytes(basis, layer, BASIS_KIND_COUNT);

	printf("%s layer: %ld of %ld tiles hold something, %ld pixels, %.2f MB; dense 8-bit %.2f MB, %.1f times as much\n",
	       exact ? "exact" : "shown", layer->tiles_used, all->tiles, layer->all.pixels,
	       (double)layer->all.bytes * 1e-6, dense * 1e-6,
	       safe_ratio(dense, (double)layer->all.bytes));
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		if (layer->kind[k].blocks)
			print_kind(basis, layer, k, exact ? "exact " : "");
}

static void print_poses(const struct basis *basis)
{
	const int poses = (int)basis->info.poses;

	if (!basis->names)
		return;
	printf("poses:");
	for (int p = 0; p < poses; p++)
		printf(" %d%s%s", p, *basis_pose_name(basis, p) ? "=" : "",
		       basis_pose_name(basis, p));
	printf("\n");
}

/* What the objects of all poses cover of the ground, as a rectangle: width and depth. False:
 * unknown, or nothing. */
static bool footprint_size(const struct basis *basis, double size[2])
{
	double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};

	for (uint32_t p = 0; basis->feet && p < basis->info.poses; p++) {
		const struct basis_footprint *foot = &basis->feet[p];

		for (int k = 0; k < BASIS_FOOT_SQUARES * BASIS_FOOT_SQUARES; k++) {
			const int square[2] = {k % BASIS_FOOT_SQUARES, k / BASIS_FOOT_SQUARES};

			if (!(foot->row[square[1]] >> square[0] & 1))
				continue;
			for (int c = 0; c < 2; c++) {
				const double at = (double)foot->corner[c] +
						  square[c] * (double)foot->side;

				low[c] = fmin(low[c], at);
				high[c] = fmax(high[c], at + (double)foot->side);
			}
		}
	}
	size[0] = high[0] - low[0];
	size[1] = high[1] - low[1];
	return size[0] > 0;
}

static void print_footprint(const struct basis *basis)
{
	double size[2];

	if (footprint_size(basis, size))
		printf("footprint: %.3g x %.3g world units of the ground%s\n", size[0], size[1],
		       basis->info.poses > 1 ? ", in all poses" : "");
	else
		printf("footprint: %s\n", basis->feet ? "none" : "not known");
}

static void print_errors(const struct basis_info_chunk *info)
{
	printf("measured error in 8-bit levels, nothing overexposed: skies %.3g RMS, %.3g at most; single cells %.3g RMS, %.3g at most; noise %.3g\n",
	       info->sky_rms, info->sky_max, info->cell_rms, info->cell_max, info->noise_levels);
	printf("bounds under any lighting: object %.3g of the light sent, ratio %.3g; columns that change less than %.3g may be left out\n",
	       info->object_error, info->ratio_error, info->column_cut);
}

static void print_text(const struct basis *basis, const struct summary *s, const char *path)
{
	const struct basis_info_chunk *info = &basis->info;

	printf("%s: %s%u x %u, %u lights (dome frequency %u), %u coarse, %u pose%s, %u ground term%s, %.2f MB\n",
	       path, basis_is_preview(basis) ? "preview, " : "", info->width, info->height,
	       info->lights, info->dome_frequency, info->coarse, info->poses,
	       info->poses == 1 ? "" : "s", info->grounds, info->grounds == 1 ? "" : "s",
	       (double)s->bytes * 1e-6);
	printf("the object covers %ld pixels", s->covered);
	if (s->seen_through)
		printf(", and the background is seen through %ld of them", s->seen_through);
	if (s->mirrored)
		printf("; %ld (%.0f %%) mirror the fisheye's picture, by %.1f look-ups each",
		       s->mirrored, 100.0 * (double)s->mirrored / (double)s->covered,
		       (double)s->look_ups / (double)s->mirrored);
	printf("\n");
	print_layer(basis, s, false);
	if (s->has_exact)
		print_layer(basis, s, true);
	else
		printf("no exact layer\n");
	print_errors(info);
	print_footprint(basis);
	printf("lamps at places: %s\n",
	       near_sky_possible(basis) ? "yes" : "no, the places of its pixels are not known");
	print_poses(basis);
	printf("%s%s", basis->camera, basis->provenance);
}

static void write_json_sum(struct json *json, const char *name, const struct block_sum *s,
			   double dense)
{
	json_object(json, name);
	json_number(json, "blocks", (double)s->blocks);
	json_number(json, "blocks_8_bit", (double)s->blocks_of_bytes);
	json_number(json, "tinted", (double)s->tinted);
	json_number(json, "pixels", (double)s->pixels);
	json_number(json, "patterns", s->patterns);
	json_number(json, "patterns_most", s->patterns_most);
	json_number(json, "columns", s->columns);
	json_number(json, "columns_most", s->columns_most);
	json_number(json, "pixel_patterns", s->pixel_patterns);
	json_number(json, "pixel_columns", s->pixel_columns);
	json_number(json, "bytes", (double)s->bytes);
	json_number(json, "dense_bytes", dense);
	json_end(json);
}

static void write_json_layer(struct json *json, const char *name, const struct basis *basis,
			     const struct layer_sum *layer)
{
	json_object(json, name);
	json_number(json, "tiles_used", (double)layer->tiles_used);
	write_json_sum(json, "all", &layer->all, dense_bytes(basis, layer, BASIS_KIND_COUNT));
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		write_json_sum(json, kind_names[k], &layer->kind[k], dense_bytes(basis, layer, k));
	json_end(json);
}

static void print_json(const struct basis *basis, const struct summary *s)
{
	const struct basis_info_chunk *info = &basis->info;
	struct json json;
	double foot[2];

	json_begin_line(&json, stdout);
	json_bool(&json, "preview", basis_is_preview(basis));
	json_number(&json, "width", info->width);
	json_number(&json, "height", info->height);
	json_number(&json, "lights", info->lights);
	json_number(&json, "coarse", info->coarse);
	json_number(&json, "dome_frequency", info->dome_frequency);
	json_number(&json, "poses", info->poses);
	json_number(&json, "grounds", info->grounds);
	json_number(&json, "bytes", (double)s->bytes);
	json_number(&json, "tiles", (double)s->tiles);
	json_number(&json, "covered_pixels", (double)s->covered);
	json_number(&json, "seen_through_pixels", (double)s->seen_through);
	json_number(&json, "mirrored_pixels", (double)s->mirrored);
	json_number(&json, "mirror_look_ups", (double)s->look_ups);
	write_json_layer(&json, "shown", basis, &s->shown);
	if (s->has_exact)
		write_json_layer(&json, "exact", basis, &s->exact);
	else
		json_text(&json, "exact", NULL);
	json_number(&json, "column_cut", info->column_cut);
	json_number(&json, "object_error", info->object_error);
	json_number(&json, "ratio_error", info->ratio_error);
	json_number(&json, "sky_rms", info->sky_rms);
	json_number(&json, "sky_max", info->sky_max);
	json_number(&json, "cell_rms", info->cell_rms);
	json_number(&json, "cell_max", info->cell_max);
	json_number(&json, "noise_levels", info->noise_levels);
	json_text(&json, "camera", basis->camera);
	if (footprint_size(basis, foot))
		json_numbers(&json, "footprint", foot, 2);
	else
		json_text(&json, "footprint", NULL);
	json_array(&json, "pose_names");
	for (int p = 0; p < (int)info->poses; p++)
		json_text(&json, NULL, basis_pose_name(basis, p));
	json_end(&json);
	json_text(&json, "provenance", basis->provenance);
	json_end(&json);
}

static const struct option_row options[] = {
	{.name = "json", .kind = OPTION_FLAG, .help = "everything, for programs"}, {.name = NULL}};

static int info_command_run(const struct command *command, int argc, char **argv)
{
	bool as_json = false;
	struct fault fault = {.text = ""};
	struct summary summary;
	struct basis basis;
	const int status = command_read(command, argc, argv, options, &as_json);
	int err;

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one basis file");
	err = basis_open(&basis, argv[optind], BASIS_ALL, &fault);
	if (!err)
		err = summary_fill(&basis, &summary, &fault);
	if (err) {
		log_error("%s", fault.text);
		basis_close(&basis);
		return EXIT_FAILURE;
	}
	if (as_json)
		print_json(&basis, &summary);
	else
		print_text(&basis, &summary, argv[optind]);
	basis_close(&basis);
	return EXIT_SUCCESS;
}

const struct command info_command = {
	.name = "info",
	.usage = "FILE [--json]",
	.summary = "say what a basis file holds",
	.run = info_command_run,
};
