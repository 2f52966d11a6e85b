/* SPDX-License-Identifier: MIT */
/*
 * The kernel asks for a switch by a signal. Its handler only writes a byte into a pipe for the
 * event loop.
 *
 * The console stays in text mode: its text goes to a buffer that is not shown. In graphics mode the
 * kernel would draw no text; but if the program were killed then, the kernel would leave that mode
 * only in part, and no console would show anything any more.
 */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/kd.h>
#include <linux/vt.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#define VT_MAJOR 4
#define SIGNAL_AWAY (SIGRTMIN + 3)
#define SIGNAL_BACK (SIGRTMIN + 4)

/* State of the signal handler, once per process: a handler gets only the number of its signal. */
static atomic_int telling = -1;	   /* writable end of the pipe */
static struct sigaction before[2]; /* the handlers that were found */

static void console_signalled(int number)
{
	const char what = number == SIGNAL_AWAY ? KMS_SWITCH_AWAY : KMS_SWITCH_BACK;
	const int fd = atomic_load(&telling), kept = errno;

	if (fd >= 0 && write(fd, &what, 1) < 0)
		errno = kept; /* never full: a pipe holds more requests than there can be */
	errno = kept;
}

/* Returns the number of a virtual console; 0: tty is something else. */
static int console_number(int tty)
{
	struct stat of;

	return !fstat(tty, &of) && S_ISCHR(of.st_mode) && major(of.st_rdev) == VT_MAJOR &&
			       minor(of.st_rdev) < 64
		       ? (int)minor(of.st_rdev)
		       : 0;
}

static int open_tty(const char *path)
{
	const int tty = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);

	return tty < 0 ? -errno : tty;
}

/* Opens the console that standard input is, else the one that is shown. */
static int open_auto(void)
{
	char path[32];
	struct vt_stat shown;
	int zero, err = 0, number = console_number(STDIN_FILENO);

	if (!number) {
		zero = open_tty("/dev/tty0");
		if (zero < 0)
			return zero;
		if (ioctl(zero, VT_GETSTATE, &shown))
			err = -errno;
		close(zero);
		if (err)
			return err;
		number = shown.v_active;
	}
	snprintf(path, sizeof(path), "/dev/tty%d", number);
	return open_tty(path);
}

/* Puts the readable end into console->told, the other into telling. */
static int open_pipe(struct kms_console *console)
{
	int ends[2], none = -1;

	if (pipe2(ends, O_NONBLOCK | O_CLOEXEC))
		return -errno;
	if (!atomic_compare_exchange_strong(&telling, &none, ends[1])) {
		close(ends[0]);
		close(ends[1]);
		return -EBUSY;
	}
	console->told = ends[0];
	return 0;
}

static void close_pipe(struct kms_console *console)
{
	if (console->told < 0)
		return;
	close(atomic_exchange(&telling, -1));
	close(console->told);
	console->told = -1;
}

/* Ignoring the signals first discards a pending one. With the default handler restored, it would
 * end the program. */
static void give_signals_back(void)
{
	const struct sigaction ignored = {.sa_handler = SIG_IGN};

	sigaction(SIGNAL_AWAY, &ignored, NULL);
	sigaction(SIGNAL_BACK, &ignored, NULL);
	sigaction(SIGNAL_AWAY, &before[0], NULL);
	sigaction(SIGNAL_BACK, &before[1], NULL);
}

static int console_take(struct kms_console *console)
{
	const struct sigaction action = {.sa_handler = console_signalled, .sa_flags = SA_RESTART};
	const struct vt_mode mode = {
		.mode = VT_PROCESS,
		.relsig = (short)SIGNAL_AWAY,
		.acqsig = (short)SIGNAL_BACK,
	};
	int err;

	sigaction(SIGNAL_AWAY, &action, &before[0]);
	sigaction(SIGNAL_BACK, &action, &before[1]);
	if (!ioctl(console->tty, VT_SETMODE, &mode))
		return 0;
	err = -errno;
	give_signals_back();
	return err;
}

int kms_console_open(struct kms_console *console, const char *vt, struct fault *fault)
{
	int err = 0;

	*console = (struct kms_console){.tty = -1, .told = -1};
	if (!*vt)
		return 0;
	console->tty = strcmp(vt, "auto") ? open_tty(vt) : open_auto();
	if (console->tty < 0)
		return fault_say(fault, console->tty, "console %s: %s", vt,
				 strerror(-console->tty));
	console->number = console_number(console->tty);
	if (!console->number)
		err = fault_say(fault, -ENOTTY, "console %s: not one like /dev/tty1", vt);
	if (!err) {
		err = open_pipe(console);
		if (!err)
			err = console_take(console);
		if (err)
			fault_say(
				fault, err, "console %s: %s%s", vt, strerror(-err),
				err == -EPERM
					? " (is it this program's own terminal, as a service's TTYPath= makes it?)"
					: "");
	}
	if (err) {
		close_pipe(console);
		close(console->tty);
		console->tty = -1;
	}
	return err;
}

bool kms_console_is_active(const struct kms_console *console)
{
	struct vt_stat shown;

	return !ioctl(console->tty, VT_GETSTATE, &shown) && shown.v_active == console->number;
}

void kms_console_activate(const struct kms_console *console)
{
	ioctl(console->tty, VT_ACTIVATE, console->number);
}

enum kms_switch kms_console_next(struct kms_console *console)
{
	char what = KMS_SWITCH_NONE;

	if (console->told < 0 || read(console->told, &what, 1) != 1)
		return KMS_SWITCH_NONE;
	return (enum kms_switch)what;
}

/* On leaving graphics mode the kernel shows its own buffer, whoever drew last. */
void kms_console_show_text(const struct kms_console *console)
{
	ioctl(console->tty, KDSETMODE, KD_GRAPHICS);
	ioctl(console->tty, KDSETMODE, KD_TEXT);
}

void kms_console_let_go(struct kms_console *console)
{
	ioctl(console->tty, VT_RELDISP, 1);
}

void kms_console_taken(struct kms_console *console)
{
	ioctl(console->tty, VT_RELDISP, VT_ACKACQ);
}

void kms_console_close(struct kms_console *console)
{
	struct vt_mode mode = {.mode = VT_AUTO};
	enum kms_switch asked;

	if (console->tty < 0)
		return;
	kms_console_show_text(console);
	/* Answers requests that are still pending, so that no switch waits. */
	while ((asked = kms_console_next(console)) != KMS_SWITCH_NONE)
		if (asked == KMS_SWITCH_AWAY)
			kms_console_let_go(console);
	ioctl(console->tty, VT_SETMODE, &mode);
	give_signals_back();
	close_pipe(console);
	close(console->tty);
	console->tty = -1;
}
