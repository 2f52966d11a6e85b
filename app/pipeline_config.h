/* The pipeline's settings, as the configuration has them. */
#ifndef INLAY_APP_PIPELINE_CONFIG_H
#define INLAY_APP_PIPELINE_CONFIG_H

#include "app/pipeline.h"
#include "config/config.h"

struct pipeline_settings pipeline_settings_of(const struct config *config);

/* What of the basis file these settings need. */
enum basis_part pipeline_part_of(const struct config *config);

/* As basis_open(), saying also how the exact layer is made where it is missing. */
int pipeline_open_basis(struct basis *basis, const char *path, enum basis_part part,
			struct fault *fault);

#endif
