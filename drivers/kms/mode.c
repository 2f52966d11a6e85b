/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <math.h>

static bool is_progressive(const drmModeModeInfo *mode)
{
	return !(mode->flags & (DRM_MODE_FLAG_INTERLACE | DRM_MODE_FLAG_DBLSCAN));
}

static bool has_size(const drmModeModeInfo *mode, int width, int height)
{
	return (!width || mode->hdisplay == width) && (!height || mode->vdisplay == height);
}

/* Returns the preferred progressive mode of this size, else the first one, else -1. */
static int best_of_size(const drmModeModeInfo *modes, int count, int width, int height)
{
	int first = -1;

	for (int i = 0; i < count; i++) {
		if (!is_progressive(&modes[i]) || !has_size(&modes[i], width, height))
			continue;
		if (modes[i].type & DRM_MODE_TYPE_PREFERRED)
			return i;
		if (first < 0)
			first = i;
	}
	return first;
}

int kms_mode_choose(const drmModeModeInfo *modes, int count, int width, int height, double rate_hz)
{
	int best = best_of_size(modes, count, width, height);
	double best_distance;

	if (best < 0 || rate_hz <= 0)
		return best;
	width = modes[best].hdisplay;
	height = modes[best].vdisplay;
	best_distance = fabs(kms_mode_rate(&modes[best]) - rate_hz);
	for (int i = 0; i < count; i++) {
		const double distance = fabs(kms_mode_rate(&modes[i]) - rate_hz);

		if (is_progressive(&modes[i]) && has_size(&modes[i], width, height) &&
		    distance < best_distance) {
			best = i;
			best_distance = distance;
		}
	}
	return best;
}

int kms_mode_rank(unsigned connection, int count, const struct kms_options *options)
{
	if (connection == DRM_MODE_CONNECTED)
		return KMS_RANK_BEST;
	if (connection == DRM_MODE_UNKNOWNCONNECTION && (count || options->mode[0]))
		return 2;
	return options->force ? 1 : 0;
}

/* The mode of the option kms.mode. For a size and rate, the screen's own timing goes first if it
 * reports one: it suits that screen best. A modeline is used as it is. */
static int pick_told(const char *text, const drmModeModeInfo *modes, int count,
		     drmModeModeInfo *mode, bool *computed)
{
	bool exact;
	int listed, err = kms_timing_parse(text, mode, &exact);

	if (err)
		return err;
	listed = exact ? -1
		       : kms_mode_choose(modes, count, mode->hdisplay, mode->vdisplay,
					 kms_mode_rate(mode));
	*computed = listed < 0 || fabs(kms_mode_rate(&modes[listed]) - kms_mode_rate(mode)) > 0.5;
	if (!*computed)
		*mode = modes[listed];
	return 0;
}

int kms_mode_pick(const struct display_settings *settings, const struct kms_options *options,
		  unsigned connection, const drmModeModeInfo *modes, int count,
		  drmModeModeInfo *mode, bool *computed)
{
	int chosen;

	*computed = false;
	if (!kms_mode_rank(connection, count, options))
		return -ENOLINK;
	if (options->mode[0])
		return pick_told(options->mode, modes, count, mode, computed);
	if (!count && options->force) {
		const bool sized = settings->width && settings->height;

		/* 1024 x 768 is the most that an unknown screen can be expected to show. */
		kms_timing(sized ? settings->width : 1024, sized ? settings->height : 768,
			   settings->rate_hz > 0 ? settings->rate_hz : 60, mode);
		*computed = true;
		return 0;
	}
	chosen = kms_mode_choose(modes, count, settings->width, settings->height,
				 settings->rate_hz);
	if (chosen < 0)
		return -EINVAL;
	*mode = modes[chosen];
	return 0;
}

bool kms_mode_same(const drmModeModeInfo *a, const drmModeModeInfo *b)
{
	return a->clock == b->clock && a->flags == b->flags && a->hdisplay == b->hdisplay &&
	       a->hsync_start == b->hsync_start && a->hsync_end == b->hsync_end &&
	       a->htotal == b->htotal && a->hskew == b->hskew && a->vdisplay == b->vdisplay &&
	       a->vsync_start == b->vsync_start && a->vsync_end == b->vsync_end &&
	       a->vtotal == b->vtotal && a->vscan == b->vscan;
}
