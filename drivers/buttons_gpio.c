/*
 * Buttons on GPIO lines, through libgpiod 1.x. A press is an edge to active on a line that was
 * still for the debounce time; both edges are watched, so that a release that bounces is no press.
 */
#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/clock.h"

#define LINES 6
#define OFFSET_MAX 1023

enum gpio_bias { BIAS_AS_IS, BIAS_PULL_UP, BIAS_PULL_DOWN, BIAS_DISABLED };

struct gpio_options {
	char chip[INI_TEXT_MAX];
	int offsets[LINES]; /* in the order of line_actions; -1: none */
	bool active_low;
	int bias; /* enum gpio_bias */
	int debounce_ms;
};

struct gpio_buttons {
	struct gpiod_chip *chip;
	int epoll;
	struct gpiod_line *lines[LINES]; /* requested; NULL: none */
	int64_t last_edge_ns[LINES];	 /* of CLOCK_MONOTONIC; 0: none yet */
	int64_t debounce_ns;
};

static const enum action line_actions[LINES] = {
	ACTION_THRESHOLD_UP, ACTION_THRESHOLD_DOWN, ACTION_VIEW_NEXT,
	ACTION_POSE_NEXT,    ACTION_OBJECT,	    ACTION_FREEZE,
};

static const char *const bias_names[] = {"as-is", "pull-up", "pull-down", "disabled", NULL};

#define LINE_KEY(text, index)                                                                      \
	{                                                                                          \
		.name = text, .type = INI_INT,                                                     \
		.offset = offsetof(struct gpio_options, offsets[index]), .min = -1,                \
		.max = OFFSET_MAX, .fallback = "-1",                                               \
		.help = "Line of this button on the chip; -1: none.",                              \
	}

static const struct ini_key gpio_keys[] = {
	{.name = "chip",
	 .type = INI_TEXT,
	 .offset = offsetof(struct gpio_options, chip),
	 .fallback = "gpiochip0",
	 .help = "The chip's name, label or path."},
	LINE_KEY("threshold_up", 0),
	LINE_KEY("threshold_down", 1),
	LINE_KEY("view_next", 2),
	LINE_KEY("pose_next", 3),
	LINE_KEY("object", 4),
	LINE_KEY("freeze", 5),
	{.name = "active_low",
	 .type = INI_BOOL,
	 .offset = offsetof(struct gpio_options, active_low),
	 .fallback = "yes",
	 .help = "A pressed button connects its line to ground."},
	{.name = "bias",
	 .type = INI_CHOICE,
	 .offset = offsetof(struct gpio_options, bias),
	 .choices = bias_names,
	 .fallback = "pull-up",
	 .help = "The resistor inside the chip."},
	{.name = "debounce_ms",
	 .type = INI_INT,
	 .offset = offsetof(struct gpio_options, debounce_ms),
	 .max = 1000,
	 .fallback = "20",
	 .unit = "ms",
	 .help = "A line must have been still for so long before a press counts."},
	INI_KEYS_END,
};

static int request_flags(const struct gpio_options *options)
{
	static const int bias_flags[] = {
		[BIAS_PULL_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
		[BIAS_PULL_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
		[BIAS_DISABLED] = GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE,
	};

	return bias_flags[options->bias] |
	       (options->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0);
}

static int request_line(struct gpio_buttons *gpio, const struct gpio_options *options, int index,
			struct fault *fault)
{
	const struct gpiod_line_request_config config = {
		.consumer = "inlay",
		.request_type = GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES,
		.flags = request_flags(options),
	};
	const int offset = options->offsets[index];
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = (uint32_t)index};
	struct gpiod_line *line = gpiod_chip_get_line(gpio->chip, (unsigned)offset);
	int err = 0;

	if (!line)
		return fault_say(fault, -EINVAL,
				 "gpio buttons: %s has no line %d, expected 0 to %u", options->chip,
				 offset, gpiod_chip_num_lines(gpio->chip) - 1);
	if (gpiod_line_request(line, &config, 0))
		err = -errno;
	if (err)
		return fault_say(
			fault, err, "gpio buttons: cannot watch line %d of %s for %s: %s%s", offset,
			options->chip, action_names[line_actions[index]], strerror(-err),
			err == -EBUSY ? " (is it used twice, or by another program?)" : "");
	gpio->lines[index] = line;
	if (epoll_ctl(gpio->epoll, EPOLL_CTL_ADD, gpiod_line_event_get_fd(line), &event))
		err = -errno;
	return err ? fault_say(fault, err, "gpio buttons: epoll: %s", strerror(-err)) : 0;
}

static int gpio_open(struct buttons *buttons, struct fault *fault)
{
	const struct gpio_options *options = buttons->options;
	struct gpio_buttons *gpio = calloc(1, sizeof(*gpio));
	int lines = 0;
	int err;

	if (!gpio)
		return fault_say(fault, -ENOMEM, "gpio buttons: not enough memory");
	buttons->state = gpio;
	gpio->debounce_ns = options->debounce_ms * NS_PER_MS;
	gpio->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (gpio->epoll < 0) {
		err = -errno;
		return fault_say(fault, err, "gpio buttons: epoll: %s", strerror(-err));
	}
	gpio->chip = gpiod_chip_open_lookup(options->chip);
	if (!gpio->chip) {
		err = errno ? -errno : -ENODEV;
		return fault_say(fault, err,
				 "gpio buttons: cannot open the chip \"%s\": %s (inlay devices "
				 "lists them)",
				 options->chip, strerror(-err));
	}
	for (int i = 0; i < LINES; i++) {
		if (options->offsets[i] < 0)
			continue;
		err = request_line(gpio, options, i, fault);
		if (err)
			return err;
		lines++;
	}
	if (!lines)
		return fault_say(fault, -EINVAL,
				 "gpio buttons: no button has a line, expected at least one, like "
				 "gpio.view_next = 17");
	return 0;
}

static int gpio_descriptor(struct buttons *buttons)
{
	return ((struct gpio_buttons *)buttons->state)->epoll;
}

/* 1: a press; 0: an edge that is none; -errno. */
static int take_edge(struct gpio_buttons *gpio, int index)
{
	struct gpiod_line_event event;
	int64_t at_ns, still_ns;

	if (gpiod_line_event_read(gpio->lines[index], &event))
		return -errno;
	at_ns = (int64_t)event.ts.tv_sec * NS_PER_S + event.ts.tv_nsec;
	still_ns = at_ns - gpio->last_edge_ns[index];
	gpio->last_edge_ns[index] = at_ns;
	return event.event_type == GPIOD_LINE_EVENT_RISING_EDGE && still_ns >= gpio->debounce_ns;
}

static int gpio_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	struct gpio_buttons *gpio = buttons->state;
	struct epoll_event ready;
	int count;

	while ((count = epoll_wait(gpio->epoll, &ready, 1, 0)) == 1) {
		const int index = (int)ready.data.u32;
		const int pressed = ready.events & EPOLLIN ? take_edge(gpio, index) : -ENODEV;

		if (pressed < 0)
			return fault_say(fault, pressed, "gpio buttons: the chip is gone: %s",
					 strerror(-pressed));
		if (pressed) {
			press->action = line_actions[index];
			return 0;
		}
	}
	return -EAGAIN;
}

static void gpio_close(struct buttons *buttons)
{
	struct gpio_buttons *gpio = buttons->state;

	if (!gpio)
		return;
	if (gpio->epoll >= 0)
		close(gpio->epoll);
	if (gpio->chip)
		gpiod_chip_close(gpio->chip); /* and releases its lines */
	free(gpio);
	buttons->state = NULL;
}

static int list_lines(struct gpiod_chip *chip, void (*found)(void *context, const char *line),
		      void *context)
{
	const unsigned count = gpiod_chip_num_lines(chip);
	char text[256];

	snprintf(text, sizeof(text), "%s [%s], %u lines", gpiod_chip_name(chip),
		 gpiod_chip_label(chip), count);
	found(context, text);
	for (unsigned i = 0; i < count; i++) {
		struct gpiod_line *line = gpiod_chip_get_line(chip, i);
		const char *name = line ? gpiod_line_name(line) : NULL;
		const char *user = line ? gpiod_line_consumer(line) : NULL;

		if (!line)
			return -errno;
		snprintf(text, sizeof(text), "  line %u%s%s: %s%s%s", i, name ? " " : "",
			 name ? name : "",
			 gpiod_line_direction(line) == GPIOD_LINE_DIRECTION_INPUT ? "input"
										  : "output",
			 user ? ", used by " : "", user ? user : "");
		found(context, text);
	}
	return 0;
}

static int gpio_list(void (*found)(void *context, const char *line), void *context)
{
	struct gpiod_chip_iter *chips = gpiod_chip_iter_new();
	struct gpiod_chip *chip;
	int err = chips ? 0 : -errno;

	if (err == -EACCES) {
		found(context,
		      "there are chips, but not for this user (is it in the group \"gpio\"?)");
		return 0;
	}
	if (err)
		return err;
	gpiod_foreach_chip(chips, chip)
	{
		if (!err)
			err = list_lines(chip, found, context);
	}
	gpiod_chip_iter_free(chips);
	return err;
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
