/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/image/image.h"

enum player_kind { KIND_VIDEO, KIND_NUMBERED, KIND_SINGLE };

/* The parts of a name like "img%03d.png". */
struct pattern {
	char before[INI_PATH_MAX];
	const char *after;
	int digits;
};

struct player {
	struct player_settings settings;
	enum player_kind kind;
	struct y4m video;
	struct pattern pattern;
	int first, next; /* numbers of the first and the present picture */
	bool started;
	int width, height;
	struct image image;   /* the last picture read, if linear */
	struct canvas canvas; /* the last frame of a video, with a stride of its own */
	uint8_t *bgrx;	      /* the last 8-bit picture, rows packed */
};

static bool path_ends_with(const char *text, const char *end)
{
	const size_t a = strlen(text), b = strlen(end);

	return a >= b && strcmp(text + a - b, end) == 0;
}

/* Anything but a regular file counts as video: pictures cannot come from a pipe. */
static bool is_video(const char *path)
{
	struct stat st;

	if (path_ends_with(path, ".y4m") || strcmp(path, "/dev/stdin") == 0)
		return true;
	return stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

/* Splits a name at its number. True: it has exactly one %d, %3d or %03d. */
static bool take_apart(const char *path, struct pattern *pattern)
{
	const char *percent = strchr(path, '%'), *p = percent;

	if (!percent || (size_t)(percent - path) >= sizeof(pattern->before))
		return false;
	pattern->digits = 0;
	for (p++; isdigit((unsigned char)*p) && pattern->digits < 10; p++)
		pattern->digits = pattern->digits * 10 + (*p - '0');
	if (*p != 'd' || pattern->digits > 10 || strchr(p, '%'))
		return false;
	memcpy(pattern->before, path, (size_t)(percent - path));
	pattern->before[percent - path] = '\0';
	pattern->after = p + 1;
	return true;
}

/* Writes the path of a numbered picture. True: the file exists. */
static bool numbered_path(const struct player *player, int number, char path[INI_PATH_MAX])
{
	const int length = snprintf(path, INI_PATH_MAX, "%s%0*d%s", player->pattern.before,
				    player->pattern.digits, number, player->pattern.after);

	return length < INI_PATH_MAX && access(path, F_OK) == 0;
}

static int check_size(struct player *player, const char *path, struct fault *fault)
{
	const struct image *image = &player->image;

	if (player->width == 0) {
		player->width = image->width;
		player->height = image->height;
	} else if (player->width != image->width || player->height != image->height) {
		return fault_say(fault, -EINVAL, "%s: %dx%d, expected %dx%d as the first picture",
				 path, image->width, image->height, player->width, player->height);
	} else if (!image->f32 != !!player->bgrx) {
		return fault_say(fault, -EINVAL, "%s: expected %s as in the first picture", path,
				 player->bgrx ? "8-bit code values" : "linear light");
	}
	return 0;
}

static int read_picture(struct player *player, const char *path, struct fault *fault)
{
	const size_t pixels_of = sizeof(uint32_t);
	int err;

	image_free(&player->image);
	err = image_read(path, &player->image, fault);
	if (err)
		return err;
	err = check_size(player, path, fault);
	if (err || player->image.f32)
		return err;
	if (!player->bgrx)
		player->bgrx = malloc((size_t)player->width * (size_t)player->height * pixels_of);
	if (!player->bgrx)
		return fault_say(fault, -ENOMEM, "%s: no memory for the picture", path);
	for (size_t i = 0; i < (size_t)player->width * (size_t)player->height; i++) {
		const uint8_t *from = player->image.u8 + 3 * i;
		uint8_t *to = player->bgrx + 4 * i;

		to[0] = from[2];
		to[1] = from[1];
		to[2] = from[0];
		to[3] = 255;
	}
	image_free(&player->image);
	return 0;
}

static int open_video(struct player *player, struct fault *fault)
{
	int err = y4m_open(&player->video, player->settings.path, fault);

	if (err)
		return err;
	player->width = player->video.width;
	player->height = player->video.height;
	err = canvas_create(&player->canvas, player->width, player->height);
	if (err)
		return fault_say(fault, err, "%s: no memory for a picture", player->video.path);
	player->bgrx = malloc((size_t)player->width * (size_t)player->height * 4);
	if (!player->bgrx)
		return fault_say(fault, -ENOMEM, "%s: no memory for a picture", player->video.path);
	return 0;
}

static int open_numbered(struct player *player, struct fault *fault)
{
	char path[INI_PATH_MAX];

	for (player->first = 0; player->first <= 1; player->first++) {
		if (!numbered_path(player, player->first, path))
			continue;
		player->next = player->first;
		return read_picture(player, path, fault);
	}
	return fault_say(fault, -ENOENT, "%s: no such pictures: expected one numbered 0 or 1",
			 player->settings.path);
}

static int open_kind(struct player *player, struct fault *fault)
{
	const char *path = player->settings.path;

	if (*path == '\0')
		return fault_say(
			fault, -EINVAL,
			"sim.file: missing: expected pictures (img%%03d.png) or video (clip.y4m) for the source \"files\"");
	if (is_video(path)) {
		player->kind = KIND_VIDEO;
		return open_video(player, fault);
	}
	if (take_apart(path, &player->pattern)) {
		player->kind = KIND_NUMBERED;
		return open_numbered(player, fault);
	}
	player->kind = KIND_SINGLE;
	return read_picture(player, path, fault);
}

int player_open(struct player **player, const struct player_settings *settings, struct fault *fault)
{
	struct player *p = calloc(1, sizeof(*p));
	int err;

	*player = NULL;
	if (!p)
		return fault_say(fault, -ENOMEM, "%s: no memory", settings->path);
	p->settings = *settings;
	p->video.fd = -1;
	err = open_kind(p, fault);
	if (err) {
		player_close(p);
		return err;
	}
	*player = p;
	return 0;
}

void player_close(struct player *player)
{
	if (!player)
		return;
	y4m_close(&player->video);
	canvas_free(&player->canvas);
	image_free(&player->image);
	free(player->bgrx);
	free(player);
}

static int next_numbered(struct player *player, uint64_t steps, struct fault *fault)
{
	char path[INI_PATH_MAX];
	const bool already_read = !player->started && steps == 1;

	if (!player->started)
		steps--;
	player->started = true;
	if (already_read)
		return 0;
	while (steps-- > 0) {
		player->next++;
		if (numbered_path(player, player->next, path))
			continue;
		if (!player->settings.loop)
			return -ENODATA;
		player->next = player->first;
	}
	if (!numbered_path(player, player->next, path))
		return fault_say(fault, -ENOENT, "%s: has gone", path);
	return read_picture(player, path, fault);
}

static enum colour_matrix video_matrix(const struct player *player)
{
	if (player->settings.matrix)
		return (enum colour_matrix)(player->settings.matrix - 1);
	return player->height >= 720 ? MATRIX_BT709 : MATRIX_BT601; /* as video players do */
}

static int take_video(struct player *player, struct fault *fault)
{
	int err = y4m_next(&player->video, fault);

	if (err != -ENODATA || !player->settings.loop || player->video.pipe)
		return err;
	err = y4m_rewind(&player->video, fault);
	if (err)
		return err;
	err = y4m_next(&player->video, fault);
	if (err == -ENODATA)
		return fault_say(fault, -EBADMSG, "%s: video without a picture",
				 player->video.path);
	return err;
}

static int next_video(struct player *player, uint64_t steps, struct fault *fault)
{
	const size_t row = (size_t)player->width * 4;
	enum colour_range range = player->video.range;
	int err;

	do {
		err = take_video(player, fault);
		if (err)
			return err;
	} while (--steps > 0);
	if (player->settings.range)
		range = (enum colour_range)(player->settings.range - 1);
	y4m_decode(&player->video, video_matrix(player), range, &player->canvas);
	for (int y = 0; y < player->height; y++)
		memcpy(player->bgrx + (size_t)y * row,
		       player->canvas.pixels + (size_t)y * player->canvas.stride, row);
	return 0;
}

int player_next(struct player *player, uint64_t steps, struct fault *fault)
{
	switch (player->kind) {
	case KIND_VIDEO:
		return next_video(player, steps, fault);
	case KIND_NUMBERED:
		return next_numbered(player, steps, fault);
	default:
		return 0;
	}
}

struct player_picture player_picture(const struct player *player)
{
	return (struct player_picture){
		.width = player->width,
		.height = player->height,
		.rate_hz = player->video.rate_hz,
		.descriptor = player->video.pipe ? player->video.fd : -1,
		.bgrx = player->bgrx,
		.linear = player->image.f32,
	};
}
