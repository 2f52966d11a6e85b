/* SPDX-License-Identifier: MIT */
/*
 * A rotary encoder on two GPIO lines. gpio/lines.h reads lines, gpio/edge_order.h sorts edges by
 * time, gpio/quadrature.h turns them into steps.
 */
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/gpio/edge_order.h"
#include "drivers/gpio/lines.h"
#include "drivers/gpio/quadrature.h"
#include "hal/base/clock.h"

/* Limit of edges in one call, so that lines that never rest do not hold up the program. */
#define EDGES_AT_ONCE 64

struct encoder_options {
	char chip[INI_TEXT_MAX];
	int offsets[2]; /* a, b; -1: not given */
	bool active_low;
	int bias;   /* enum gpio_bias */
	int detent; /* quarter periods from one resting position to the next */
	int turns;  /* index of turned */
};

struct encoder_buttons {
	struct gpiod_chip *chip;
	int epoll;
	int timer; /* expires when an edge that is held back becomes ready */
	struct gpio_line lines[2];
	struct edge_order order;
	struct quadrature quadrature;
};

static const char *const turned_names[] = {"pose", "threshold", "split", NULL};
static const enum action turned[][2] = {
	{ACTION_POSE_PREV, ACTION_POSE_NEXT},
	{ACTION_THRESHOLD_DOWN, ACTION_THRESHOLD_UP},
	{ACTION_SPLIT_LEFT, ACTION_SPLIT_RIGHT},
};

static const struct ini_key encoder_keys[] = {
	{"chip", INI_TEXT, offsetof(struct encoder_options, chip), .fallback = "gpiochip0",
	 .help = "The chip's name, label or path."},
	{"a", INI_INT, offsetof(struct encoder_options, offsets[0]), .min = -1,
	 .max = GPIO_OFFSET_MAX, .fallback = "-1",
	 .help = "Line of the contact that leads when it is turned forwards; -1: none."},
	{"b", INI_INT, offsetof(struct encoder_options, offsets[1]), .min = -1,
	 .max = GPIO_OFFSET_MAX, .fallback = "-1", .help = "Line of the other contact; -1: none."},
	{"active_low", INI_BOOL, offsetof(struct encoder_options, active_low), .fallback = "yes",
	 .help = "A closed contact connects its line to ground."},
	{"bias", INI_CHOICE, offsetof(struct encoder_options, bias), .choices = gpio_bias_names,
	 .fallback = "pull-up", .help = "The resistor inside the chip."},
	{"detent", INI_INT, offsetof(struct encoder_options, detent), .min = 1, .max = 4,
	 .fallback = "4", .help = "Edges from one place where it rests to the next: 4, 2 or 1."},
	{"turns", INI_CHOICE, offsetof(struct encoder_options, turns), .choices = turned_names,
	 .fallback = "pose", .help = "What a step changes."},
	INI_KEYS_END,
};

static int open_line(struct encoder_buttons *encoder, const struct encoder_options *options,
		     int index, struct fault *fault)
{
	/* No debounce time: a bounce counts forth and back. */
	const struct gpio_line_settings settings = {
		.active_low = options->active_low,
		.bias = (enum gpio_bias)options->bias,
	};
	struct epoll_event event = {.events = EPOLLIN};
	struct gpio_line *line = &encoder->lines[index];
	int err;

	if (options->offsets[index] < 0)
		return fault_say(
			fault, -EINVAL,
			"encoder: no line, expected encoder.a and encoder.b, like 17 and 27");
	err = gpio_line_open(line, encoder->chip, (unsigned)options->offsets[index], &settings);
	if (!err && epoll_ctl(encoder->epoll, EPOLL_CTL_ADD, gpio_line_descriptor(line), &event))
		err = -errno;
	if (err == -ENXIO)
		return fault_say(fault, -EINVAL,
				 "encoder: %s has no line %d (inlay devices lists them)",
				 options->chip, options->offsets[index]);
	return err ? fault_say(fault, err, "encoder: cannot watch line %d of %s: %s",
			       options->offsets[index], options->chip, strerror(-err))
		   : 0;
}

static int encoder_start(struct encoder_buttons *encoder, const struct encoder_options *options,
			 struct fault *fault)
{
	int level[2];

	for (int i = 0; i < 2; i++) {
		const int err = open_line(encoder, options, i, fault);

		if (err)
			return err;
	}
	for (int i = 0; i < 2; i++) {
		level[i] = gpio_line_level(&encoder->lines[i]);
		if (level[i] < 0)
			return fault_say(fault, level[i], "encoder: line %d of %s: %s",
					 options->offsets[i], options->chip, strerror(-level[i]));
	}
	quadrature_start(&encoder->quadrature, options->detent, level[0], level[1]);
	return 0;
}

static int open_wakers(struct encoder_buttons *encoder)
{
	struct epoll_event event = {.events = EPOLLIN};

	encoder->timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	encoder->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (encoder->timer < 0 || encoder->epoll < 0 ||
	    epoll_ctl(encoder->epoll, EPOLL_CTL_ADD, encoder->timer, &event))
		return -errno;
	return 0;
}

static int encoder_open(struct buttons *buttons, struct fault *fault)
{
	const struct encoder_options *options = buttons->options;
	struct encoder_buttons *encoder = calloc(1, sizeof(*encoder));
	int err;

	if (!encoder)
		return fault_say(fault, -ENOMEM, "encoder: not enough memory");
	buttons->state = encoder;
	err = open_wakers(encoder);
	if (err)
		return fault_say(fault, err, "encoder: epoll: %s", strerror(-err));
	if (options->detent == 3)
		return fault_say(fault, -EINVAL, "encoder: detent is 3, expected 1, 2 or 4");
	err = gpio_chip_open(&encoder->chip, options->chip, "encoder", fault);
	return err ? err : encoder_start(encoder, options, fault);
}

static int encoder_descriptor(struct buttons *buttons)
{
	return ((struct encoder_buttons *)buttons->state)->epoll;
}

/* Reads the pending edges as far as there is room. */
static int take_edges(struct encoder_buttons *encoder)
{
	for (int i = 0; i < 2; i++) {
		struct pollfd p = {.fd = gpio_line_descriptor(&encoder->lines[i]),
				   .events = POLLIN};

		while (edge_order_has_room(&encoder->order, i) && poll(&p, 1, 0) == 1) {
			struct gpio_edge edge;
			const int err = p.revents & POLLIN
						? gpio_line_edge(&encoder->lines[i], &edge.level,
								 &edge.at_ns)
						: -ENODEV;

			if (err)
				return err;
			edge_order_add(&encoder->order, i, edge);
		}
	}
	return 0;
}

/* Makes the descriptor readable at until_ns; INT64_MAX: never. */
static int encoder_wake(const struct encoder_buttons *encoder, int64_t until_ns)
{
	struct itimerspec at = {0};

	if (until_ns != INT64_MAX)
		at.it_value = (struct timespec){until_ns / NS_PER_S, until_ns % NS_PER_S};
	return timerfd_settime(encoder->timer, TFD_TIMER_ABSTIME, &at, NULL) ? -errno : 0;
}

/* Takes the next edge and the step that it makes. 0; -EAGAIN: no edge is ready; other -errno. */
static int next_edge(struct encoder_buttons *encoder, int *step)
{
	struct quadrature *q = &encoder->quadrature;
	struct gpio_edge edge;
	int64_t until_ns;
	int line, err = take_edges(encoder);

	if (err)
		return err;
	line = edge_order_take(&encoder->order, clock_now_ns(), &edge, &until_ns);
	if (line == -EAGAIN) {
		err = encoder_wake(encoder, until_ns);
		return err ? err : -EAGAIN;
	}
	*step = quadrature_edge(q, line == 0 ? edge.level : q->a, line == 1 ? edge.level : q->b);
	return 0;
}

static int encoder_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	const struct encoder_options *options = buttons->options;
	int step = 0, err = 0;

	for (int i = 0; i < EDGES_AT_ONCE && !err && !step; i++)
		err = next_edge(buttons->state, &step);
	if (err && err != -EAGAIN)
		return fault_say(fault, err, "encoder: the chip is gone: %s", strerror(-err));
	if (!step)
		return -EAGAIN;
	press->action = turned[options->turns][step > 0];
	return 0;
}

static void encoder_close(struct buttons *buttons)
{
	struct encoder_buttons *encoder = buttons->state;

	if (!encoder)
		return;
	for (int i = 0; i < 2; i++)
		gpio_line_close(&encoder->lines[i]);
	gpio_chip_close(encoder->chip);
	if (encoder->epoll >= 0)
		close(encoder->epoll);
	if (encoder->timer >= 0)
		close(encoder->timer);
	free(encoder);
	buttons->state = NULL;
}

const struct buttons_ops buttons_encoder = {
	.name = "encoder",
	.description = "a rotary encoder on two GPIO lines (libgpiod)",
	.keys = encoder_keys,
	.options_size = sizeof(struct encoder_options),
	.open = encoder_open,
	.descriptor = encoder_descriptor,
	.read = encoder_read,
	.close = encoder_close,
};
