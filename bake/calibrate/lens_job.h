/* SPDX-License-Identifier: MIT */
/* Shared by the commands that calibrate a lens: command line, report, exit status. */
#ifndef INLAY_BAKE_CALIBRATE_LENS_JOB_H
#define INLAY_BAKE_CALIBRATE_LENS_JOB_H

#include <stdbool.h>

#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/observe/gather.h"
#include "hal/options/options.h"

/* Last rows of a command whose AT(lens) is a struct lens_job. */
/* clang-format off */
#define LENS_ROWS										   \
	{"report", OPTION_TEXT, AT(lens.report)},						   \
	{"force", OPTION_FLAG, AT(lens.force)},							   \
	{"output", OPTION_TEXT, AT(lens.output)},						   \
	{.name = NULL}
/* clang-format on */

struct lens_job {
	char **file; /* files named by the source's option and the words that follow */
	int files;
	bool anew;	    /* the output may be one of them: a known lens gets a falloff */
	bool more;	    /* more words may follow */
	const char *report; /* NULL: none */
	const char *output;
	bool force;
};

/* Functions of one command; job is the struct that contains its lens_job. */
struct lens_calls {
	const struct option_row *rows;
	/* checks whether the options go together */
	int (*check)(void *job, struct fault *fault);
	int (*work)(void *job, struct fault *fault); /* calibrates: 0; 1: not trusted; -errno */
};

/* Runs a command and returns its exit status. */
int lens_job_run(const struct command *command, int argc, char **argv,
		 const struct lens_calls *calls, struct lens_job *lens, void *job);

/* Checks that --board is given if and only if pictures of a board are the source. -EINVAL. */
int lens_job_check_board(bool of_board, const char *board, struct fault *fault);

/* Index of the view that the value of an option names, by file or by number from 1. -ENOENT: that
 * photograph shows no board; -EINVAL: there is none. */
int lens_job_view(const char *option, const char *value, const struct gathering *all,
		  struct fault *fault);

/* Writes the report, if one is wanted. Returns what calibration_report_write() returns. */
int lens_job_report(const struct lens_job *lens, const struct gathering *all,
		    const struct finding *finding, struct fault *fault);

#endif
