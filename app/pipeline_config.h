/* The pipeline's settings, as the configuration has them. */
#ifndef INLAY_APP_PIPELINE_CONFIG_H
#define INLAY_APP_PIPELINE_CONFIG_H

#include "app/pipeline.h"
#include "config/config.h"

struct pipeline_settings pipeline_settings_of(const struct config *config);

#endif
