/* SPDX-License-Identifier: MIT */
#include "drivers/gpio/lines.h"

#include <dirent.h>
#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"

#define CONSUMER "inlay"

const char *const gpio_bias_names[] = {"as-is", "pull-up", "pull-down", "disabled", NULL};

static void list_chip(const char *name, const char *label, unsigned lines,
		      void (*found)(void *context, const char *line), void *context)
{
	char text[256];

	snprintf(text, sizeof(text), "%s [%s], %u lines", name, label, lines);
	found(context, text);
}

/* name and user may be NULL: there is none. */
static void list_line(unsigned offset, const char *name, bool input, const char *user,
		      void (*found)(void *context, const char *line), void *context)
{
	char text[256];

	snprintf(text, sizeof(text), "  line %u%s%s: %s%s%s", offset, name ? " " : "",
		 name ? name : "", input ? "input" : "output", user ? ", used by " : "",
		 user ? user : "");
	found(context, text);
}

#if GPIOD_MAJOR < 2

static int chip_find(struct gpiod_chip **chip, const char *name)
{
	errno = 0;
	*chip = gpiod_chip_open_lookup(name);
	if (*chip)
		return 0;
	return errno && errno != ENOENT ? -errno : -ENODEV;
}

void gpio_chip_close(struct gpiod_chip *chip)
{
	if (chip)
		gpiod_chip_close(chip);
}

int gpio_line_open(struct gpio_line *line, struct gpiod_chip *chip, unsigned offset,
		   const struct gpio_line_settings *settings)
{
	static const int bias_flags[] = {
		[GPIO_BIAS_PULL_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
		[GPIO_BIAS_PULL_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
		[GPIO_BIAS_DISABLED] = GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE,
	};
	const struct gpiod_line_request_config config = {
		.consumer = CONSUMER,
		.request_type = GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES,
		.flags = bias_flags[settings->bias] |
			 (settings->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0),
	};
	struct gpiod_line *request;

	if (offset >= gpiod_chip_num_lines(chip))
		return -ENXIO;
	request = gpiod_chip_get_line(chip, offset);
	if (!request || gpiod_line_request(request, &config, 0))
		return -errno;
	*line = (struct gpio_line){.request = request, .offset = offset};
	return 0;
}

int gpio_line_descriptor(const struct gpio_line *line)
{
	return gpiod_line_event_get_fd(line->request);
}

int gpio_line_level(const struct gpio_line *line)
{
	const int level = gpiod_line_get_value(line->request);

	return level < 0 ? -errno : level;
}

int gpio_line_edge(const struct gpio_line *line, bool *level, int64_t *at_ns)
{
	struct gpiod_line_event event;

	if (gpiod_line_event_read(line->request, &event))
		return -errno;
	*level = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE;
	*at_ns = (int64_t)event.ts.tv_sec * NS_PER_S + event.ts.tv_nsec;
	return 0;
}

void gpio_line_close(struct gpio_line *line)
{
	if (line->request)
		gpiod_line_release(line->request);
	*line = (struct gpio_line){0};
}

static int list_lines(struct gpiod_chip *chip, void (*found)(void *context, const char *line),
		      void *context)
{
	const unsigned count = gpiod_chip_num_lines(chip);

	list_chip(gpiod_chip_name(chip), gpiod_chip_label(chip), count, found, context);
	for (unsigned i = 0; i < count; i++) {
		struct gpiod_line *line = gpiod_chip_get_line(chip, i);

		if (!line)
			return -errno;
		list_line(i, gpiod_line_name(line),
			  gpiod_line_direction(line) == GPIOD_LINE_DIRECTION_INPUT,
			  gpiod_line_consumer(line), found, context);
	}
	return 0;
}

int gpio_lines_list(void (*found)(void *context, const char *line), void *context)
{
	struct gpiod_chip_iter *chips = gpiod_chip_iter_new();
	struct gpiod_chip *chip;
	int err = chips ? 0 : -errno;

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

#else

void gpio_chip_close(struct gpiod_chip *chip)
{
	if (chip)
		gpiod_chip_close(chip);
}

static int is_chip(const struct dirent *entry)
{
	return !strncmp(entry->d_name, "gpiochip", 8);
}

/* Calls visit() for each chip until it returns a number other than 0, and returns that number.
 * -EACCES: this user may not open some chip. */
static int each_chip(int (*visit)(struct gpiod_chip *chip, struct gpiod_chip_info *info,
				  void *context),
		     void *context)
{
	struct dirent **entries;
	const int count = scandir("/dev", &entries, is_chip, versionsort);
	int result = 0, refused = 0;

	if (count < 0)
		return -errno;
	for (int i = 0; i < count; i++) {
		struct gpiod_chip *chip = NULL;
		struct gpiod_chip_info *info = NULL;
		char path[sizeof(entries[i]->d_name) + 8];

		snprintf(path, sizeof(path), "/dev/%s", entries[i]->d_name);
		free(entries[i]);
		if (result)
			continue;
		chip = gpiod_chip_open(path);
		if (!chip && errno == EACCES)
			refused = -EACCES;
		if (chip)
			info = gpiod_chip_get_info(chip);
		if (info)
			result = visit(chip, info, context);
		if (info)
			gpiod_chip_info_free(info);
		gpio_chip_close(chip);
	}
	free(entries);
	return result ? result : refused;
}

struct chip_search {
	const char *name;
	char path[256]; /* of the chip that was found */
};

static int compare_chip(struct gpiod_chip *chip, struct gpiod_chip_info *info, void *context)
{
	struct chip_search *search = context;
	const char *path = gpiod_chip_get_path(chip);

	if (strcmp(search->name, path) && strcmp(search->name, gpiod_chip_info_get_name(info)) &&
	    strcmp(search->name, gpiod_chip_info_get_label(info)))
		return 0;
	snprintf(search->path, sizeof(search->path), "%s", path);
	return 1;
}

static int chip_find(struct gpiod_chip **chip, const char *name)
{
	struct chip_search search = {.name = name};
	int found;

	*chip = NULL;
	if (name[0] == '/') {
		*chip = gpiod_chip_open(name); /* follows links */
	} else {
		found = each_chip(compare_chip, &search);
		if (found <= 0)
			return found ? found : -ENODEV;
		*chip = gpiod_chip_open(search.path);
	}
	if (*chip)
		return 0;
	return errno == ENOENT ? -ENODEV : -errno;
}

static unsigned count_lines(struct gpiod_chip *chip)
{
	struct gpiod_chip_info *info = gpiod_chip_get_info(chip);
	const unsigned lines = info ? (unsigned)gpiod_chip_info_get_num_lines(info) : 0;

	if (info)
		gpiod_chip_info_free(info);
	return lines;
}

static int settings_apply(struct gpiod_line_settings *to, const struct gpio_line_settings *from)
{
	static const enum gpiod_line_bias biases[] = {
		[GPIO_BIAS_AS_IS] = GPIOD_LINE_BIAS_AS_IS,
		[GPIO_BIAS_PULL_UP] = GPIOD_LINE_BIAS_PULL_UP,
		[GPIO_BIAS_PULL_DOWN] = GPIOD_LINE_BIAS_PULL_DOWN,
		[GPIO_BIAS_DISABLED] = GPIOD_LINE_BIAS_DISABLED,
	};

	gpiod_line_settings_set_active_low(to, from->active_low);
	gpiod_line_settings_set_debounce_period_us(to, (unsigned long)(from->settle_ns / 1000));
	if (gpiod_line_settings_set_direction(to, GPIOD_LINE_DIRECTION_INPUT) ||
	    gpiod_line_settings_set_edge_detection(to, GPIOD_LINE_EDGE_BOTH) ||
	    gpiod_line_settings_set_bias(to, biases[from->bias]))
		return -errno;
	return 0;
}

/* Requests each line alone, so that an error concerns that line. */
static int request_line(struct gpio_line *line, struct gpiod_chip *chip,
			struct gpiod_line_settings *settings)
{
	struct gpiod_request_config *config = gpiod_request_config_new();
	struct gpiod_line_config *lines = gpiod_line_config_new();
	int err = config && lines ? 0 : -ENOMEM;

	if (err)
		goto free_config;
	gpiod_request_config_set_consumer(config, CONSUMER);
	if (gpiod_line_config_add_line_settings(lines, &line->offset, 1, settings) == 0)
		line->request = gpiod_chip_request_lines(chip, config, lines);
	if (!line->request)
		err = -errno;
free_config:
	if (lines)
		gpiod_line_config_free(lines);
	if (config)
		gpiod_request_config_free(config);
	return err;
}

int gpio_line_open(struct gpio_line *line, struct gpiod_chip *chip, unsigned offset,
		   const struct gpio_line_settings *settings)
{
	struct gpiod_line_settings *applied;
	int err;

	*line = (struct gpio_line){.offset = offset};
	if (offset >= count_lines(chip))
		return -ENXIO;
	applied = gpiod_line_settings_new();
	if (!applied)
		return -ENOMEM;
	err = settings_apply(applied, settings);
	if (!err)
		err = request_line(line, chip, applied);
	gpiod_line_settings_free(applied);
	if (err)
		return err;
	line->edge = gpiod_edge_event_buffer_new(1);
	if (!line->edge) {
		gpio_line_close(line);
		return -ENOMEM;
	}
	return 0;
}

int gpio_line_descriptor(const struct gpio_line *line)
{
	return gpiod_line_request_get_fd(line->request);
}

int gpio_line_level(const struct gpio_line *line)
{
	const enum gpiod_line_value level = gpiod_line_request_get_value(line->request,
									 line->offset);

	if (level == GPIOD_LINE_VALUE_ERROR)
		return -errno;
	return level == GPIOD_LINE_VALUE_ACTIVE;
}

int gpio_line_edge(const struct gpio_line *line, bool *level, int64_t *at_ns)
{
	struct gpiod_edge_event *event;

	if (gpiod_line_request_read_edge_events(line->request, line->edge, 1) < 0)
		return -errno;
	event = gpiod_edge_event_buffer_get_event(line->edge, 0);
	*level = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
	*at_ns = (int64_t)gpiod_edge_event_get_timestamp_ns(event);
	return 0;
}

void gpio_line_close(struct gpio_line *line)
{
	if (line->edge)
		gpiod_edge_event_buffer_free(line->edge);
	if (line->request)
		gpiod_line_request_release(line->request);
	*line = (struct gpio_line){0};
}

struct lines_listing {
	void (*found)(void *context, const char *line);
	void *context;
};

static int list_lines(struct gpiod_chip *chip, struct gpiod_chip_info *info, void *context)
{
	const struct lines_listing *listing = context;
	const unsigned count = (unsigned)gpiod_chip_info_get_num_lines(info);

	list_chip(gpiod_chip_info_get_name(info), gpiod_chip_info_get_label(info), count,
		  listing->found, listing->context);
	for (unsigned i = 0; i < count; i++) {
		struct gpiod_line_info *line = gpiod_chip_get_line_info(chip, i);

		if (!line)
			return -errno;
		list_line(i, gpiod_line_info_get_name(line),
			  gpiod_line_info_get_direction(line) == GPIOD_LINE_DIRECTION_INPUT,
			  gpiod_line_info_get_consumer(line), listing->found, listing->context);
		gpiod_line_info_free(line);
	}
	return 0;
}

int gpio_lines_list(void (*found)(void *context, const char *line), void *context)
{
	struct lines_listing listing = {.found = found, .context = context};

	return each_chip(list_lines, &listing);
}

#endif

int gpio_chip_open(struct gpiod_chip **chip, const char *name, const char *user,
		   struct fault *fault)
{
	const int err = chip_find(chip, name);

	if (err == -ENODEV)
		return fault_say(fault, err,
				 "%s: there is no chip \"%s\" (inlay devices lists them)", user,
				 name);
	if (err)
		return fault_say(fault, err, "%s: cannot open the chip \"%s\": %s%s", user, name,
				 strerror(-err),
				 err == -EACCES ? " (is this user in the group \"gpio\"?)" : "");
	return 0;
}
