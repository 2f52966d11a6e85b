/* SPDX-License-Identifier: MIT */
/* inlay-calibrate light merge. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "bake/calibrate/bracket/light_merge.h"
#include "bake/calibrate/bracket/light_rsp.h"
#include "bake/calibrate/light_job.h"
#include "hal/base/log.h"

int light_check_merge(const struct light_job *job, struct fault *fault)
{
	if (!job->output || image_name_linear(job->output, NULL) != 1)
		return fault_say(fault, -EINVAL, "expected -o FILE.hdr or FILE.pfm");
	return light_check_times(job, fault);
}

/* The curve of --curve, a LIGHT.ini or an .rsp; else sRGB. */
static int curve_of(const struct light_job *job, struct transfer_curve *curve, struct fault *fault)
{
	double apart;

	if (!job->curve || !light_is_rsp(job->curve))
		return light_curve_of(job->curve, curve, fault);
	return light_rsp_read(job->curve, curve, &apart, fault);
}

int light_command_merge(const struct light_job *job, struct fault *fault)
{
	struct image pictures[LIGHT_EXPOSURES_MAX] = {{.width = 0}};
	struct light_merged merged = {.clipped = 0};
	double time[LIGHT_EXPOSURES_MAX];
	struct transfer_curve curve;
	int err = light_times(job, time, fault);

	if (!err)
		err = curve_of(job, &curve, fault);
	if (!err)
		err = light_read_pictures(job, pictures, fault);
	if (!err)
		err = light_merge(&merged, pictures, time, job->file_count, &curve, fault);
	light_free_pictures(pictures, LIGHT_EXPOSURES_MAX);
	if (!err)
		err = image_write(job->output, &merged.picture, fault);
	image_free(&merged.picture);
	if (!err && merged.clipped > 0)
		log_warning("%.3g %% of the values are clipped in all exposures, and too dark",
			    100 * merged.clipped);
	if (!err && merged.dark > 0)
		log_info("%.3g %% of the values are black in all exposures", 100 * merged.dark);
	return err;
}
