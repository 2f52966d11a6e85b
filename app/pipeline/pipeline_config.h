/* SPDX-License-Identifier: MIT */
/* The pipeline's settings, as the configuration has them. */
#ifndef INLAY_APP_PIPELINE_PIPELINE_CONFIG_H
#define INLAY_APP_PIPELINE_PIPELINE_CONFIG_H

#include "app/pipeline/pipeline.h"
#include "config/config.h"

struct pipeline_settings pipeline_settings_of(const struct config *config);

/* What of the basis file these settings need. */
enum basis_part pipeline_part_of(const struct config *config);

/* As basis_open(), saying also how the exact layer is made where it is missing. */
int pipeline_open_basis(struct basis *basis, const char *path, enum basis_part part,
			struct fault *fault);

/* What only the basis and the processor can tell of a configuration; without a basis (NULL), the
 * processor alone. Logs each fault. 0; -EINVAL: the basis has no such pose or place; -ENOTSUP: the
 * processor has no such kernel. */
int pipeline_config_check(const struct config *config, const struct basis *basis);

#endif
