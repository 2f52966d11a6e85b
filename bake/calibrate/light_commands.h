/* SPDX-License-Identifier: MIT */
/* The commands below inlay-calibrate light, one light_command_*.c for one or two of them. */
#ifndef INLAY_BAKE_CALIBRATE_LIGHT_COMMANDS_H
#define INLAY_BAKE_CALIBRATE_LIGHT_COMMANDS_H

#include "bake/calibrate/light_job.h"

/* Whether what was asked for is whole; -EINVAL: the fault says what was expected. */
int light_check_black(const struct light_job *job, struct fault *fault);
int light_check_response(const struct light_job *job, struct fault *fault);
int light_check_gain(const struct light_job *job, struct fault *fault);
int light_check_colours(const struct light_job *job, struct fault *fault);
int light_check_delay(const struct light_job *job, struct fault *fault);

/* Of a job that is whole. Each finds, says what it has found on standard output, writes its report
 * and, if that can be trusted, its key. 0; 1: it cannot be trusted, and the verdict is said;
 * negative errno. */
int light_command_black(const struct light_job *job, struct fault *fault);
int light_command_response(const struct light_job *job, struct fault *fault);
int light_command_gain(const struct light_job *job, struct fault *fault);
int light_command_colours(const struct light_job *job, struct fault *fault);
int light_command_delay(const struct light_job *job, struct fault *fault);

#endif
