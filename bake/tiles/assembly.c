/* SPDX-License-Identifier: MIT */
#include "bake/tiles/assembly.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/options/options.h"

struct assembly {
	const struct plan *plan;
	struct basis_writer *writer;
	uint16_t *coverage;		 /* [height][width] */
	float *distance[BASIS_SURFACES]; /* [height][width] (basis_places.h) */
	bool placeless;			 /* a tile of the open pose came without */
	struct basis_glass *glass;	 /* the open pose's */
	size_t glass_count, glass_room;
	struct basis_mirror *mirror; /* the open pose's */
	size_t mirror_count, mirror_room;
	struct basis_footprint *feet; /* [info.poses] */
	int poses_done;
	bool footless; /* a pose came without a footprint, so none is written */
	struct ensemble_error error;
	double noise_square;
	int64_t noise_count;
	struct encode_target target;
	double worst; /* largest error / target of all tiles so far */
	struct assembly_report report;
};

/* Errors up to this multiple of the target hold it, as the provenance has six digits of the
 * target. */
#define HELD 1.00001

int assembly_open(struct assembly **assembly, const struct plan *plan, const char *path,
		  struct fault *fault)
{
	struct assembly *a = calloc(1, sizeof(*a));
	int err = -ENOMEM;

	if (a) {
		a->plan = plan;
		a->target = plan_target(plan);
		a->report.info = plan->info;
		a->coverage = calloc((size_t)plan->info.width * plan->info.height,
				     sizeof(*a->coverage));
		for (int s = 0; s < BASIS_SURFACES; s++)
			a->distance[s] = calloc((size_t)plan->info.width * plan->info.height,
						sizeof(*a->distance[s]));
		a->feet = calloc(plan->info.poses, sizeof(*a->feet));
	}
	if (!a || !a->coverage || !a->distance[0] || !a->distance[1] || !a->distance[2] || !a->feet)
		fault_say(fault, err, "%s: out of memory", path);
	else
		err = basis_writer_open(&a->writer, path, &plan->info, plan->light, plan->ground,
					plan->gather, plan->camera, fault);
	if (err)
		assembly_abandon(a);
	else
		*assembly = a;
	return err;
}

void assembly_abandon(struct assembly *a)
{
	if (!a)
		return;
	basis_writer_abandon(a->writer);
	free(a->coverage);
	for (int s = 0; s < BASIS_SURFACES; s++)
		free(a->distance[s]);
	free(a->glass);
	free(a->mirror);
	free(a->feet);
	free(a);
}

static void add_coverage(struct assembly *a, const struct finished_tile *tile)
{
	const size_t stride = a->plan->info.width;
	const uint16_t *from = tile->account.coverage;
	int left, top, columns, rows;

	plan_rectangle(a->plan, tile->tile, &left, &top, &columns, &rows);
	for (int y = top; y < top + rows; y++, from += BASIS_TILE) {
		memcpy(a->coverage + (size_t)y * stride + left, from,
		       (size_t)columns * sizeof(*from));
		for (int x = 0; x < columns; x++)
			a->report.object_seen |= from[x] > 0;
	}
}

static void add_places(struct assembly *a, const struct finished_tile *tile)
{
	const size_t stride = a->plan->info.width;
	int left, top, columns, rows;

	plan_rectangle(a->plan, tile->tile, &left, &top, &columns, &rows);
	a->placeless |= tile->account.distance[0][0] < 0;
	for (int s = 0; s < BASIS_SURFACES; s++)
		for (int y = 0; y < rows; y++)
			for (int x = 0; x < columns; x++) {
				const float d = tile->account.distance[s][y * BASIS_TILE + x];

				a->distance[s][(size_t)(top + y) * stride + (size_t)(left + x)] =
					d > 0 && d < INFINITY ? d : 0; /* a shard may hold others */
			}
}

static int add_glass(struct assembly *a, const struct finished_tile *tile, struct fault *fault)
{
	const size_t count = (size_t)tile->glass_count;

	if (!count)
		return 0;
	if (a->glass_count + count > a->glass_room) {
		const size_t room = 2 * (a->glass_count + count);
		struct basis_glass *glass = realloc(a->glass, room * sizeof(*glass));

		if (!glass)
			return fault_say(fault, -ENOMEM, "out of memory");
		a->glass = glass;
		a->glass_room = room;
	}
	memcpy(a->glass + a->glass_count, tile->glass, count * sizeof(*tile->glass));
	a->glass_count += count;
	return 0;
}

static int add_mirror(struct assembly *a, const struct finished_tile *tile, struct fault *fault)
{
	const size_t count = (size_t)tile->mirror_count;

	if (!count)
		return 0;
	if (a->mirror_count + count > a->mirror_room) {
		const size_t room = 2 * (a->mirror_count + count);
		struct basis_mirror *mirror = realloc(a->mirror, room * sizeof(*mirror));

		if (!mirror)
			return fault_say(fault, -ENOMEM, "out of memory");
		a->mirror = mirror;
		a->mirror_room = room;
	}
	memcpy(a->mirror + a->mirror_count, tile->mirror, count * sizeof(*tile->mirror));
	a->mirror_count += count;
	return 0;
}

/* Compares the errors of a tile with the target. */
static void judge_tile(struct assembly *a, const struct finished_tile *tile)
{
	const struct ensemble_error *error = &tile->account.error;
	const struct {
		const char *what, *option;
		double error, target;
	} all[] = {
		{"RMS under a sky", "--error", ensemble_sky_rms(error), a->target.rms},
		{"in a pixel under a sky", "--error RMS,MAX", error->sky_max, a->target.max},
		{"in a pixel under a single light", "--cell-error", error->cell_max,
		 a->target.cell},
	};
	struct assembly_miss *miss = &a->report.miss;
	bool held = true;

	for (size_t k = 0; k < sizeof(all) / sizeof(*all); k++) {
		const double share = all[k].error / all[k].target;

		held &= share <= HELD;
		if (share <= HELD || share <= a->worst)
			continue;
		a->worst = share;
		miss->pose = tile->pose;
		plan_rectangle(a->plan, tile->tile, &miss->x, &miss->y, &miss->width,
			       &miss->height);
		miss->what = all[k].what;
		miss->option = all[k].option;
		miss->error = all[k].error;
		miss->target = all[k].target;
	}
	miss->tiles += !held;
}

int assembly_add(struct assembly *a, const struct finished_tile *tile, struct fault *fault)
{
	const struct basis_block_payload *exact = tile->blocks + tile->shown;
	const struct tile_account *account = &tile->account;
	struct assembly_report *report = &a->report;
	int err = 0;

	if (tile->shown)
		err = basis_writer_blocks(a->writer, tile->blocks, tile->shown, fault);
	if (!err && tile->exact)
		err = basis_writer_exact_blocks(a->writer, exact, tile->exact, fault);
	if (!err)
		err = add_glass(a, tile, fault);
	if (!err)
		err = add_mirror(a, tile, fault);
	add_coverage(a, tile);
	add_places(a, tile);
	judge_tile(a, tile);
	ensemble_error_add(&a->error, &account->error);
	a->noise_square += account->noise_square;
	a->noise_count += account->noise_count;
	report->rays += account->rays;
	report->shown_bytes += finished_tile_bytes(tile->blocks, tile->shown);
	report->exact_bytes += finished_tile_bytes(exact, tile->exact);
	report->info.object_error = fmax(report->info.object_error, account->object_error);
	report->info.ratio_error = fmax(report->info.ratio_error, account->ratio_error);
	return err;
}

int assembly_pose_end(struct assembly *a, const float (*peak)[3],
		      const struct basis_footprint *foot, struct fault *fault)
{
	int err = basis_writer_pose_end(a->writer, a->coverage, peak, fault);

	if (!err && a->glass_count)
		err = basis_writer_glass(a->writer, a->glass, a->glass_count, fault);
	a->glass_count = 0;
	if (!err && a->mirror_count)
		err = basis_writer_mirror(a->writer, a->mirror, a->mirror_count, fault);
	a->mirror_count = 0;
	if (!err && !a->placeless)
		err = basis_writer_places(a->writer, (const float *const *)a->distance, fault);
	a->placeless = false;
	if (!err && foot)
		a->feet[a->poses_done] = *foot;
	a->footless |= !foot;
	a->poses_done++;
	return err;
}

int assembly_finish(struct assembly *a, struct assembly_report *report, struct fault *fault)
{
	struct basis_writer *writer = a->writer;
	char provenance[PLAN_TEXT_MAX + 128];
	struct basis_info_chunk *info = &a->report.info;
	int err = 0;

	if (a->noise_count)
		info->noise_levels = sqrt(a->noise_square / (double)a->noise_count);
	info->sky_rms = ensemble_sky_rms(&a->error);
	info->sky_max = a->error.sky_max;
	info->cell_rms = ensemble_cell_rms(&a->error);
	info->cell_max = a->error.cell_max;
	snprintf(provenance, sizeof(provenance), "%snoise_levels = %.4f\nrays = %llu\n",
		 a->plan->provenance, info->noise_levels, (unsigned long long)a->report.rays);
	if (a->plan->names)
		err = basis_writer_names(writer, a->plan->names, fault);
	if (!err && !a->footless)
		err = basis_writer_feet(writer, a->feet, fault);
	if (!err) {
		a->writer = NULL; /* finishing frees it */
		err = basis_writer_finish(writer, info, provenance, fault);
	}
	*report = a->report;
	assembly_abandon(a);
	return err;
}

int assembly_conclude(const struct assembly_miss *miss, const char *path)
{
	char pose[32] = "";

	if (!miss->tiles)
		return EXIT_SUCCESS;
	if (miss->pose)
		snprintf(pose, sizeof(pose), "pose %d, ", miss->pose);
	log_error(
		"%s: %d tile%s the error asked for; the worst (%spixels %d..%d x %d..%d) is off by "
		"%.3g levels %s, expected %.3g: take more samples or a larger %s; the file is kept",
		path, miss->tiles, miss->tiles == 1 ? " misses" : "s miss", pose, miss->x,
		miss->x + miss->width - 1, miss->y, miss->y + miss->height - 1, miss->error,
		miss->what, miss->target, miss->option);
	return EXIT_MISSED;
}
