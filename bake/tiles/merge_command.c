/* SPDX-License-Identifier: MIT */
/* The command `inlay-bake merge`: joins the shards of a bake to its basis file. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/tiles/assembly.h"
#include "bake/tiles/peaks.h"
#include "bake/tiles/shard.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

static const struct option_row options[] = {{.name = "output"}, {.name = NULL}};

/* The shards of a bake by their index. */
struct shards {
	struct shard *shard;
	char **path;
	int count;
};

static void shards_close(struct shards *all)
{
	for (int k = 0; k < all->count; k++)
		shard_close(&all->shard[k]);
	free(all->shard);
	free(all->path);
}

/* Puts a shard at its index. -EINVAL: it does not belong with the others. */
static int shards_place(struct shards *all, struct shard *shard, char *path, struct fault *fault)
{
	const struct shard *first = NULL;
	const int at = shard->place.index;

	for (int k = 0; k < all->count && !first; k++)
		first = all->path[k] ? &all->shard[k] : NULL;
	if (shard->place.count != all->count)
		return fault_say(fault, -EINVAL,
				 "%s: is one of %d shards, expected one of the %d given", path,
				 shard->place.count, all->count);
	if (all->path[at])
		return fault_say(fault, -EINVAL,
				 "%s: is shard %d of %d, as %s is; expected each once", path,
				 at + 1, all->count, all->path[at]);
	if (first && !shard_same_bake(first, shard))
		return fault_say(
			fault, -EINVAL,
			"%s: is of another bake than %s; expected the same scene and options", path,
			all->path[first - all->shard]);
	all->shard[at] = *shard;
	all->path[at] = path;
	return 0;
}

static int shards_open(struct shards *all, char **paths, int count, struct fault *fault)
{
	int err = 0;

	all->shard = calloc((size_t)count, sizeof(*all->shard));
	all->path = calloc((size_t)count, sizeof(*all->path));
	if (!all->shard || !all->path)
		return fault_say(fault, -ENOMEM, "out of memory");
	all->count = count;
	for (int k = 0; !err && k < count; k++) {
		struct shard shard;

		err = shard_open(&shard, paths[k], fault);
		if (err)
			return err;
		err = shards_place(all, &shard, paths[k], fault);
		if (err)
			shard_close(&shard);
	}
	return err;
}

/* Adds the shard's next tile to the file. Returns 1; 0: the pose has no more tiles; or an error. */
static int pass_on(struct shard *shard, struct assembly *assembly, struct fault *fault)
{
	struct finished_tile tile = {.blocks = NULL};
	int err = shard_next(shard, &tile, fault);

	if (err == 1) {
		const int failed = assembly_add(assembly, &tile, fault);

		err = failed ? failed : 1;
	}
	finished_tile_free(&tile);
	return err;
}

static int merge_pose(struct shards *all, int pose, struct assembly *assembly, struct fault *fault)
{
	const int tiles = plan_tiles(&all->shard[0].plan);
	float(*peak)[3];
	int more = 1;

	for (int t = 0; t < tiles && more == 1; t++)
		more = pass_on(&all->shard[((int64_t)pose * tiles + t) % all->count], assembly,
			       fault);
	/* Each shard is asked once more than it has tiles, as a pose ends with its peaks. */
	for (int k = 0; k < all->count && more >= 0; k++)
		more = pass_on(&all->shard[k], assembly, fault);
	if (more < 0)
		return more;
	peak = all->shard[0].peak;
	for (int k = 1; k < all->count; k++)
		peaks_join(peak, (const float(*)[3])all->shard[k].peak,
			   (int)all->shard[0].plan.info.lights);
	return assembly_pose_end(assembly, (const float(*)[3])peak, &all->shard[0].foot, fault);
}

static int merge_poses(struct shards *all, struct assembly *assembly, struct fault *fault)
{
	const int poses = (int)all->shard[0].plan.info.poses;
	int err = 0;

	for (int pose = 0; pose < poses && !err; pose++)
		err = merge_pose(all, pose, assembly, fault);
	return err;
}

static int merge_shards(const char *output, char **paths, int count, struct assembly_report *report,
			struct fault *fault)
{
	struct shards all = {.count = 0};
	struct assembly *assembly = NULL;
	int err = output_check(&output, 1, (const char *const *)paths, count, fault);

	if (!err)
		err = shards_open(&all, paths, count, fault);
	if (!err)
		err = assembly_open(&assembly, &all.shard[0].plan, output, fault);
	if (!err)
		err = merge_poses(&all, assembly, fault);
	if (!err) {
		err = assembly_finish(assembly, report, fault);
		assembly = NULL;
	}
	assembly_abandon(assembly);
	shards_close(&all);
	return err;
}

static int merge_command_run(const struct command *command, int argc, char **argv)
{
	struct fault fault = {.text = ""};
	const char *output = NULL;
	struct assembly_report report;
	const int status = command_read(command, argc, argv, options, &output);

	if (status != COMMAND_GOES_ON)
		return status;
	if (!output)
		return command_wrong(command, "-o OUT.inlay is missing");
	if (optind == argc || argc - optind > SHARDS_MAX)
		return command_wrong(command, "expected the shards of one bake, 1 to %d",
				     SHARDS_MAX);
	if (merge_shards(output, argv + optind, argc - optind, &report, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return assembly_conclude(&report.miss, output);
}

const struct command merge_command = {
	.name = "merge",
	.usage = "SHARD... -o OUT.inlay",
	.summary = "put the shards of a bake together",
	.help = "\n"
		"  -o FILE         the basis file; appears when it is whole\n"
		"\n"
		"All shards of one bake (inlay-bake render --shard 1/n ... n/n), in any order. The file is\n"
		"the same, bit for bit, as one run without shards makes. Exit code 3: done, but some tile is\n"
		"off by more than was asked for; the file is kept.\n",
	.run = merge_command_run,
};
