/* SPDX-License-Identifier: MIT */
#include "app/kiosk/loop.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#define SLOT_SIGNALS LOOP_SLOTS
#define SLOT_TIMER (LOOP_SLOTS + 1)

static int epoll_add(struct loop *loop, int descriptor, uint32_t slot)
{
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = slot};

	return epoll_ctl(loop->epoll, EPOLL_CTL_ADD, descriptor, &event) ? -errno : 0;
}

/* Ignored, as nohup leaves it: a blocked signal would arrive through the signalfd all the same. */
static bool is_ignored(int signal)
{
	struct sigaction action;

	return sigaction(signal, NULL, &action) == 0 && action.sa_handler == SIG_IGN;
}

/* Asks the terminal that was opened at the start: opening it anew can fail for other reasons. */
static bool terminal_has_gone(const struct loop *loop)
{
	return loop->terminal >= 0 && tcgetpgrp(loop->terminal) < 0;
}

static int open_descriptors(struct loop *loop)
{
	sigset_t set;
	int err;

	sigemptyset(&set);
	sigaddset(&set, SIGINT);
	sigaddset(&set, SIGTERM);
	if (!is_ignored(SIGHUP))
		sigaddset(&set, SIGHUP);
	err = -pthread_sigmask(SIG_BLOCK, &set, NULL);
	if (err)
		return err;
	loop->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (loop->epoll < 0)
		return -errno;
	loop->signals = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
	if (loop->signals < 0)
		return -errno;
	loop->timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (loop->timer < 0)
		return -errno;
	err = epoll_add(loop, loop->signals, SLOT_SIGNALS);
	return err ? err : epoll_add(loop, loop->timer, SLOT_TIMER);
}

int loop_open(struct loop *loop, struct fault *fault)
{
	int err;

	*loop = (struct loop){.epoll = -1, .signals = -1, .timer = -1};
	/* Only a process that has a controlling terminal can open it by this name. */
	loop->terminal = open("/dev/tty", O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
	for (int i = 0; i < LOOP_SLOTS; i++)
		loop->watched[i] = -1;
	err = open_descriptors(loop);
	if (err) {
		loop_close(loop);
		return fault_say(fault, err, "cannot set up the event loop: %s", strerror(-err));
	}
	return 0;
}

static void close_one(int *descriptor)
{
	if (*descriptor >= 0)
		close(*descriptor);
	*descriptor = -1;
}

void loop_close(struct loop *loop)
{
	close_one(&loop->terminal);
	close_one(&loop->timer);
	close_one(&loop->signals);
	close_one(&loop->epoll);
}

void loop_start(struct loop *loop)
{
	const struct itimerspec second = {.it_value.tv_sec = 1, .it_interval.tv_sec = 1};

	/* Fails only for a wrong descriptor or wrong times. */
	(void)timerfd_settime(loop->timer, 0, &second, NULL);
}

int loop_watch(struct loop *loop, int slot, int descriptor, struct fault *fault)
{
	int err;

	if (loop->watched[slot] == descriptor)
		return 0;
	/* Fails where the descriptor has been closed: then epoll has dropped it. */
	if (loop->watched[slot] >= 0)
		(void)epoll_ctl(loop->epoll, EPOLL_CTL_DEL, loop->watched[slot], NULL);
	loop->watched[slot] = -1;
	if (descriptor < 0)
		return 0;
	err = epoll_add(loop, descriptor, (uint32_t)slot);
	if (err)
		return fault_say(fault, err, "cannot poll a descriptor: %s", strerror(-err));
	loop->watched[slot] = descriptor;
	return 0;
}

static void take_signals(struct loop *loop)
{
	struct signalfd_siginfo signal;

	while (read(loop->signals, &signal, sizeof(signal)) == sizeof(signal)) {
		if (signal.ssi_signo == SIGHUP && !terminal_has_gone(loop))
			loop->reload = true;
		else
			loop->stop = true;
	}
}

static void note_event(struct loop *loop, uint32_t slot)
{
	uint64_t expired;

	if (slot == SLOT_SIGNALS)
		take_signals(loop);
	else if (slot == SLOT_TIMER)
		loop->tick = read(loop->timer, &expired, sizeof(expired)) == sizeof(expired);
	else
		loop->ready |= 1u << slot;
}

int loop_wait(struct loop *loop, struct fault *fault)
{
	struct epoll_event events[LOOP_SLOTS + 2];
	int count;

	loop->ready = 0;
	loop->tick = loop->reload = false;
	do
		count = epoll_wait(loop->epoll, events, LOOP_SLOTS + 2, -1);
	while (count < 0 && errno == EINTR);
	if (count < 0) {
		int err = -errno;

		return fault_say(fault, err, "cannot wait for events: %s", strerror(-err));
	}
	for (int i = 0; i < count; i++)
		note_event(loop, events[i].data.u32);
	return 0;
}
