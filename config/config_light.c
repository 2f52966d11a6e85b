/* SPDX-License-Identifier: MIT */
/* Checks the keys that concern the light against each other. */
#include "config/config_light.h"

#include <math.h>
#include <string.h>

#include "config/config_complain.h"
#include "hal/lights/exposure_schedule.h"

int config_exposures(const struct config_fisheye *fisheye)
{
	int count = 0;

	while (count < EXPOSURES_MAX && fisheye->exposures[count] > 0)
		count++;
	return count;
}

int config_exposure_delay(const struct config_fisheye *fisheye)
{
	if (fisheye->exposure_delay >= 0)
		return fisheye->exposure_delay;
	return fisheye->measured.delay <= EXPOSURE_DELAY_MAX ? fisheye->measured.delay : -1;
}

static void check_exposures(const struct config *config, struct ini_report *report)
{
	const struct config_fisheye *fisheye = &config->fisheye;
	const int count = config_exposures(fisheye);

	if (count == 1)
		config_complain(config, report,
				"[fisheye] exposures: is one value, expected 2 to %d, or none",
				EXPOSURES_MAX);
	for (int k = 1; k < count; k++)
		if (!(fisheye->exposures[k] <= fisheye->exposures[k - 1] / 1.5))
			config_complain(
				config, report,
				"[fisheye] exposures: %g comes after %g, expected each to be at most two thirds of the one before it",
				fisheye->exposures[k], fisheye->exposures[k - 1]);
	if (count && !*fisheye->exposure_control)
		config_complain(
			config, report,
			"[fisheye] exposure_control: is empty, expected the name of a control");
	if (count && (!strcmp(fisheye->view.camera, config->background.view.camera) ||
		      !strcmp(fisheye->view.camera, config->scene.view.camera)))
		config_complain(
			config, report,
			"[fisheye] exposures: camera %.60s is seen by another view too, expected a camera of its own",
			fisheye->view.camera);
}

static void check_patch(const struct config *config, struct ini_report *report)
{
	const double *patch = config->background.patch;

	for (int k = 0; k < 4; k++)
		if (patch[k] != floor(patch[k]) || (patch[2] > 0) != (patch[3] > 0)) {
			config_complain(
				config, report,
				"[background] ground_patch: is %g %g %g %g, expected whole pixels, and a width and a height",
				patch[0], patch[1], patch[2], patch[3]);
			return;
		}
}

void config_check_light(const struct config *config, struct ini_report *report)
{
	check_exposures(config, report);
	check_patch(config, report);
}
