/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_rows.h"

#include <stddef.h>

#include "hal/base/processor.h"

const struct frame_rows frame_rows_c = {
	.name = "c",
	.yuyv = ycbcr_row_yuyv,
	.uyvy = ycbcr_row_uyvy,
	.nv12 = ycbcr_row_nv12,
	.grey = ycbcr_row_grey,
	.reverse = bgrx_row_reverse,
};

const struct frame_rows *const frame_rows_all[] = {
	&frame_rows_c,
#if defined(__x86_64__)
	&frame_rows_avx2,
#elif defined(__aarch64__)
	&frame_rows_neon,
#endif
	NULL,
};

const struct frame_rows *frame_rows_choose(void)
{
	const unsigned features = processor_features_allowed(NULL);
	const struct frame_rows *chosen = frame_rows_all[0];

	for (int i = 1; frame_rows_all[i]; i++) {
		if ((frame_rows_all[i]->needs & ~features) == 0)
			chosen = frame_rows_all[i];
	}
	return chosen;
}
