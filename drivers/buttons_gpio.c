/* SPDX-License-Identifier: MIT */
/*
 * Push buttons on GPIO lines. gpio/lines.h reads lines, gpio/button.h turns edges into presses.
 * Here one epoll descriptor joins the edges with a timer for everything that is due without an
 * edge: a level that settles, a repetition, and once a second a check of every line, which notices
 * a lost chip and makes up for a lost edge.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/gpio/button.h"
#include "drivers/gpio/lines.h"
#include "hal/base/clock.h"

#define LINES 10
#define TIMER LINES /* epoll data of the timer; lines have their index */
#define LOOK_EVERY_NS NS_PER_S

/* Limit of edges in one call, so that a line that never rests does not hold up the program. */
#define EDGES_AT_ONCE 64

struct gpio_options {
	char chip[INI_TEXT_MAX];
	int offsets[LINES]; /* in the order of line_actions; -1: none */
	bool active_low;
	int bias; /* enum gpio_bias */
	int debounce_ms;
	int repeat_after_ms;
	int repeat_every_ms;
};

struct gpio_buttons {
	struct gpiod_chip *chip;
	int epoll;
	int timer; /* one shot, of CLOCK_MONOTONIC */
	struct button_timing timing;
	struct gpio_line lines[LINES];
	struct button buttons[LINES];
	int64_t look_ns; /* time of the next check of every line */
};

static const enum action line_actions[LINES] = {
	ACTION_THRESHOLD_UP, ACTION_THRESHOLD_DOWN, ACTION_THRESHOLD_NEXT, ACTION_VIEW_NEXT,
	ACTION_POSE_NEXT,    ACTION_OBJECT,	    ACTION_INFORMATION,	   ACTION_SPLIT_LEFT,
	ACTION_SPLIT_RIGHT,  ACTION_FREEZE,
};

#define LINE_KEY(text, index)                                                                      \
	{                                                                                          \
		.name = text, .type = INI_INT,                                                     \
		.offset = offsetof(struct gpio_options, offsets[index]), .min = -1,                \
		.max = GPIO_OFFSET_MAX, .fallback = "-1",                                          \
		.help = "Line of this button on the chip; -1: none.",                              \
	}

static const struct ini_key gpio_keys[] = {
	{"chip", INI_TEXT, offsetof(struct gpio_options, chip), .fallback = "gpiochip0",
	 .help = "The chip's name, label or path."},
	LINE_KEY("threshold_up", 0),
	LINE_KEY("threshold_down", 1),
	LINE_KEY("threshold_next", 2),
	LINE_KEY("view_next", 3),
	LINE_KEY("pose_next", 4),
	LINE_KEY("object", 5),
	LINE_KEY("information", 6),
	LINE_KEY("split_left", 7),
	LINE_KEY("split_right", 8),
	LINE_KEY("freeze", 9),
	{"active_low", INI_BOOL, offsetof(struct gpio_options, active_low), .fallback = "yes",
	 .help = "A pressed button connects its line to ground."},
	{"bias", INI_CHOICE, offsetof(struct gpio_options, bias), .choices = gpio_bias_names,
	 .fallback = "pull-up", .help = "The resistor inside the chip."},
	{"debounce_ms", INI_INT, offsetof(struct gpio_options, debounce_ms), .max = 1000,
	 .fallback = "20", .unit = "ms",
	 .help = "A press counts when its line has been still for so long."},
	{"repeat_after_ms", INI_INT, offsetof(struct gpio_options, repeat_after_ms), .max = 10000,
	 .fallback = "500", .unit = "ms",
	 .help = "A button for threshold or split that is held goes on from then; 0: never."},
	{"repeat_every_ms", INI_INT, offsetof(struct gpio_options, repeat_every_ms), .min = 10,
	 .max = 10000, .fallback = "100", .unit = "ms", .help = "It then steps once in so long."},
	INI_KEYS_END,
};

static int gpio_watch(const struct gpio_buttons *gpio, int descriptor, int index)
{
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = (uint32_t)index};

	return epoll_ctl(gpio->epoll, EPOLL_CTL_ADD, descriptor, &event) ? -errno : 0;
}

static int refuse_line(int err, const struct gpio_options *options, int index, struct fault *fault)
{
	const int offset = options->offsets[index];

	if (err == -ENXIO)
		return fault_say(fault, -EINVAL,
				 "gpio buttons: %s has no line %d (inlay devices lists them)",
				 options->chip, offset);
	return fault_say(fault, err, "gpio buttons: cannot watch line %d of %s for %s: %s%s",
			 offset, options->chip, action_names[line_actions[index]], strerror(-err),
			 err == -EBUSY ? " (is it used twice, or by another program?)" : "");
}

static int open_line(struct gpio_buttons *gpio, const struct gpio_options *options, int index,
		     struct fault *fault)
{
	const struct gpio_line_settings settings = {
		.active_low = options->active_low,
		.bias = (enum gpio_bias)options->bias,
		.settle_ns = options->debounce_ms * NS_PER_MS,
	};
	struct gpio_line *line = &gpio->lines[index];
	int err, level;

	err = gpio_line_open(line, gpio->chip, (unsigned)options->offsets[index], &settings);
	if (err)
		return refuse_line(err, options, index, fault);
	level = gpio_line_level(line);
	if (level < 0)
		return refuse_line(level, options, index, fault);
	button_start(&gpio->buttons[index], level, action_repeats(line_actions[index]));
	err = gpio_watch(gpio, gpio_line_descriptor(line), index);
	return err ? fault_say(fault, err, "gpio buttons: epoll: %s", strerror(-err)) : 0;
}

static int open_lines(struct gpio_buttons *gpio, const struct gpio_options *options,
		      struct fault *fault)
{
	int lines = 0;

	for (int i = 0; i < LINES; i++) {
		int err;

		if (options->offsets[i] < 0)
			continue;
		err = open_line(gpio, options, i, fault);
		if (err)
			return err;
		lines++;
	}
	if (!lines)
		return fault_say(
			fault, -EINVAL,
			"gpio buttons: no button has a line, expected at least one, like gpio.view_next = 17");
	return 0;
}

/* Opens the timer and the epoll descriptor. */
static int open_waiting(struct gpio_buttons *gpio, struct fault *fault)
{
	int err = 0;

	gpio->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (gpio->timer < 0) {
		err = -errno;
		return fault_say(fault, err, "gpio buttons: no timer: %s", strerror(-err));
	}
	gpio->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (gpio->epoll < 0)
		err = -errno;
	else
		err = gpio_watch(gpio, gpio->timer, TIMER);
	return err ? fault_say(fault, err, "gpio buttons: epoll: %s", strerror(-err)) : 0;
}

/* Sets the timer to whatever is due first without an edge. */
static int gpio_arm(struct gpio_buttons *gpio, struct fault *fault)
{
	int64_t at_ns = gpio->look_ns;
	struct itimerspec when = {0};
	int err = 0;

	for (int i = 0; i < LINES; i++) {
		const int64_t due_ns = button_deadline_ns(&gpio->buttons[i], &gpio->timing);

		if (gpio->lines[i].request && due_ns < at_ns)
			at_ns = due_ns;
	}
	when.it_value.tv_sec = (time_t)(at_ns / NS_PER_S);
	when.it_value.tv_nsec = (long)(at_ns % NS_PER_S);
	/* This also makes the descriptor unreadable until then. */
	if (timerfd_settime(gpio->timer, TFD_TIMER_ABSTIME, &when, NULL))
		err = -errno;
	return err ? fault_say(fault, err, "gpio buttons: timer: %s", strerror(-err)) : 0;
}

static int gpio_open(struct buttons *buttons, struct fault *fault)
{
	const struct gpio_options *options = buttons->options;
	struct gpio_buttons *gpio = calloc(1, sizeof(*gpio));
	int err;

	if (!gpio)
		return fault_say(fault, -ENOMEM, "gpio buttons: not enough memory");
	gpio->epoll = -1;
	gpio->timer = -1;
	buttons->state = gpio;
	gpio->timing = (struct button_timing){
		.settle_ns = GPIO_KERNEL_SETTLES ? 0 : options->debounce_ms * NS_PER_MS,
		.repeat_after_ns = options->repeat_after_ms * NS_PER_MS,
		.repeat_every_ns = options->repeat_every_ms * NS_PER_MS,
	};
	err = open_waiting(gpio, fault);
	if (!err)
		err = gpio_chip_open(&gpio->chip, options->chip, "gpio buttons", fault);
	if (!err)
		err = open_lines(gpio, options, fault);
	if (err)
		return err;
	gpio->look_ns = clock_now_ns() + LOOK_EVERY_NS;
	return gpio_arm(gpio, fault);
}

static int gpio_descriptor(struct buttons *buttons)
{
	return ((struct gpio_buttons *)buttons->state)->epoll;
}

/* Reads an edge. 1: it is a press; 0: it is not; -errno. */
static int take_edge(struct gpio_buttons *gpio, int index)
{
	bool level;
	int64_t at_ns, now_ns;
	int err;

	err = gpio_line_edge(&gpio->lines[index], &level, &at_ns);
	if (err)
		return err;
	now_ns = clock_now_ns();
	/* Kernels before 5.7 stamp edges with CLOCK_REALTIME, which is far ahead. */
	if (at_ns > now_ns)
		at_ns = now_ns;
	return button_edge(&gpio->buttons[index], &gpio->timing, level, at_ns);
}

/* Reads edges until one is a press, and returns its line. LINES: no press, all edges are read;
 * -errno. */
static int take_edges(struct gpio_buttons *gpio)
{
	struct epoll_event ready;

	for (int i = 0; i < EDGES_AT_ONCE && epoll_wait(gpio->epoll, &ready, 1, 0) == 1; i++) {
		const int index = (int)ready.data.u32;
		uint64_t ticks;
		int pressed;

		if (index == TIMER) {
			if (read(gpio->timer, &ticks, sizeof(ticks)) < 0 && errno != EAGAIN)
				return -errno;
			continue;
		}
		pressed = ready.events & EPOLLIN ? take_edge(gpio, index) : -ENODEV;
		if (pressed)
			return pressed < 0 ? pressed : index;
	}
	return LINES;
}

/* Reads the level of every line. 0 or -errno. */
static int gpio_look(struct gpio_buttons *gpio, int64_t now_ns)
{
	for (int i = 0; i < LINES; i++) {
		int level;

		if (!gpio->lines[i].request)
			continue;
		level = gpio_line_level(&gpio->lines[i]);
		if (level < 0)
			return level;
		/* Never a press: settled_press() has found no settled level. */
		button_edge(&gpio->buttons[i], &gpio->timing, level, now_ns);
	}
	gpio->look_ns = now_ns + LOOK_EVERY_NS;
	return 0;
}

/* Returns a line that is pressed by settling or by repetition, or LINES. */
static int settled_press(struct gpio_buttons *gpio, int64_t now_ns)
{
	int index = 0;

	while (index < LINES && !(gpio->lines[index].request &&
				  button_settle(&gpio->buttons[index], &gpio->timing, now_ns)))
		index++;
	return index;
}

/* Returns the line that is pressed, LINES or -errno. */
static int next_press(struct gpio_buttons *gpio)
{
	/* Taken before the edges are read: an edge that comes meanwhile cannot have settled. */
	const int64_t now_ns = clock_now_ns();
	int index = take_edges(gpio);

	if (index == LINES)
		index = settled_press(gpio, now_ns);
	if (index == LINES && now_ns >= gpio->look_ns) {
		const int err = gpio_look(gpio, now_ns);

		if (err)
			return err;
	}
	return index;
}

static int gpio_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	struct gpio_buttons *gpio = buttons->state;
	const int index = next_press(gpio);
	int err;

	if (index < 0)
		return fault_say(fault, index, "gpio buttons: the chip is gone: %s",
				 strerror(-index));
	err = gpio_arm(gpio, fault);
	if (err)
		return err;
	if (index == LINES)
		return -EAGAIN;
	press->action = line_actions[index];
	return 0;
}

static void gpio_close(struct buttons *buttons)
{
	struct gpio_buttons *gpio = buttons->state;

	if (!gpio)
		return;
	for (int i = 0; i < LINES; i++)
		gpio_line_close(&gpio->lines[i]);
	gpio_chip_close(gpio->chip);
	if (gpio->epoll >= 0)
		close(gpio->epoll);
	if (gpio->timer >= 0)
		close(gpio->timer);
	free(gpio);
	buttons->state = NULL;
}

static int gpio_list(void (*found)(void *context, const char *line), void *context)
{
	const int err = gpio_lines_list(found, context);

	if (err != -EACCES)
		return err;
	found(context, "there are chips, but not for this user (is it in the group \"gpio\"?)");
	return 0;
}

const struct buttons_ops buttons_gpio = {
	.name = "gpio",
	.description = "push buttons on GPIO lines (libgpiod)",
	.keys = gpio_keys,
	.options_size = sizeof(struct gpio_options),
	.list = gpio_list,
	.open = gpio_open,
	.descriptor = gpio_descriptor,
	.read = gpio_read,
	.close = gpio_close,
};
