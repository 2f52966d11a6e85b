/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/light_job.h"

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

int light_curve_of(const char *path, int transfer, struct transfer_curve *curve,
		   struct fault *fault)
{
	struct ini_report report = {.count = 0};
	struct response measured;
	int err = 0;

	response_begin(&measured);
	if (path)
		err = response_read(&measured, path, &report);
	if (err)
		return fault_say(fault, err, "%s", report.first.text);
	*curve = response_curve(&measured, (enum transfer)transfer, 0);
	return 0;
}
