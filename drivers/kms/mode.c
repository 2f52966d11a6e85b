/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "drivers/kms/kms.h"
#include "hal/base/number.h"

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

#define SYNC_POSITIVE (DRM_MODE_FLAG_PHSYNC | DRM_MODE_FLAG_PVSYNC)
#define SYNC_NEGATIVE (DRM_MODE_FLAG_NHSYNC | DRM_MODE_FLAG_NVSYNC)

/* Standard timings, which every screen of these sizes accepts: VESA DMT and, for the sizes of
 * television, CTA-861. */
static const struct {
	uint32_t clock;		     /* kHz */
	uint16_t across[4], down[4]; /* active, sync start, sync end, total; px and lines */
	uint32_t flags;
} standards[] = {
	{25175, {640, 656, 752, 800}, {480, 490, 492, 525}, SYNC_NEGATIVE},
	{40000, {800, 840, 968, 1056}, {600, 601, 605, 628}, SYNC_POSITIVE},
	{65000, {1024, 1048, 1184, 1344}, {768, 771, 777, 806}, SYNC_NEGATIVE},
	{74250, {1280, 1390, 1430, 1650}, {720, 725, 730, 750}, SYNC_POSITIVE},
	{74250, {1280, 1720, 1760, 1980}, {720, 725, 730, 750}, SYNC_POSITIVE},
	{108000, {1280, 1328, 1440, 1688}, {1024, 1025, 1028, 1066}, SYNC_POSITIVE},
	{85500, {1366, 1436, 1579, 1792}, {768, 771, 774, 798}, SYNC_POSITIVE},
	{148500, {1920, 2008, 2052, 2200}, {1080, 1084, 1089, 1125}, SYNC_POSITIVE},
	{148500, {1920, 2448, 2492, 2640}, {1080, 1084, 1089, 1125}, SYNC_POSITIVE},
	{297000, {3840, 4016, 4104, 4400}, {2160, 2168, 2178, 2250}, SYNC_POSITIVE},
};

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

static void timing_fill(drmModeModeInfo *mode, uint32_t clock, const uint16_t across[4],
			const uint16_t down[4], uint32_t flags)
{
	*mode = (drmModeModeInfo){
		.clock = clock,
		.hdisplay = across[0],
		.hsync_start = across[1],
		.hsync_end = across[2],
		.htotal = across[3],
		.vdisplay = down[0],
		.vsync_start = down[1],
		.vsync_end = down[2],
		.vtotal = down[3],
		.flags = flags,
		.type = DRM_MODE_TYPE_USERDEF,
	};
	mode->vrefresh = (uint32_t)lrint(kms_mode_rate(mode));
	snprintf(mode->name, sizeof(mode->name), "%ux%u", across[0], down[0]);
}

/* CVT encodes the aspect ratio in the number of vertical sync lines. */
static int cvt_sync_lines(int width, int height)
{
	static const struct {
		int across, down, lines;
	} shapes[] = {{4, 3, 4}, {16, 9, 5}, {16, 10, 6}, {5, 4, 7}, {15, 9, 7}};

	for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++)
		if (width * shapes[i].down == height * shapes[i].across)
			return shapes[i].lines;
	return 10;
}

/* VESA Coordinated Video Timings 1.1, reduced blanking. */
static void cvt_reduced(int width, int height, double rate_hz, drmModeModeInfo *mode)
{
	const double blank_us = 460, clock_step_khz = 250;
	const int across_blank = 160, across_front = 48, across_sync = 32;
	const int front = 3, back_least = 6, sync = cvt_sync_lines(width, height);
	const double line_us = (1e6 / rate_hz - blank_us) / height;
	const int blank = (int)fmax(floor(blank_us / line_us) + 1, front + sync + back_least);
	const int total = height + blank;
	const double clock_khz = rate_hz * total * (width + across_blank) / 1000;
	const uint16_t across[4] = {(uint16_t)width, (uint16_t)(width + across_front),
				    (uint16_t)(width + across_front + across_sync),
				    (uint16_t)(width + across_blank)};
	const uint16_t down[4] = {(uint16_t)height, (uint16_t)(height + front),
				  (uint16_t)(height + front + sync), (uint16_t)total};

	timing_fill(mode, (uint32_t)(clock_step_khz * floor(clock_khz / clock_step_khz)), across,
		    down, DRM_MODE_FLAG_PHSYNC | DRM_MODE_FLAG_NVSYNC);
}

void kms_timing(int width, int height, double rate_hz, drmModeModeInfo *mode)
{
	for (size_t i = 0; i < sizeof(standards) / sizeof(standards[0]); i++) {
		if (standards[i].across[0] != width || standards[i].down[0] != height)
			continue;
		timing_fill(mode, standards[i].clock, standards[i].across, standards[i].down,
			    standards[i].flags);
		if (fabs(kms_mode_rate(mode) - rate_hz) < 0.5)
			return;
	}
	cvt_reduced(width, height, rate_hz, mode);
}

static int parse_size(const char *text, drmModeModeInfo *mode)
{
	int width, height, used = 0;
	double rate_hz = 60;

	if (sscanf(text, "%5dx%5d%n", &width, &height, &used) != 2)
		return -EINVAL;
	text += used;
	if (*text == '@' ? number_of(text + 1, &rate_hz) < 0 : *text)
		return -EINVAL;
	if (width < 64 || width > 16384 || height < 64 || height > 16384 ||
	    !(rate_hz >= 10 && rate_hz <= 500))
		return -EINVAL;
	kms_timing(width, height, rate_hz, mode);
	return 0;
}

static bool timing_rises(const uint16_t line[4])
{
	return line[0] >= 64 && line[0] <= line[1] && line[1] < line[2] && line[2] <= line[3];
}

static int parse_flags(const char *text, uint32_t *flags)
{
	static const struct {
		const char *name;
		uint32_t flag;
	} names[] = {
		{"+hsync", DRM_MODE_FLAG_PHSYNC},
		{"-hsync", DRM_MODE_FLAG_NHSYNC},
		{"+vsync", DRM_MODE_FLAG_PVSYNC},
		{"-vsync", DRM_MODE_FLAG_NVSYNC},
	};
	char word[16];
	int used;

	*flags = 0;
	while (sscanf(text, "%15s%n", word, &used) == 1) {
		size_t i = 0;

		while (i < 4 && strcasecmp(word, names[i].name))
			i++;
		if (i == 4)
			return -EINVAL;
		*flags |= names[i].flag;
		text += used;
	}
	return 0;
}

static int parse_modeline(const char *text, drmModeModeInfo *mode)
{
	uint16_t a[4], d[4];
	uint32_t flags;
	double clock_mhz;
	int used = 0;

	if (!strncasecmp(text, "modeline", 8))
		text += 8;
	while (isspace((unsigned char)*text))
		text++;
	if (*text == '"') {
		text = strchr(text + 1, '"');
		if (!text)
			return -EINVAL;
		text++;
	}
	if (sscanf(text, "%lf %5hu %5hu %5hu %5hu %5hu %5hu %5hu %5hu%n", &clock_mhz, &a[0], &a[1],
		   &a[2], &a[3], &d[0], &d[1], &d[2], &d[3], &used) != 9 ||
	    !(clock_mhz >= 1 && clock_mhz <= 4000) || !timing_rises(a) || !timing_rises(d) ||
	    parse_flags(text + used, &flags))
		return -EINVAL;
	timing_fill(mode, (uint32_t)lrint(clock_mhz * 1000), a, d, flags);
	return 0;
}

int kms_timing_parse(const char *text, drmModeModeInfo *mode, bool *exact)
{
	*exact = false;
	if (!parse_size(text, mode))
		return 0;
	*exact = true;
	return parse_modeline(text, mode);
}

static int clamp_length(double length, int most)
{
	return length < 1 ? 1 : length > most ? most : (int)lrint(length);
}

struct kms_box kms_fit_box(int width, int height, double squash, int screen_width,
			   int screen_height)
{
	const double tall = height * squash;
	const double factor = fmin(screen_width / (double)width, screen_height / tall);
	struct kms_box box = {
		.width = clamp_length(width * factor, screen_width),
		.height = clamp_length(tall * factor, screen_height),
	};

	box.x = (screen_width - box.width) / 2;
	box.y = (screen_height - box.height) / 2;
	return box;
}
