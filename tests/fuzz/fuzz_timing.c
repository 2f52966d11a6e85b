/* SPDX-License-Identifier: MIT */
/* Any bytes as the mode that is asked for, behind the modes that a screen's EDID gave: none, or one
 * whose picture lies inside its blanking.
 *
 * reaches: mode.c:kms_timing_parse mode.c:parse_modeline mode.c:cvt_reduced
 * mode.c:kms_mode_pick mode.c:kms_mode_choose
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if WITH_KMS
#include "drivers/kms/kms.h"

enum { MODES = 4 };
#endif

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

#if WITH_KMS
static void check_timing(const char *text)
{
	drmModeModeInfo mode;
	bool exact;

	if (kms_timing_parse(text, &mode, &exact))
		return;
	if (!isfinite(kms_mode_rate(&mode)) || mode.hdisplay > mode.hsync_start ||
	    mode.hsync_end > mode.htotal || mode.vdisplay > mode.vsync_start ||
	    mode.vsync_end > mode.vtotal)
		abort();
}
#endif

/* The input: text, a NUL, the fields of struct display_settings, modes. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
#if WITH_KMS
	struct kms_options options = {.scaling = KMS_SCALING_AUTO};
	struct display_settings settings = {.width = 0};
	drmModeModeInfo modes[MODES] = {{.clock = 0}}, mode;
	const size_t most = sizeof(options.mode) - 1;
	const size_t text = strnlen((const char *)data, bytes < most ? bytes : most);
	size_t left = bytes - text, count;
	bool computed;

	memcpy(options.mode, data, text);
	check_timing(options.mode);
	data += text;
	if (left < 5)
		return 0;
	settings.width = data[1] * 16;
	settings.height = data[2] * 9;
	settings.rate_hz = data[3];
	options.force = data[4] & 1;
	left -= 5;
	memcpy(modes, data + 5, left < sizeof(modes) ? left : sizeof(modes));
	count = left / sizeof(*modes);
	(void)kms_mode_pick(&settings, &options, DRM_MODE_CONNECTED, modes,
			    count < MODES ? (int)count : MODES, &mode, &computed);
#else
	(void)data;
	(void)bytes;
#endif
	return 0;
}
