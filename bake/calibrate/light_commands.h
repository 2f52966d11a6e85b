/* SPDX-License-Identifier: MIT */
/* The commands of `inlay-calibrate light`, in light_command_*.c. */
#ifndef INLAY_BAKE_CALIBRATE_LIGHT_COMMANDS_H
#define INLAY_BAKE_CALIBRATE_LIGHT_COMMANDS_H

#include "bake/calibrate/light_job.h"

/* Check whether a job is complete; -EINVAL: the fault says what was expected. */
int light_check_black(const struct light_job *job, struct fault *fault);
int light_check_response(const struct light_job *job, struct fault *fault);
int light_check_gain(const struct light_job *job, struct fault *fault);
int light_check_colours(const struct light_job *job, struct fault *fault);
int light_check_merge(const struct light_job *job, struct fault *fault);

/* Run a complete job: find the value, print it on standard output, write the report and, if the
 * value can be trusted, its key. Return 0; 1: not trusted, the verdict is logged; negative
 * errno. */
int light_command_black(const struct light_job *job, struct fault *fault);
int light_command_response(const struct light_job *job, struct fault *fault);
int light_command_gain(const struct light_job *job, struct fault *fault);
int light_command_colours(const struct light_job *job, struct fault *fault);
int light_command_merge(const struct light_job *job, struct fault *fault);

/* Reads the job's 8-bit pictures, all of one size. Returns errors of image_read(), -EINVAL. */
int light_read_pictures(const struct light_job *job, struct image *pictures, struct fault *fault);
void light_free_pictures(struct image *pictures, int count);

#endif
