/* SPDX-License-Identifier: MIT */
/* Reports of the light commands: a page, its tables, and light.json for programs. An
 * earlier report in the folder is replaced. Errors are those of bake/base/report_page.h. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_REPORT_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_REPORT_H

#include "bake/calibrate/response/light_black.h"
#include "bake/calibrate/response/light_colours.h"
#include "bake/calibrate/response/light_gain.h"
#include "bake/calibrate/response/light_response.h"

int light_report_black(const char *folder, const struct light_black *black, struct fault *fault);
int light_report_response(const char *folder, const struct light_response *found,
			  struct fault *fault);
int light_report_gain(const char *folder, const struct light_gain *found,
		      const struct light_pair *pairs, struct fault *fault);
int light_report_colours(const char *folder, const struct light_colours *found,
			 struct fault *fault);

#endif
