#include "app/pipeline_config.h"

struct pipeline_settings pipeline_settings_of(const struct config *config)
{
	return (struct pipeline_settings){
		.sampler = {.estimator = (enum light_estimator)config->fisheye.estimator,
			    .transfer = (enum transfer)config->fisheye.transfer,
			    .black_level = config->fisheye.black_level,
			    .gain = config->fisheye.gain},
		.lens = config->fisheye.lens,
		.threshold_mode = (enum threshold_mode)config->lights.threshold_mode,
		.background = (enum transfer)config->background.transfer,
		.gain = config->composite.gain,
		.threads = config->composite.threads,
	};
}
