/* SPDX-License-Identifier: MIT */
#include "app/view/words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/utf8.h"

#define NAME_MAX_BYTES 40 /* longer names are cut, so that the trouble behind them stays in sight */
#define ELLIPSIS "\u2026"

/* Follows "Fisheye camera 'C920' ". "waiting" promises that it goes on by itself. */
static const char *const wrong[CAMERA_SITUATION_COUNT] = {
	[CAMERA_NO_DEVICE] = "is not connected: waiting",
	[CAMERA_NO_SIGNAL] = "gets no video signal: waiting",
	[CAMERA_STALLED] = "sends no picture: waiting",
	[CAMERA_DAMAGED] = "sends only damaged pictures: try another cable, port or picture format",
	[CAMERA_UNSUPPORTED_FORMAT] = "sends no picture that can be used",
	[CAMERA_BUSY] = "is used by another program: waiting",
	[CAMERA_NO_BANDWIDTH] =
		"has no room on its USB bus: plug it into another port, or choose MJPEG, a smaller picture or a lower rate",
	[CAMERA_NO_PERMISSION] = "may not be opened by this user: add the user to the group video",
	[CAMERA_BROKEN] = "does not work: the log says why",
};

static int copy_whole(char *text, size_t room, const char *whole)
{
	utf8_copy(text, room, whole);
	return (int)strlen(whole);
}

int words_camera(char *text, size_t room, const char *role, const char *name,
		 enum camera_situation situation, const char *why)
{
	const bool told = situation == CAMERA_UNSUPPORTED_FORMAT && *why;
	char whole[512], shown[NAME_MAX_BYTES + sizeof(ELLIPSIS)];
	size_t length = utf8_copy(shown, NAME_MAX_BYTES, name);

	if ((int)situation <= CAMERA_FINE || situation >= CAMERA_SITUATION_COUNT)
		return copy_whole(text, room, "");
	if (strlen(name) >= NAME_MAX_BYTES)
		memcpy(shown + length, ELLIPSIS, sizeof(ELLIPSIS));
	snprintf(whole, sizeof(whole), "%.64s camera %s%s%s%s%s%.200s", role, *shown ? "'" : "",
		 shown, *shown ? "' " : "", wrong[situation], told ? ": " : "", told ? why : "");
	return copy_whole(text, room, whole);
}

int words_pose(char *text, size_t room, int pose, const char *name)
{
	char whole[128], called[64] = "";

	if (*name)
		snprintf(called, sizeof(called), " '%.40s'", name);
	snprintf(whole, sizeof(whole), "Pose %d%s cannot be loaded: waiting, the log says why",
		 pose, called);
	return copy_whole(text, room, whole);
}

/* "10 px left and 2 px down"; empty: less than half a pixel. */
static const char *say_moved(char text[64], const double moved_px[2])
{
	const double across = round(fabs(moved_px[0])), down = round(fabs(moved_px[1]));
	int length = 0;

	*text = '\0';
	if (across > 0)
		length = snprintf(text, 64, "%.0f px %s%s", across,
				  moved_px[0] > 0 ? "right" : "left", down > 0 ? " and " : "");
	if (down > 0)
		snprintf(text + length, 64 - (size_t)length, "%.0f px %s", down,
			 moved_px[1] > 0 ? "down" : "up");
	return text;
}

int words_moved(char *text, size_t room, const double moved_px[2])
{
	char whole[256], moved[64];

	snprintf(
		whole, sizeof(whole),
		"The background's camera was moved: its picture lies %s of where it was. Nobody is before the object until it is calibrated again (inlay-calibrate camera)",
		say_moved(moved, moved_px));
	return copy_whole(text, room, whole);
}

/* Rounds up, so that a bound stays a bound. */
static const char *say_bound(char *text, size_t room, double value)
{
	if (value < 10)
		snprintf(text, room, "%.1f", value > 0 ? ceil(value * 10 - 1e-9) / 10 : 0);
	else
		snprintf(text, room, "%.0f", ceil(value - 1e-9));
	return text;
}

static const char *say_share(char *text, size_t room, double share)
{
	if (share > 0 && share < 0.0005)
		snprintf(text, room, "< 0.1 %%");
	else
		snprintf(text, room, "%.1f %%", 100 * share);
	return text;
}

int words_information(char *text, size_t room, const struct words_figures *f)
{
	const double rounded = f->percent ? 100 : 10;
	char whole[768], error[32], clipped[32], missing[96] = "", unnamed[96] = "", lamp[128] = "";
	char people[192] = "", moved[64];

	if (f->missing_lamp)
		snprintf(missing, sizeof(missing), " · no light at lamp %s", f->missing_lamp);
	if (f->unnamed_off > 0)
		snprintf(unnamed, sizeof(unnamed),
			 " · light at %.0f°, %.0f° high, no [lamp]: off %.0f %% if 1.5 m away",
			 f->unnamed_azimuth_deg, f->unnamed_height_deg, 100 * f->unnamed_off);
	if (f->lamp)
		snprintf(
			lamp, sizeof(lamp),
			" · lamp at azimuth %.0f°, height %.0f°: shadow too soft, the dome is coarse there",
			f->lamp_deg[0], f->lamp_deg[1]);
	if (f->people)
		snprintf(people, sizeof(people), " · place learned %.0f %%, %d in front%s%s%s%s",
			 floor(100 * f->learned), f->in_front,
			 !f->depth     ? ""
			 : f->by_depth ? " by depth"
				       : " by feet",
			 f->unsure ? " · place not recognized, only who moves is in front" : "",
			 *say_moved(moved, f->moved_px) ? " · camera moved " : "", moved);
	snprintf(
		whole, sizeof(whole),
		"lights %d of %d · threshold %g%s · error ≤ %s %% of white · %.1f frames/s · latency %.0f ms · %llu dropped · sky clipped %s%s%s%s%s%s",
		f->lights_used, f->lights, round(f->threshold * rounded) / rounded,
		f->percent ? " %" : "", say_bound(error, sizeof(error), 100 * f->error),
		f->frames_a_second, f->latency_ms, (unsigned long long)f->drops,
		say_share(clipped, sizeof(clipped), f->clipped),
		!f->recovered ? ""
		: f->at_bound ? ", recovered in part"
			      : ", recovered",
		missing, unnamed, lamp, people);
	return copy_whole(text, room, whole);
}
