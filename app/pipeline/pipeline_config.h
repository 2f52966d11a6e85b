/* SPDX-License-Identifier: MIT */
/* From the configuration to the pipeline's settings. */
#ifndef INLAY_APP_PIPELINE_PIPELINE_CONFIG_H
#define INLAY_APP_PIPELINE_PIPELINE_CONFIG_H

#include "app/pipeline/pipeline.h"
#include "config/config.h"

struct pipeline_settings pipeline_settings_of(const struct config *config);

/* Returns which layers of the basis these settings need. */
enum basis_part pipeline_part_of(const struct config *config);

/* Opens a basis as basis_open() does; where the exact layer is missing, the fault also says how to
 * make it. */
int pipeline_open_basis(struct basis *basis, const char *path, enum basis_part part,
			struct fault *fault);

/* Checks what depends on the basis (NULL: left out) and the processor. Logs each fault. 0; -EINVAL:
 * the basis has no such pose or patch; -ENOTSUP: the processor has no such kernel. *mask is set
 * where there is a basis, as pipeline_read_mask() has it. */
int pipeline_config_check(const struct config *config, const struct basis *basis, uint8_t **mask);

#endif
