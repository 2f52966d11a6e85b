/* Private to app/pipeline*.c. */
#ifndef INLAY_APP_PIPELINE_PARTS_H
#define INLAY_APP_PIPELINE_PARTS_H

#include "app/pipeline.h"

/* Waits for what pipeline_relight() has begun, and forgets it. */
void pipeline_relight_end(struct pipeline *pipeline);

#endif
