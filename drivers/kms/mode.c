#include <math.h>

#include "drivers/kms/kms.h"

double kms_mode_rate(const drmModeModeInfo *mode)
{
	double lines = mode->vtotal;

	if (mode->flags & DRM_MODE_FLAG_INTERLACE)
		lines /= 2;
	if (mode->flags & DRM_MODE_FLAG_DBLSCAN)
		lines *= 2;
	if (mode->vscan > 1)
		lines *= mode->vscan;
	return lines > 0 && mode->htotal ? mode->clock * 1000.0 / (mode->htotal * lines) : 0;
}

static bool is_progressive(const drmModeModeInfo *mode)
{
	return !(mode->flags & (DRM_MODE_FLAG_INTERLACE | DRM_MODE_FLAG_DBLSCAN));
}

static bool has_size(const drmModeModeInfo *mode, int width, int height)
{
	return (!width || mode->hdisplay == width) && (!height || mode->vdisplay == height);
}

/* The preferred mode of this size, else the first, else -1. */
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
