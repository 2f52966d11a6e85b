/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/frame/frame_ycbcr.h"

enum { SIDE_MAX = 16384, HEADER_WAIT_MS = 2000 };

static size_t picture_bytes(const struct y4m *video)
{
	const size_t w = (size_t)video->width, h = (size_t)video->height;
	const size_t half_w = (w + 1) / 2, half_h = (h + 1) / 2;

	switch (video->chroma) {
	case Y4M_420:
		return w * h + 2 * half_w * half_h;
	case Y4M_422:
		return w * h + 2 * half_w * h;
	case Y4M_444:
		return 3 * w * h;
	default:
		return w * h;
	}
}

/* Reads without blocking. Returns the bytes read, 0 at the end, -EAGAIN, or another -errno. */
static ssize_t read_some(const struct y4m *video, void *to, size_t bytes)
{
	ssize_t got;

	if (video->pipe) {
		struct pollfd p = {.fd = video->fd, .events = POLLIN};

		if (poll(&p, 1, 0) <= 0)
			return -EAGAIN;
	}
	do
		got = read(video->fd, to, bytes);
	while (got < 0 && errno == EINTR);
	return got < 0 ? -errno : got;
}

/* Reads a line and removes its newline. Reads byte by byte, because the data behind it must stay in
 * the pipe; lines are short. 0; -EAGAIN: not whole yet; -ENODATA: the end; other -errno. */
static int y4m_read_line(struct y4m *video)
{
	for (;;) {
		ssize_t got;

		if (video->line_have == sizeof(video->line))
			return -EBADMSG;
		got = read_some(video, video->line + video->line_have, 1);
		if (got < 0)
			return (int)got;
		if (got == 0)
			return video->line_have == 0 ? -ENODATA : -EBADMSG;
		if (video->line[video->line_have] == '\n') {
			video->line[video->line_have] = '\0';
			video->line_have = 0;
			return 0;
		}
		video->line_have++;
	}
}

static int read_chroma(struct y4m *video, const char *name, struct fault *fault)
{
	static const struct {
		const char *name;
		enum y4m_chroma chroma;
	} known[] = {
		{"420", Y4M_420},      {"420jpeg", Y4M_420}, {"420mpeg2", Y4M_420},
		{"420paldv", Y4M_420}, {"422", Y4M_422},     {"444", Y4M_444},
		{"mono", Y4M_GREY},
	};

	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
		if (strcmp(name, known[i].name) == 0) {
			video->chroma = known[i].chroma;
			return 0;
		}
	return fault_say(fault, -ENOTSUP,
			 "%s: Y4M video of kind C%s, expected C420, C422, C444 or Cmono",
			 video->path, name);
}

static void read_rate(struct y4m *video, const char *text)
{
	int over, under;

	if (sscanf(text, "%d:%d", &over, &under) == 2 && over > 0 && under > 0)
		video->rate_hz = (double)over / under;
}

static int y4m_read_header(struct y4m *video, struct fault *fault)
{
	char *rest = NULL, *word = strtok_r(video->line, " ", &rest);
	int err;

	if (!word || strcmp(word, "YUV4MPEG2") != 0)
		return fault_say(fault, -EBADMSG,
				 "%s: not Y4M video: expected YUV4MPEG2 at its start", video->path);
	while ((word = strtok_r(NULL, " ", &rest))) {
		if (word[0] == 'W') {
			video->width = atoi(word + 1);
		} else if (word[0] == 'H') {
			video->height = atoi(word + 1);
		} else if (word[0] == 'F') {
			read_rate(video, word + 1);
		} else if (word[0] == 'C') {
			err = read_chroma(video, word + 1, fault);
			if (err)
				return err;
		} else if (strcmp(word, "XCOLORRANGE=FULL") == 0) {
			video->range = RANGE_FULL;
		}
	}
	if (video->width < 1 || video->height < 1 || video->width > SIDE_MAX ||
	    video->height > SIDE_MAX)
		return fault_say(fault, -EBADMSG,
				 "%s: Y4M video of %dx%d, expected sides of 1 to %d", video->path,
				 video->width, video->height, SIDE_MAX);
	return 0;
}

static int wait_for_header(struct y4m *video, struct fault *fault)
{
	const int64_t until_ns = clock_now_ns() + HEADER_WAIT_MS * NS_PER_MS;
	int err;

	while ((err = y4m_read_line(video)) == -EAGAIN || (err == -ENODATA && video->pipe)) {
		if (clock_now_ns() > until_ns)
			return fault_say(fault, -ETIMEDOUT, "%s: no video came for %d s",
					 video->path, HEADER_WAIT_MS / 1000);
		/* A pipe without a writer reads as ended: waits a little for one. */
		poll(&(struct pollfd){.fd = err == -EAGAIN ? video->fd : -1, .events = POLLIN}, 1,
		     20);
	}
	if (err == -ENODATA || err == -EBADMSG)
		return fault_say(fault, -EBADMSG,
				 "%s: not Y4M video: expected a header line beginning YUV4MPEG2",
				 video->path);
	if (err)
		return fault_say(fault, err, "%s: cannot read: %s", video->path, strerror(-err));
	return y4m_read_header(video, fault);
}

static int open_path(struct y4m *video, const char *path, struct fault *fault)
{
	struct stat st;

	/* Non-blocking: otherwise open() would wait for a writer of the pipe. */
	video->fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (video->fd < 0)
		return fault_say(fault, -errno, "%s: cannot open: %s", video->path,
				 strerror(errno));
	if (fstat(video->fd, &st))
		return fault_say(fault, -errno, "%s: cannot examine: %s", video->path,
				 strerror(errno));
	if (S_ISDIR(st.st_mode))
		return fault_say(fault, -EISDIR, "%s: a folder, expected Y4M video", video->path);
	video->pipe = !S_ISREG(st.st_mode);
	return 0;
}

int y4m_open(struct y4m *video, const char *path, struct fault *fault)
{
	int err;

	memset(video, 0, sizeof(*video));
	snprintf(video->path, sizeof(video->path), "%s", path);
	err = open_path(video, path, fault);
	if (!err)
		err = wait_for_header(video, fault);
	if (err)
		goto fail;
	video->first_frame = video->pipe ? 0 : lseek(video->fd, 0, SEEK_CUR);
	video->picture_bytes = picture_bytes(video);
	video->picture = malloc(video->picture_bytes);
	if (!video->picture) {
		err = fault_say(fault, -ENOMEM, "%s: no memory for a picture of %dx%d", video->path,
				video->width, video->height);
		goto fail;
	}
	return 0;
fail:
	y4m_close(video);
	return err;
}

void y4m_close(struct y4m *video)
{
	if (video->fd >= 0)
		close(video->fd);
	free(video->picture);
	video->fd = -1;
	video->picture = NULL;
}

int y4m_rewind(struct y4m *video, struct fault *fault)
{
	if (video->pipe)
		return -ESPIPE;
	if (lseek(video->fd, video->first_frame, SEEK_SET) < 0)
		return fault_say(fault, -errno, "%s: cannot go back to the start: %s", video->path,
				 strerror(errno));
	video->in_picture = false;
	return 0;
}

int y4m_next(struct y4m *video, struct fault *fault)
{
	if (!video->in_picture) {
		int err = y4m_read_line(video);

		if (err == -EAGAIN || err == -ENODATA)
			return err;
		if (err || strncmp(video->line, "FRAME", 5) != 0)
			return fault_say(fault, -EBADMSG,
					 "%s: damaged Y4M video: expected FRAME before a picture",
					 video->path);
		video->in_picture = true;
		video->picture_have = 0;
	}
	while (video->picture_have < video->picture_bytes) {
		const ssize_t got = read_some(video, video->picture + video->picture_have,
					      video->picture_bytes - video->picture_have);

		if (got == -EAGAIN)
			return -EAGAIN;
		if (got < 0)
			return fault_say(fault, (int)got, "%s: cannot read: %s", video->path,
					 strerror((int)-got));
		if (got == 0)
			return fault_say(fault, -EBADMSG,
					 "%s: cut short: the last picture has %zu of %zu bytes",
					 video->path, video->picture_have, video->picture_bytes);
		video->picture_have += (size_t)got;
	}
	video->in_picture = false;
	return 0;
}

void y4m_decode(const struct y4m *video, enum colour_matrix matrix, enum colour_range range,
		struct canvas *canvas)
{
	const size_t w = (size_t)video->width, h = (size_t)video->height;
	const size_t chroma_w = video->chroma == Y4M_444 ? w : (w + 1) / 2;
	const size_t chroma_h = video->chroma == Y4M_420 ? (h + 1) / 2 : h;
	struct ycbcr k;

	ycbcr_prepare(&k, matrix, range);
	for (size_t row = 0; row < h; row++) {
		const uint8_t *y = video->picture + row * w;
		const size_t chroma_row = video->chroma == Y4M_420 ? row / 2 : row;
		const uint8_t *cb = video->picture + w * h + chroma_row * chroma_w;
		const uint8_t *cr = cb + chroma_w * chroma_h;
		uint32_t *to = (uint32_t *)(void *)(canvas->pixels + row * canvas->stride);

		if (video->chroma == Y4M_GREY)
			ycbcr_row_grey(&k, y, video->width, to);
		else if (video->chroma == Y4M_444)
			ycbcr_row_full(&k, y, cb, cr, video->width, to);
		else
			ycbcr_row_halved(&k, y, cb, cr, video->width, to);
	}
}
