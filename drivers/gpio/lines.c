/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/gpio/gpio.h"

const char *const gpio_bias_names[] = {"as-is", "pull-up", "pull-down", "disabled", NULL};

static int chip_open(const char *path, struct gpiochip_info *info)
{
	const int chip = open(path, O_RDWR | O_CLOEXEC);
	int err;

	if (chip < 0)
		return -errno;
	if (!ioctl(chip, GPIO_GET_CHIPINFO_IOCTL, info))
		return chip;
	err = -errno;
	close(chip);
	return err;
}

static int is_chip(const struct dirent *entry)
{
	return !strncmp(entry->d_name, "gpiochip", 8);
}

/* Calls visit() for each chip, in the order of their numbers, until it returns true, and returns
 * that chip's descriptor; 0: no chip is left; -EACCES: this user may not open some chip. */
static int each_chip(bool (*visit)(int chip, const struct gpiochip_info *info, void *context),
		     void *context, struct gpiochip_info *info)
{
	struct dirent **entries;
	const int count = scandir("/dev", &entries, is_chip, versionsort);
	int found = count < 0 ? -errno : 0, refused = 0;

	for (int i = 0; i < count; i++) {
		char path[sizeof(entries[i]->d_name) + 8];
		int chip;

		snprintf(path, sizeof(path), "/dev/%s", entries[i]->d_name);
		free(entries[i]);
		chip = found ? 0 : chip_open(path, info);
		if (chip == -EACCES)
			refused = chip;
		if (chip > 0 && visit(chip, info, context))
			found = chip;
		else if (chip > 0)
			close(chip);
	}
	if (count >= 0)
		free(entries);
	return found ? found : refused;
}

static bool is_called(int chip, const struct gpiochip_info *info, void *name)
{
	(void)chip;
	return !strcmp(info->name, name) || !strcmp(info->label, name);
}

int gpio_chip_open(const char *name, struct gpiochip_info *info, struct fault *fault)
{
	const int chip = *name == '/' ? chip_open(name, info)
				      : each_chip(is_called, (void *)(uintptr_t)name, info);

	if (chip == 0 || chip == -ENOENT)
		return fault_say(fault, -ENODEV,
				 "gpio buttons: there is no chip \"%s\" (inlay devices lists them)",
				 name);
	if (chip < 0)
		return fault_say(fault, chip, "gpio buttons: cannot open the chip \"%s\": %s%s",
				 name, strerror(-chip),
				 chip == -EACCES ? " (is this user in the group \"gpio\"?)" : "");
	return chip;
}

int gpio_line_ask(int chip, unsigned offset, struct gpio_v2_line_info *info)
{
	*info = (struct gpio_v2_line_info){.offset = offset};
	return ioctl(chip, GPIO_V2_GET_LINEINFO_IOCTL, info) ? -errno : 0;
}

int gpio_lines_open(int chip, const uint32_t *offsets, int count, bool active_low,
		    enum gpio_bias bias, int debounce_ms)
{
	static const uint64_t biases[] = {
		[GPIO_BIAS_PULL_UP] = GPIO_V2_LINE_FLAG_BIAS_PULL_UP,
		[GPIO_BIAS_PULL_DOWN] = GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN,
		[GPIO_BIAS_DISABLED] = GPIO_V2_LINE_FLAG_BIAS_DISABLED,
	};
	struct gpio_v2_line_request request = {
		.consumer = "inlay",
		.num_lines = (uint32_t)count,
		.config = {.flags = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING |
				    GPIO_V2_LINE_FLAG_EDGE_FALLING | biases[bias] |
				    (active_low ? GPIO_V2_LINE_FLAG_ACTIVE_LOW : 0),
			   .num_attrs = debounce_ms > 0,
			   .attrs = {{.attr = {.id = GPIO_V2_LINE_ATTR_ID_DEBOUNCE,
					       .debounce_period_us = (uint32_t)debounce_ms * 1000},
				      .mask = UINT64_MAX >> (64 - count)}}},
	};

	memcpy(request.offsets, offsets, (size_t)count * sizeof(*offsets));
	return ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &request) ? -errno : request.fd;
}

int gpio_lines_levels(int lines, int count, uint64_t *levels)
{
	struct gpio_v2_line_values values = {.mask = UINT64_MAX >> (64 - count)};

	if (ioctl(lines, GPIO_V2_LINE_GET_VALUES_IOCTL, &values))
		return -errno;
	*levels = values.bits;
	return 0;
}

struct listing {
	void (*found)(void *context, const char *line);
	void *context;
};

static bool list_lines(int chip, const struct gpiochip_info *info, void *context)
{
	const struct listing *listing = context;
	char text[256];

	snprintf(text, sizeof(text), "%s [%s], %u lines", info->name, info->label, info->lines);
	listing->found(listing->context, text);
	for (unsigned i = 0; i < info->lines; i++) {
		struct gpio_v2_line_info line;

		if (gpio_line_ask(chip, i, &line))
			continue;
		snprintf(text, sizeof(text), "  line %u%s%s: %s%s%s", i, *line.name ? " " : "",
			 line.name, line.flags & GPIO_V2_LINE_FLAG_OUTPUT ? "output" : "input",
			 *line.consumer ? ", used by " : "", line.consumer);
		listing->found(listing->context, text);
	}
	return false;
}

int gpio_list_chips(void (*found)(void *context, const char *line), void *context)
{
	struct listing listing = {found, context};
	struct gpiochip_info info;

	return each_chip(list_lines, &listing, &info);
}
