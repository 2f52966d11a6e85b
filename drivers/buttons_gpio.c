/* SPDX-License-Identifier: MIT */
/*
 * Push buttons on GPIO lines, which gpio/gpio.h reads. One epoll descriptor joins their edges with a
 * timer for what is due without an edge: a repetition, and once a second a look at every line, which
 * notices a lost chip and makes up for a lost edge.
 */
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/gpio/gpio.h"
#include "hal/base/clock.h"

#define LINES 10
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
	int lines; /* descriptor of their request; -1: closed, as are the next two */
	int timer; /* one shot, of CLOCK_MONOTONIC */
	int epoll; /* of both */
	struct button_timing timing;
	int count; /* lines in use, in the order of the request */
	uint32_t offsets[LINES];
	enum action actions[LINES];
	struct button buttons[LINES];
	int64_t look_ns; /* time of the next look at every line */
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

/* ---- opening ---- */

/* Takes a line of the options into the request. */
static int take_line(struct gpio_buttons *gpio, int chip, const struct gpiochip_info *chip_info,
		     int offset, enum action action, struct fault *fault)
{
	struct gpio_v2_line_info info;
	int err;

	if ((unsigned)offset >= chip_info->lines)
		return fault_say(fault, -EINVAL,
				 "gpio buttons: %s has no line %d (inlay devices lists them)",
				 chip_info->label, offset);
	err = gpio_line_ask(chip, (unsigned)offset, &info);
	if (!err && info.flags & GPIO_V2_LINE_FLAG_USED)
		return fault_say(
			fault, -EBUSY,
			"gpio buttons: cannot watch line %d of %s for %s: it is used by \"%s\"",
			offset, chip_info->label, action_names[action], info.consumer);
	if (err)
		return fault_say(fault, err, "gpio buttons: line %d of %s: %s", offset,
				 chip_info->label, strerror(-err));
	gpio->actions[gpio->count] = action;
	gpio->offsets[gpio->count++] = (uint32_t)offset;
	return 0;
}

static int open_lines(struct gpio_buttons *gpio, const struct gpio_options *options, int chip,
		      const struct gpiochip_info *info, struct fault *fault)
{
	uint64_t levels;
	int err = 0;

	for (int i = 0; i < LINES && !err; i++)
		if (options->offsets[i] >= 0)
			err = take_line(gpio, chip, info, options->offsets[i], line_actions[i],
					fault);
	if (err)
		return err;
	if (!gpio->count)
		return fault_say(
			fault, -EINVAL,
			"gpio buttons: no button has a line, expected at least one, like gpio.view_next = 17");
	gpio->lines = gpio_lines_open(chip, gpio->offsets, gpio->count, options->active_low,
				      (enum gpio_bias)options->bias, options->debounce_ms);
	err = gpio->lines < 0 ? gpio->lines : gpio_lines_levels(gpio->lines, gpio->count, &levels);
	if (err)
		return fault_say(fault, err, "gpio buttons: cannot watch the lines of %s: %s%s",
				 info->label, strerror(-err),
				 err == -EBUSY ? " (is one used twice?)" : "");
	for (int i = 0; i < gpio->count; i++)
		button_start(&gpio->buttons[i], levels >> i & 1, action_repeats(gpio->actions[i]));
	return 0;
}

/* Opens the timer and the epoll descriptor. */
static int open_waiting(struct gpio_buttons *gpio, struct fault *fault)
{
	struct epoll_event event = {.events = EPOLLIN};
	int err = 0;

	gpio->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	gpio->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (gpio->timer < 0 || gpio->epoll < 0 ||
	    epoll_ctl(gpio->epoll, EPOLL_CTL_ADD, gpio->timer, &event) ||
	    epoll_ctl(gpio->epoll, EPOLL_CTL_ADD, gpio->lines, &event))
		err = -errno;
	return err ? fault_say(fault, err, "gpio buttons: cannot wait for edges: %s",
			       strerror(-err))
		   : 0;
}

/* Sets the timer to whatever is due first without an edge. */
static int gpio_arm(struct gpio_buttons *gpio, struct fault *fault)
{
	int64_t at_ns = gpio->look_ns;
	struct itimerspec when = {0};
	int err = 0;

	for (int i = 0; i < gpio->count; i++)
		if (gpio->buttons[i].repeat_ns < at_ns)
			at_ns = gpio->buttons[i].repeat_ns;
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
	struct gpiochip_info info;
	int chip, err;

	if (!gpio)
		return fault_say(fault, -ENOMEM, "gpio buttons: not enough memory");
	gpio->lines = gpio->timer = gpio->epoll = -1;
	buttons->state = gpio;
	gpio->timing = (struct button_timing){
		.repeat_after_ns = options->repeat_after_ms * NS_PER_MS,
		.repeat_every_ns = options->repeat_every_ms * NS_PER_MS,
	};
	chip = gpio_chip_open(options->chip, &info, fault);
	if (chip < 0)
		return chip;
	err = open_lines(gpio, options, chip, &info, fault);
	close(chip); /* the request keeps its lines */
	if (!err)
		err = open_waiting(gpio, fault);
	if (err)
		return err;
	gpio->look_ns = clock_now_ns() + LOOK_EVERY_NS;
	return gpio_arm(gpio, fault);
}

static int gpio_descriptor(struct buttons *buttons)
{
	return ((struct gpio_buttons *)buttons->state)->epoll;
}

/* ---- reading: each returns the number of a button that is pressed, gpio->count, or -errno ---- */

static int take_edge(struct gpio_buttons *gpio)
{
	struct gpio_v2_line_event event;
	int i = 0;

	if (read(gpio->lines, &event, sizeof(event)) != sizeof(event))
		return -errno;
	while (i < gpio->count && gpio->offsets[i] != event.offset)
		i++;
	if (i < gpio->count &&
	    button_take(&gpio->buttons[i], &gpio->timing,
			event.id == GPIO_V2_LINE_EVENT_RISING_EDGE, (int64_t)event.timestamp_ns))
		return i;
	return gpio->count;
}

static int take_edges(struct gpio_buttons *gpio)
{
	struct pollfd ready = {.fd = gpio->lines, .events = POLLIN};
	int pressed = gpio->count;

	for (int i = 0; i < EDGES_AT_ONCE && pressed == gpio->count && poll(&ready, 1, 0) == 1; i++)
		pressed = ready.revents & POLLIN ? take_edge(gpio) : -ENODEV;
	return pressed;
}

/* Looks at the level of every line. */
static int gpio_look(struct gpio_buttons *gpio, int64_t now_ns)
{
	int pressed = gpio->count;
	uint64_t levels;
	const int err = gpio_lines_levels(gpio->lines, gpio->count, &levels);

	if (err)
		return err;
	for (int i = 0; i < gpio->count && pressed == gpio->count; i++)
		if (button_take(&gpio->buttons[i], &gpio->timing, levels >> i & 1, now_ns))
			pressed = i;
	if (pressed == gpio->count)
		gpio->look_ns = now_ns + LOOK_EVERY_NS;
	return pressed;
}

static int next_press(struct gpio_buttons *gpio)
{
	const int64_t now_ns = clock_now_ns();
	int pressed = take_edges(gpio);

	for (int i = 0; i < gpio->count && pressed == gpio->count; i++)
		if (button_repeat(&gpio->buttons[i], &gpio->timing, now_ns))
			pressed = i;
	return pressed == gpio->count && now_ns >= gpio->look_ns ? gpio_look(gpio, now_ns)
								 : pressed;
}

static int gpio_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	struct gpio_buttons *gpio = buttons->state;
	const int pressed = next_press(gpio);
	int err;

	if (pressed < 0)
		return fault_say(fault, pressed, "gpio buttons: the chip is gone: %s",
				 strerror(-pressed));
	err = gpio_arm(gpio, fault);
	if (err)
		return err;
	if (pressed == gpio->count)
		return -EAGAIN;
	press->action = gpio->actions[pressed];
	return 0;
}

static void gpio_close(struct buttons *buttons)
{
	struct gpio_buttons *gpio = buttons->state;

	if (!gpio)
		return;
	for (int i = 0; i < 3; i++) {
		const int fd = (const int[]){gpio->lines, gpio->timer, gpio->epoll}[i];

		if (fd >= 0)
			close(fd);
	}
	free(gpio);
	buttons->state = NULL;
}

static int gpio_list(void (*found)(void *context, const char *line), void *context)
{
	const int err = gpio_list_chips(found, context);

	if (err != -EACCES)
		return err;
	found(context, "there are chips, but not for this user (is it in the group \"gpio\"?)");
	return 0;
}

const struct buttons_ops buttons_gpio = {
	.name = "gpio",
	.description = "push buttons on GPIO lines",
	.keys = gpio_keys,
	.options_size = sizeof(struct gpio_options),
	.list = gpio_list,
	.open = gpio_open,
	.descriptor = gpio_descriptor,
	.read = gpio_read,
	.close = gpio_close,
};
