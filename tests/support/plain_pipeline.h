/* SPDX-License-Identifier: MIT */
/* Settings of a pipeline for tests that are about something else. */
#ifndef INLAY_TESTS_SUPPORT_PLAIN_PIPELINE_H
#define INLAY_TESTS_SUPPORT_PLAIN_PIPELINE_H

#include "app/pipeline/pipeline.h"

/* sRGB cameras, a fisheye of 90 degrees, light by cells, gain 1, dropped light not given back. */
struct pipeline_settings plain_pipeline(int threads);

#endif
