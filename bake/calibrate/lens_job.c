/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/lens_job.h"

#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "bake/calibrate/report/report.h"
#include "hal/base/log.h"

static int take_words(struct lens_job *lens, int argc, char **argv, struct fault *fault)
{
	for (; optind < argc; optind++) {
		if (!lens->more)
			return fault_say(fault, -EINVAL, "\"%s\" is one argument too many",
					 argv[optind]);
		lens->file[lens->files++] = argv[optind];
	}
	return 0;
}

/* Refuses to overwrite an input file with the result. */
static int check_output(const struct lens_job *lens, struct fault *fault)
{
	struct stat in, out;

	if (!lens->output)
		return fault_say(fault, -EINVAL, "-o is missing");
	for (int i = 0; i < lens->files && !lens->anew && !stat(lens->output, &out); i++)
		if (!stat(lens->file[i], &in) && in.st_dev == out.st_dev && in.st_ino == out.st_ino)
			return fault_say(fault, -EINVAL,
					 "-o %s: that file is to be read, expected another one",
					 lens->output);
	return 0;
}

static int lens_run_parsed(const struct command *command, int argc, char **argv,
			   const struct lens_calls *calls, struct lens_job *lens, void *job)
{
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, calls->rows, job);
	int err;

	if (status != COMMAND_GOES_ON)
		return status;
	err = take_words(lens, argc, argv, &fault);
	if (!err)
		err = calls->check(job, &fault);
	if (!err)
		err = check_output(lens, &fault);
	if (err)
		return command_wrong(command, "%s", fault.text);
	err = calls->work(job, &fault);
	if (err < 0)
		log_error("%s", fault.text);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

int lens_job_run(const struct command *command, int argc, char **argv,
		 const struct lens_calls *calls, struct lens_job *lens, void *job)
{
	int status;

	lens->file = calloc((size_t)argc, sizeof(*lens->file));
	if (!lens->file) {
		log_error("out of memory");
		return EXIT_FAILURE;
	}
	status = lens_run_parsed(command, argc, argv, calls, lens, job);
	free(lens->file);
	lens->file = NULL;
	return status;
}

int lens_job_check_board(bool of_board, const char *board, struct fault *fault)
{
	if (of_board == (board != NULL))
		return 0;
	return fault_say(fault, -EINVAL,
			 board ? "--board goes with --images or --live" : "--board is missing");
}

int lens_job_view(const char *option, const char *value, const struct gathering *all,
		  struct fault *fault)
{
	const char *boardless;
	const int view = gather_view(all, value, &boardless);

	if (view == -ENOENT)
		return fault_say(
			fault, view,
			"%s: is to show where the world is, but shows no board: expected another photograph by %s",
			boardless, option);
	if (view < 0)
		return fault_say(fault, view,
				 "%s: \"%s\", expected a file, or its number of 1 to %d", option,
				 value, all->seen.pictures);
	return view;
}

int lens_job_report(const struct lens_job *lens, const struct gathering *all,
		    const struct finding *finding, struct fault *fault)
{
	const struct image **picture;
	int err;

	if (!lens->report)
		return 0;
	picture = calloc((size_t)(all->seen.views + all->pictures) + 1, sizeof(*picture));
	if (!picture)
		return fault_say(fault, -ENOMEM, "%s: out of memory", lens->report);
	for (int v = 0; v < all->pictures; v++)
		picture[v] = all->picture[v].u8 ? &all->picture[v]
						: NULL; /* linear light is not drawn */
	err = calibration_report_write(lens->report, finding, picture, fault);
	free(picture);
	return err;
}
