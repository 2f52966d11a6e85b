/* SPDX-License-Identifier: MIT */
/* inlay-calibrate convert: lenses between our files and those of OpenCV and ROS. */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/convert/convert.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

#define TOLERANCE_PX 0.1

struct convert_job {
	const char *in, *out, *camera;
	int as;		   /* enum lens_file; -1: by the ending of out */
	int width, height; /* side by side: --size */
	bool fisheye;
	double tolerance_px, error_px;
};

static bool path_ends_with(const char *path, const char *ending)
{
	const size_t length = strlen(path), tail = strlen(ending);

	return length > tail && !strcmp(path + length - tail, ending);
}

/* Returns the kind of file by its ending; -1: unknown. */
static int file_of(const char *path)
{
	if (path_ends_with(path, ".ini") || path_ends_with(path, ".conf"))
		return LENS_FILE_INI;
	if (path_ends_with(path, ".yml"))
		return LENS_FILE_OPENCV;
	return path_ends_with(path, ".yaml") ? LENS_FILE_ROS : -1;
}

/* ---- reading ---- */

static int lens_of_ini(struct convert_job *job, const struct lens_ini *ini, struct lens *lens,
		       struct fault *fault)
{
	if (ini->camera_given)
		return lens_of_tsai(lens, &ini->camera, job->tolerance_px, &job->error_px, fault);
	if (!job->width)
		return fault_say(
			fault, -EINVAL,
			"a [fisheye] section does not say how large the picture is, expected --size WIDTHxHEIGHT");
	return lens_of_fisheye(lens, &ini->fisheye, job->width, job->height, job->tolerance_px,
			       &job->error_px, fault);
}

static int ini_of_lens(struct convert_job *job, const struct lens *lens, struct lens_ini *ini,
		       struct fault *fault)
{
	*ini = (struct lens_ini){.camera_given = !lens->fisheye, .fisheye_given = lens->fisheye};
	if (lens->fisheye)
		return lens_to_fisheye(lens, &ini->fisheye, fault);
	return lens_to_tsai(lens, &ini->camera, job->tolerance_px, &job->error_px, fault);
}

/* Puts the file's name before a fault that does not begin with it. */
static int with_name(const char *path, int err, struct fault *fault)
{
	char text[FAULT_TEXT_MAX];

	if (!err || !strncmp(fault->text, path, strlen(path)))
		return err;
	memcpy(text, fault->text, sizeof(text));
	return fault_say(fault, err, "%s: %s", path, text);
}

static int read_in(struct convert_job *job, struct lens *lens, struct lens_ini *ini,
		   struct fault *fault)
{
	int err;

	*lens = (struct lens){.fisheye = job->fisheye, .width = job->width, .height = job->height};
	if (file_of(job->in) == LENS_FILE_INI) {
		err = lens_read_ini(ini, job->in, fault);
		if (!err)
			err = lens_of_ini(job, ini, lens, fault);
	} else {
		err = lens_read_foreign(lens, job->in, job->camera, fault);
		if (!err && job->as == LENS_FILE_INI)
			err = ini_of_lens(job, lens, ini, fault);
	}
	return with_name(job->in, err, fault);
}

/* ---- writing ---- */

/* Makes ROS's camera name from the file's name, without folder and ending; other characters become
 * _. */
static void camera_name(const char *path, char *name, size_t room)
{
	const char *slash = strrchr(path, '/');

	snprintf(name, room, "%s", slash ? slash + 1 : path);
	name[strcspn(name, ".")] = '\0';
	for (char *c = name; *c; c++)
		if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", *c))
			*c = '_';
}

static int write_out(const struct convert_job *job, const struct lens *lens,
		     const struct lens_ini *ini, struct fault *fault)
{
	struct output out = {.stream = NULL};
	char name[128];
	int err = output_open(&out, job->out, fault);

	if (err)
		return err;
	camera_name(job->out, name, sizeof(name));
	if (job->as == LENS_FILE_INI)
		lens_write_ini(out.stream, ini, job->in, job->error_px);
	else if (job->as == LENS_FILE_OPENCV)
		lens_write_opencv(out.stream, lens, job->error_px);
	else
		lens_write_ros(out.stream, lens, name, job->error_px);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}

/* ---- the command ---- */

#define AT(field) .place = offsetof(struct convert_job, field)

static const struct option_row options[] = {
	{"as", OPTION_CHOICE, AT(as), .choices = lens_file_names},
	{"size", OPTION_SIZE, AT(width)},
	{"fisheye", OPTION_FLAG, AT(fisheye)},
	{"camera", OPTION_TEXT, AT(camera)},
	{"tolerance", OPTION_REAL, AT(tolerance_px), .min = 0, .max = 1e6},
	{.name = NULL},
};

static int convert_run(const struct command *command, int argc, char **argv)
{
	struct convert_job job = {.as = -1, .tolerance_px = TOLERANCE_PX};
	struct fault fault = {.text = ""};
	struct lens_ini ini = {.camera_given = false};
	struct lens lens;
	const int status = command_read(command, argc, argv, options, &job);
	int err;

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 2 != argc)
		return command_wrong(command, "expected two files");
	job.in = argv[optind];
	job.out = argv[optind + 1];
	if (job.as < 0)
		job.as = file_of(job.out);
	if (job.as < 0)
		return command_wrong(command, "%s: expected .ini, .yml, .yaml or --as", job.out);
	if (file_of(job.in) == LENS_FILE_INI && job.as == LENS_FILE_INI)
		return command_wrong(command, "%s and %s are files of the same kind", job.in,
				     job.out);
	err = read_in(&job, &lens, &ini, &fault);
	if (!err)
		err = write_out(&job, &lens, &ini, &fault);
	if (err) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	if (job.error_px > 0)
		log_info("%s: fitted, off by at most %.3g px", job.out, job.error_px);
	return EXIT_SUCCESS;
}

const struct command convert_command = {
	.name = "convert",
	.usage = "IN OUT [options]",
	.summary = "lenses to and from the files of OpenCV and ROS, from Kalibr's",
	.help = "\n"
		"Names that end in .ini are ours, with a section [camera] or [fisheye]; those that end in\n"
		".yml are OpenCV's, in .yaml ROS's camera_info. Read are, whatever their names, OpenCV's YAML,\n"
		"ROS's files and camera_info messages as its tools print them, and Kalibr's camchain.\n"
		"What it says is the lens alone: where the camera is comes from inlay-calibrate camera\n"
		"--intrinsics OUT.ini, how a fisheye is turned from inlay-calibrate fisheye.\n\n"
		"  --as F          write ini, opencv or ros, whatever the name of OUT\n"
		"  --size WxH      of the picture, where IN does not say\n"
		"  --fisheye       IN is a fisheye's, where it does not say\n"
		"  --camera NAME   which of several cameras in IN: cam0, cam1 ...\n"
		"  --tolerance PX  what has no exact counterpart is fitted, and refused when that is off by\n"
		"                  more than this anywhere in the picture (0.1)\n",
	.run = convert_run,
};
