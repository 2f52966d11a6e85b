/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <getopt.h>
#include <libyuv.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/control/control_socket.h"
#include "app/control/snapshot.h"
#include "app/settings.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/image/image.h"

/* The socket of the installed service (board/appliance.conf). */
#define SOCKET_DEFAULT "/run/inlay/control"
#define REPLY_MAX 65536
#define REPLY_WITHIN_NS (60 * NS_PER_S) /* a busy machine takes long to a turn */

struct control_options {
	struct settings settings;
	const char *socket;
	bool force;
};

#define AT(field) .place = offsetof(struct control_options, field)

static const struct option_row rows[] = {
	{"socket", OPTION_TEXT, AT(socket), .argument = "PATH",
	 .help = "the kiosk's socket, else that of its configuration, or " SOCKET_DEFAULT},
	CONFIG_ROW("the kiosk's configuration, which names its socket"),
	{"force", OPTION_FLAG, AT(force), .help = "snapshot replaces a file that is there"},
	{.name = NULL}};

/* Finds the socket's path. A fault elsewhere in the file does not keep anybody from a kiosk that
 * runs: the socket is read all the same. */
static int find_socket(const struct control_options *options, char *path, size_t room)
{
	const char *file = settings_file(&options->settings);
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int err;

	snprintf(path, room, "%s", options->socket ? options->socket : SOCKET_DEFAULT);
	if (options->socket || !file)
		return 0;
	err = settings_read(&options->settings, &config, &report);
	if (err && options->settings.config_file)
		log_warning("%s", report.first.text);
	if (config && config->control.socket[0])
		snprintf(path, room, "%s", config->control.socket);
	else if (config && report.count == 0 && options->settings.config_file)
		path[0] = '\0';
	config_destroy(config);
	if (err && err != -EINVAL && options->settings.config_file)
		return EXIT_FAILURE; /* there about no such file */
	if (path[0])
		return 0;
	log_error("control: %s names no socket in [control], expected one, or --socket PATH", file);
	return EXIT_USAGE;
}

/* Waits until fd is ready. 0 or -errno; -ETIMEDOUT: not in time. */
static int wait_until(int fd, short events, int64_t until_ns)
{
	struct pollfd p = {.fd = fd, .events = events};
	const int64_t left_ns = until_ns - clock_now_ns();
	int ready;

	if (left_ns <= 0)
		return -ETIMEDOUT;
	ready = poll(&p, 1, (int)(left_ns / NS_PER_MS) + 1);
	if (ready < 0)
		return -errno;
	return ready ? 0 : -ETIMEDOUT;
}

/* Sends a line and reads the reply, without its newline, and what has come after it: *more bytes. 0
 * or -errno; -EPIPE: the kiosk closed the connection. */
static int send_line(int fd, const char *line, char *reply, size_t room, size_t *more)
{
	const int64_t until_ns = clock_now_ns() + REPLY_WITHIN_NS;
	size_t length = 0;
	char *newline = NULL;

	if (send(fd, line, strlen(line), MSG_NOSIGNAL) < 0 && errno != EPIPE)
		return -errno;
	/* A refusal can be read here even when the line could not be sent. */
	while (!newline && length < room) {
		ssize_t bytes;
		int err;

		err = wait_until(fd, POLLIN, until_ns);
		if (err)
			return err;
		bytes = recv(fd, reply + length, room - length, 0);
		if (bytes < 0)
			return -errno;
		if (bytes == 0)
			return -EPIPE;
		newline = memchr(reply + length, '\n', (size_t)bytes);
		length += (size_t)bytes;
	}
	if (!newline)
		return -EMSGSIZE;
	*newline = '\0';
	*more = (size_t)(reply + length - newline - 1);
	return 0;
}

/* Reads the rest of a picture, of which *done bytes are there. */
static int receive_picture(int fd, struct snapshot *s, size_t done)
{
	while (done < snapshot_bytes(s)) {
		const int err = wait_until(fd, POLLIN, clock_now_ns() + REPLY_WITHIN_NS);
		const ssize_t bytes = err ? 0
					  : recv(fd, s->pixels + done, snapshot_bytes(s) - done, 0);

		if (err || bytes <= 0)
			return err ? err : bytes ? -errno : -EPIPE;
		done += (size_t)bytes;
	}
	return 0;
}

/* Makes a picture of the reply and the bytes after it. */
static int take_picture(int fd, const char *reply, size_t more, struct snapshot **to,
			struct fault *fault)
{
	int err = snapshot_expect(to, reply, fault);

	if (!err && more > snapshot_bytes(*to))
		more = snapshot_bytes(*to);
	if (err)
		return err;
	memcpy((*to)->pixels, reply + strlen(reply) + 1, more);
	err = receive_picture(fd, *to, more);
	return err ? fault_say(fault, err, "the kiosk's picture is cut off: %s", strerror(-err))
		   : 0;
}

/* Sends a command and says what is wrong, or reads the reply, and the picture where one is asked
 * for (else picture is NULL). */
static int send_command(const char *path, const char *line, char *reply, struct snapshot **picture)
{
	const int fd = control_socket_connect(path);
	struct fault fault = {.text = ""};
	size_t more = 0;
	int err, code = EXIT_SUCCESS;

	if (fd == -EACCES || fd == -EPERM) {
		log_error(
			"control: you may not use the kiosk's socket \"%s\", expected a member of its group (sudo adduser NAME inlay) or root",
			path);
		return EXIT_FAILURE;
	}
	if (fd < 0) {
		log_error("control: no kiosk listens at \"%s\": %s", path, strerror(-fd));
		return EXIT_FAILURE;
	}
	err = send_line(fd, line, reply, REPLY_MAX, &more);
	if (err) {
		log_error("control: the kiosk at \"%s\" does not answer: %s", path, strerror(-err));
		code = EXIT_FAILURE;
	} else if (!strncmp(reply, "error: ", 7)) {
		log_error("control: %s", reply + 7);
		code = EXIT_FAILURE;
	} else if (picture && take_picture(fd, reply, more, picture, &fault)) {
		log_error("control: %s", fault.text);
		code = EXIT_FAILURE;
	}
	close(fd);
	return code;
}

/* ---- a picture of the screen ---- */

/* Checks the name before the kiosk is asked. */
static int check_file(const char *file, bool force, struct fault *fault)
{
	struct stat about;

	if (image_name_linear(file, NULL))
		return fault_say(fault, -EINVAL, "%s: expected a name that ends in .png", file);
	if (!force && lstat(file, &about) == 0)
		return fault_say(fault, -EEXIST,
				 "%s: is there already, expected another name, or --force", file);
	return output_check(&file, 1, NULL, 0, fault);
}

static int write_snapshot(const struct snapshot *s, const char *file, bool force,
			  struct fault *fault)
{
	struct image picture;
	int err = image_create_u8(&picture, s->width, s->height);

	if (err)
		return fault_say(fault, err, "%s: %s", file, strerror(-err));
	/* libyuv's ARGB is B, G, R, A in memory, its RAW is R, G, B. */
	ARGBToRAW(s->pixels, (int)s->stride, picture.u8, 3 * s->width, s->width, s->height);
	if (!strcmp(file, "-"))
		err = image_write_png(stdout, &picture, "standard output", fault);
	else if (force)
		err = image_write(file, &picture, fault);
	else
		err = image_write_new(file, &picture, fault);
	image_free(&picture);
	return err;
}

static int take_snapshot(const char *path, const char *file, bool force, char *reply)
{
	struct snapshot *snapshot = NULL;
	struct fault fault = {.text = ""};
	const bool streamed = !strcmp(file, "-");
	int code;

	if (!streamed && check_file(file, force, &fault)) {
		log_error("control: %s", fault.text);
		return EXIT_FAILURE;
	}
	code = send_command(path, "snapshot\n", reply, &snapshot);
	if (code == EXIT_SUCCESS && write_snapshot(snapshot, file, force, &fault)) {
		if (!ferror(stdout)) /* else main() says so */
			log_error("control: %s", fault.text);
		code = EXIT_FAILURE;
	} else if (code == EXIT_SUCCESS && !streamed) {
		printf("%s: %dx%d\n", file, snapshot->width, snapshot->height);
	}
	snapshot_release(snapshot);
	return code;
}

static int give_command(const char *path, const char *line, char *reply)
{
	const int code = send_command(path, line, reply, NULL);

	if (code == EXIT_SUCCESS)
		puts(reply);
	return code;
}

static int control_run(const struct command *command, int argc, char **argv)
{
	struct control_options options = {.socket = NULL};
	static char reply[REPLY_MAX];
	char path[INI_PATH_MAX] = "", line[1024];
	bool snapshot;
	int code = command_read(command, argc, argv, rows, &options), length;
	const int words = argc - optind;

	if (code != COMMAND_GOES_ON)
		return code;
	argv += optind;
	if (words < 1)
		return command_wrong(command, "no command, expected one like view-next or status");
	if (words > 2)
		return command_wrong(
			command, "\"%.60s\": expected one command and at most one value", argv[2]);
	length = snprintf(line, sizeof(line), "%s%s%s\n", argv[0], words > 1 ? " " : "",
			  words > 1 ? argv[1] : "");
	if ((size_t)length >= sizeof(line) || strcspn(line, "\n") + 1 != (size_t)length)
		return command_wrong(command, "a command is one line of less than %zu bytes",
				     sizeof(line));
	snapshot = !strcmp(argv[0], "snapshot");
	if (snapshot && words < 2)
		return command_wrong(command, "snapshot: expected the name of the picture's file");
	code = find_socket(&options, path, sizeof(path));
	if (code)
		return code;
	return snapshot ? take_snapshot(path, argv[1], options.force, reply)
			: give_command(path, line, reply);
}

const struct command command_control = {
	.name = "control",
	.usage = "[--socket PATH | --config FILE] [--force] COMMAND [VALUE]",
	.summary = "give a running kiosk one command and print its reply",
	.help = "\ncommands:\n  status                what it is doing, as one line of JSON\n"
		"  snapshot FILE.png|-   write what the screen shows, upright, to a new file, or to standard output\n"
		"  threshold-up          leave out more of the dim lights\n"
		"  threshold-down        leave out fewer of them\n"
		"  threshold-next        up, and from the highest to 0\n"
		"  threshold-set LEVEL   leave out lights below this grey level, 0..255, or what changes no\n"
		"                        pixel by more of white: 1%\n"
		"  view-next             show the next view\n"
		"  view NAME             show this view: composite, before, fisheye ...\n"
		"  pose-next             take the next pose of the basis\n"
		"  pose-prev             take the one before\n"
		"  pose P                take this pose: next, prev, its number from 0, or name\n"
		"  object [on|off]       show the object, or hide it\n"
		"  information [on|off]  show the line of figures, or hide it\n"
		"  split-left            move the line between before and after\n"
		"  split-right           move it the other way\n"
		"  freeze [on|off]       hold the picture, or let it go on\n"
		"  wake                  switch the screen on for ten minutes outside of its hours\n"
		"  learn                 nobody is in the picture: it shows the empty place\n"
		"  forget                learn the empty place anew\n"
		"  quit                  end the kiosk\n",
	.run = control_run,
};
