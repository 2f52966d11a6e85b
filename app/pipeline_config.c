#include "app/pipeline_config.h"

#include <errno.h>
#include <stdio.h>

struct pipeline_settings pipeline_settings_of(const struct config *config)
{
	struct pipeline_settings settings = {
		.sampler = {.estimator = (enum light_estimator)config->fisheye.estimator,
			    .transfer = (enum transfer)config->fisheye.transfer,
			    .black_level = config->fisheye.black_level,
			    .gain = config->fisheye.gain},
		.lens = config->fisheye.lens,
		.threshold_mode = (enum threshold_mode)config->lights.threshold_mode,
		.background = (enum transfer)config->background.transfer,
		.gain = config->composite.gain,
		.threads = config->composite.threads,
		.mode = (enum compositor_mode)config->composite.mode,
		.reuse = (enum compositor_reuse)config->composite.reuse,
	};

	snprintf(settings.kernel, sizeof(settings.kernel), "%s", config->composite.kernel);
	return settings;
}

enum basis_part pipeline_part_of(const struct config *config)
{
	return config->composite.mode == COMPOSITOR_EXACT ? BASIS_WITH_EXACT : BASIS_SHOWN;
}

int pipeline_open_basis(struct basis *basis, const char *path, enum basis_part part,
			struct fault *fault)
{
	struct fault reason = {.text = ""};
	const int err = basis_open(basis, path, part, &reason);

	if (err == -ENODATA)
		return fault_say(fault, err, "%s: inlay-bake render --exact", reason.text);
	return err ? fault_say(fault, err, "%s", reason.text) : 0;
}
