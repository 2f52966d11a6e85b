/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/light_job.h"

#include <errno.h>
#include <string.h>

#include "bake/calibrate/bracket/light_exif.h"
#include "bake/calibrate/response/light_file.h"

int light_conclude(const struct light_job *job, const struct verdict *verdict, const char *key,
		   const char *text, const char *comment, struct fault *fault)
{
	if (verdict_end(verdict))
		return 1;
	if (!job->output)
		return 0;
	return light_file_set(job->output, key, text, comment, fault);
}

bool light_is_rsp(const char *path)
{
	const size_t length = strlen(path);

	return length > 4 && !strcmp(path + length - 4, ".rsp");
}

int light_check_times(const struct light_job *job, struct fault *fault)
{
	if (job->file_count >= 2 && job->file_count <= LIGHT_EXPOSURES_MAX &&
	    (!job->times || job->times == job->file_count))
		return 0;
	return fault_say(fault, -EINVAL,
			 "there are %d pictures and %d --times, expected as many of each, 2 to %d",
			 job->file_count, job->times, LIGHT_EXPOSURES_MAX);
}

int light_times(const struct light_job *job, double *time, struct fault *fault)
{
	int err = 0;

	if (job->times)
		memcpy(time, job->time, (size_t)job->times * sizeof(*time));
	for (int k = 0; !job->times && k < job->file_count && !err; k++)
		err = light_exif_exposure(job->files[k], &time[k], fault);
	return err;
}

int light_curve_of(const char *path, struct transfer_curve *curve, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	struct response measured;
	int err = 0;

	response_begin(&measured);
	if (path)
		err = response_read(&measured, path, &report);
	if (err)
		return fault_say(fault, err, "%s", report.first.text);
	*curve = response_curve(&measured, TRANSFER_SRGB, 0);
	return 0;
}
