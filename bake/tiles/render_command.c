/* SPDX-License-Identifier: MIT */
/* The command `inlay-bake render`: bakes a scene file to a basis file. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/base/commands.h"
#include "bake/encode/encoding_options.h"
#include "bake/scene/lights_options.h"
#include "bake/scene/survey.h"
#include "bake/tiles/render.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/basis/basis.h"
#include "hal/optics/dome.h"

/* Options of the command line; a number that was not given is negative. */
struct render_choices {
	const char *output;
	struct scene_lights lights;
	int width, height, samples, seed, threads;
	double noise;
	struct encoding_choices encoding;
	struct shard_place shard;
	const char *pose;
	bool quiet, print_scene, preview, no_preview;
};

/* Reads --shard I/N, where I counts from 1. */
static int read_shard(void *field, const char *option, const char *text, struct fault *fault)
{
	int index, count;
	char rest;

	if (strlen(text) > 16 || sscanf(text, "%d/%d%c", &index, &count, &rest) != 2 || index < 1 ||
	    count > SHARDS_MAX || index > count)
		return fault_say(fault, -EINVAL,
				 "%s: \"%s\", expected which of how many, such as 2/8; up to %d",
				 option, text, SHARDS_MAX);
	*(struct shard_place *)field = (struct shard_place){.index = index - 1, .count = count};
	return 0;
}

#define AT(field) .place = offsetof(struct render_choices, field)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(output)},
	LIGHTS_ROWS,
	{"size", OPTION_SIZE, AT(width)},
	{"samples", OPTION_INT, AT(samples), .min = 1, .max = 65536},
	{"noise", OPTION_REAL, AT(noise), .min = 1e-3, .max = 255},
	{"seed", OPTION_INT, AT(seed), .max = INT_MAX},
	ENCODING_ROWS,
	{"pose", OPTION_TEXT, AT(pose)},
	{"shard", OPTION_OTHER, AT(shard), .take = read_shard},
	{"threads", OPTION_INT, AT(threads), .min = 1, .max = 1024},
	{"quiet", OPTION_FLAG, AT(quiet)},
	{"preview", OPTION_FLAG, AT(preview)},
	{"no-preview", OPTION_FLAG, AT(no_preview)},
	{"print-scene", OPTION_FLAG, AT(print_scene)},
	{.name = NULL},
};

static void apply_choices(struct render_settings *s, const struct render_choices *c)
{
	if (c->lights.frequency >= 0)
		s->frequency = c->lights.frequency;
	if (c->samples >= 0) {
		s->samples = c->samples;
		s->noise_levels = 0;
	}
	if (c->noise >= 0)
		s->noise_levels = c->noise;
	if (c->seed >= 0)
		s->seed = c->seed;
	encoding_choices_apply(&c->encoding, &s->target, &s->column_cut, &s->coarse, &s->exact);
	s->shard = c->shard;
	s->pose = c->pose;
	s->threads = c->threads;
	s->quiet = c->quiet;
}

static void print_report(const struct render_choices *c, const struct render_report *report,
			 bool preview)
{
	const struct basis_info_chunk *info = &report->info;

	printf("%s: %srays %llu (%.2f million/s), time %.1f s, ", c->output,
	       preview ? "preview, " : "", (unsigned long long)report->rays,
	       (double)report->rays / report->seconds * 1e-6, report->seconds);
	if (c->shard.count) {
		printf("shard %d of %d\n", c->shard.index + 1, c->shard.count);
		return;
	}
	printf("noise %.2f levels, encoded in %.2f MB", info->noise_levels,
	       (double)report->shown_bytes * 1e-6);
	if (report->exact_bytes)
		printf(" (exact layer %.2f MB)", (double)report->exact_bytes * 1e-6);
	printf(", error in levels RMS / most: skies %.2f / %.1f, cells %.2f / %.1f\n",
	       info->sky_rms, info->sky_max, info->cell_rms, info->cell_max);
}

/* Refuses an output file that is one of the scene's own files. */
static int check_output(const struct scene_file *file, const char *path, const char *output,
			struct fault *fault)
{
	const char *read[2 + SCENE_MESHES_MAX + SCENE_KEYFRAMES_MAX + SCENE_MATERIALS_MAX];
	int count = 0;

	read[count++] = path;
	read[count++] = file->camera.file;
	for (int k = 0; k < file->mesh_count; k++)
		read[count++] = file->mesh[k].file;
	for (int k = 0; k < file->keyframe_count; k++)
		read[count++] = file->keyframe[k].file;
	for (int k = 0; k < file->material_count; k++)
		read[count++] = file->material[k].texture;
	return output_check(&output, 1, read, count, fault);
}

/* Tells whether there is a finished basis file or another file at path, which no preview may
 * replace. */
static bool file_must_stay(const char *path)
{
	struct basis basis;
	bool preview;

	if (access(path, F_OK) < 0)
		return false;
	if (basis_open(&basis, path, BASIS_SHOWN, NULL) < 0)
		return true;
	preview = basis_is_preview(&basis);
	basis_close(&basis);
	return !preview;
}

static void warn_of_nothing(const char *path, const struct render_report *report)
{
	if (!report->object_seen)
		log_warning(
			"%s: the camera sees no object; expected one in the picture: look at [camera], and at position, scale and up of [object]",
			path);
}

/* Prints how much the camera sees of each object in the first pose that is baked. If it sees
 * nothing, a scene with one pose is refused. */
static int survey_first(struct scene *scene, const struct render_choices *c, struct fault *fault)
{
	int err = scene_find_pose(scene, c->pose, fault);

	if (err)
		return err;
	err = survey_say(scene, c->quiet || c->shard.index ? NULL : stdout, fault);
	return c->pose || scene->file->poses.count == 1 ? err : 0;
}

/* Leaves a preview at the output for as long as the bake takes. Returns 1, 0 if there is another
 * file, which stays, or an error. */
static int leave_preview(struct scene *scene, const char *path, const struct render_choices *c,
			 const struct render_settings *settings, struct fault *fault)
{
	const struct render_settings preview = render_preview_of(settings);
	struct render_report report = {.rays = 0};
	int err;

	if (file_must_stay(c->output)) {
		if (!c->quiet)
			printf("%s: stays as it is until the bake is done\n", c->output);
		return 0;
	}
	err = render_run(scene, &preview, c->output, &report, fault);
	if (err)
		return err;
	warn_of_nothing(path, &report);
	if (!c->quiet) {
		print_report(c, &report, true);
		fflush(stdout);
	}
	return 1;
}

static int render_bake(const char *path, const struct render_choices *c)
{
	struct fault fault = {.text = ""};
	struct render_report report = {.rays = 0};
	struct render_settings settings;
	struct fine_list fine = {.count = 0};
	bool warned = false, unseen = false;
	struct scene *scene;
	int err = scene_open(&scene, path, c->width, c->height, &fault);

	if (!err) {
		settings = render_settings_of(scene);
		if (c->preview)
			settings = render_preview_of(&settings);
		apply_choices(&settings, c);
		if (c->lights.fine)
			settings.fine = &fine;
		if (c->lights.fine && *c->lights.fine)
			err = fine_list_read(&fine, "--fine", c->lights.fine, NULL, &fault);
		if (!err)
			err = check_output(scene->file, path, c->output, &fault);
		if (!err) {
			err = survey_first(scene, c, &fault);
			unseen = err == -ENODATA;
		}
		if (!err && !c->preview && !c->no_preview && !c->shard.count)
			err = leave_preview(scene, path, c, &settings, &fault);
		warned = err > 0;
		if (err >= 0)
			err = render_run(scene, &settings, c->output, &report, &fault);
		fine_list_free(&fine);
		scene_close(scene);
	}
	if (err) {
		log_error("%s", fault.text);
		return unseen ? EXIT_MISSED : EXIT_FAILURE;
	}
	if (!warned && !c->shard.count)
		warn_of_nothing(path, &report);
	if (!c->quiet)
		print_report(c, &report, c->preview);
	return c->preview ? EXIT_SUCCESS : assembly_conclude(&report.miss, c->output);
}

static int render_command_run(const struct command *command, int argc, char **argv)
{
	struct render_choices c = {.lights = {.frequency = -1},
				   .samples = -1,
				   .seed = -1,
				   .noise = -1,
				   .encoding = ENCODING_UNCHOSEN};
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (c.print_scene) {
		scene_file_write_sample(stdout);
		return EXIT_SUCCESS;
	}
	if (c.samples >= 0 && c.noise >= 0)
		return command_wrong(command, "--samples and --noise exclude each other");
	if (c.preview && (c.no_preview || c.shard.count))
		return command_wrong(command, "--preview and %s exclude each other",
				     c.no_preview ? "--no-preview" : "--shard");
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.output)
		return command_wrong(command, "-o OUT.inlay is missing");
	return render_bake(argv[optind], &c);
}

const struct command render_command = {
	.name = "render",
	.usage = "SCENE -o OUT.inlay [options]",
	.summary = "bake a scene: all its light transport, to a basis file",
	.help = "\n"
		"  -o FILE         the basis file: first a preview, in place of which the finished file\n"
		"                  appears when it is whole; a finished file stays until then\n" LIGHTS_HELP
		"  --size WxH      size of the picture, in pixels\n"
		"  --samples S     camera rays a pixel\n"
		"  --noise LEVELS  as many as bring the estimated standard error below this,\n"
		"                  in 8-bit levels under suns\n" ENCODING_HELP
		"  --seed K        seed of all random numbers; threads do not change the file\n"
		"  --pose P        only this one of the scene's poses: its number, from 0, or name\n"
		"  --shard I/N     only every N-th tile, from the I-th on: inlay-bake merge puts all N together\n"
		"  --threads T     default: one for each processor\n"
		"  --preview       a preview alone: few lights and samples, one bounce, unless other\n"
		"                  options say otherwise; some seconds\n"
		"  --no-preview    nothing before the finished file: for scripts\n"
		"  --quiet         print nothing but errors\n"
		"  --print-scene   a scene file with every key, its default and its meaning\n"
		"\n"
		"Options go before the scene file. bake/README.md describes the format.\n"
		"Exit code 3: the camera sees no object, and there is no file; or done, but some\n"
		"tile is off by more than was asked for, and the file is kept.\n",
	.run = render_command_run,
};
