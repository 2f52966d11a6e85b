/* SPDX-License-Identifier: MIT */
#include "tests/support/plain_pipeline.h"

struct pipeline_settings plain_pipeline(int threads)
{
	return (struct pipeline_settings){
		.sampler = {.curve = {.named = TRANSFER_SRGB}, .gain = 1},
		.lens = {.field_deg = 90},
		.threshold_mode = THRESHOLD_DROP,
		.background = {.named = TRANSFER_SRGB},
		.gain = 1,
		.threads = threads,
	};
}
