/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/device/camera.h"
#include "hal/device/node_link.h"

enum { LINE = sizeof(((struct camera_listing *)0)->lines[0]), LINES_MAX = 1000 };

/* Adds a line; leaves it out if memory or LINES_MAX is exhausted, because a listing is only for
 * reading. */
__attribute__((format(printf, 2, 3))) static void add_line(struct camera_listing *listing,
							   const char *format, ...)
{
	va_list arguments;
	void *grown;

	if (listing->line_count >= LINES_MAX)
		return;
	grown = realloc(listing->lines, (size_t)(listing->line_count + 1) * LINE);
	if (!grown)
		return;
	listing->lines = grown;
	va_start(arguments, format);
	vsnprintf(listing->lines[listing->line_count], LINE, format, arguments);
	va_end(arguments);
	listing->line_count++;
}

/* Writes the rates that the device offers at one size: " 30 15 7.5" or " 1 to 60". */
static void rates_text(int fd, uint32_t fourcc, unsigned width, unsigned height, char *text,
		       size_t room)
{
	size_t used = 0;

	text[0] = '\0';
	for (unsigned i = 0; i < 32 && used < room; i++) {
		struct v4l2_frmivalenum rate = {
			.index = i, .pixel_format = fourcc, .width = width, .height = height};

		if (device_ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &rate))
			return;
		if (rate.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
			snprintf(text, room, " %.4g to %.4g", v4l2_rate_of(&rate.stepwise.max),
				 v4l2_rate_of(&rate.stepwise.min));
			return;
		}
		used += (size_t)snprintf(text + used, room - used, " %.4g",
					 v4l2_rate_of(&rate.discrete));
	}
}

static void add_size(int fd, struct camera_listing *listing, const char *name,
		     const struct v4l2_frmsizeenum *size)
{
	char rates[80];

	if (size->type != V4L2_FRMSIZE_TYPE_DISCRETE) {
		const struct v4l2_frmsize_stepwise *s = &size->stepwise;

		rates_text(fd, size->pixel_format, s->max_width, s->max_height, rates,
			   sizeof(rates));
		add_line(listing, "%s %ux%u to %ux%u%s%s", name, s->min_width, s->min_height,
			 s->max_width, s->max_height, rates, rates[0] ? " Hz" : "");
		return;
	}
	rates_text(fd, size->pixel_format, size->discrete.width, size->discrete.height, rates,
		   sizeof(rates));
	add_line(listing, "%s %ux%u%s%s", name, size->discrete.width, size->discrete.height, rates,
		 rates[0] ? " Hz" : "");
}

static void add_formats(int fd, unsigned type, struct camera_listing *listing)
{
	for (unsigned i = 0;; i++) {
		struct v4l2_fmtdesc format = {.index = i, .type = type};
		const struct v4l2_layout *layout;
		char name[48], code[5];
		unsigned sizes = 0;

		if (device_ioctl(fd, VIDIOC_ENUM_FMT, &format))
			return;
		layout = v4l2_layout_of(format.pixelformat);
		v4l2_fourcc_text(format.pixelformat, code);
		snprintf(name, sizeof(name), "%s %s", code,
			 layout ? pixel_format_names[layout->format] : "(not supported)");
		for (;; sizes++) {
			struct v4l2_frmsizeenum size = {.index = sizes,
							.pixel_format = format.pixelformat};

			if (device_ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &size))
				break;
			add_size(fd, listing, name, &size);
			if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE)
				break;
		}
		if (sizes == 0)
			add_line(listing, "%s", name);
	}
}

/* Writes the families of standards, by the names that v4l2.standard accepts. */
static const char *standards_text(v4l2_std_id standards, char text[32])
{
	snprintf(text, 32, "%s%s%s", standards & V4L2_STD_PAL ? " PAL" : "",
		 standards & V4L2_STD_NTSC ? " NTSC" : "",
		 standards & V4L2_STD_SECAM ? " SECAM" : "");
	return text;
}

static void add_inputs(int fd, struct camera_listing *listing)
{
	for (unsigned i = 0;; i++) {
		struct v4l2_input input = {.index = i};
		char standards[32];

		if (device_ioctl(fd, VIDIOC_ENUMINPUT, &input))
			return;
		add_line(listing, "input %u \"%s\"%s%s", i, (const char *)input.name,
			 input.capabilities & V4L2_IN_CAP_STD ? standards_text(input.std, standards)
							      : "",
			 input.status & V4L2_IN_ST_NO_SIGNAL ? ", no signal" : "");
	}
}

static const char *control_remark(const struct v4l2_query_ext_ctrl *control)
{
	if (control->flags & V4L2_CTRL_FLAG_READ_ONLY)
		return ", read only";
	return control->flags & V4L2_CTRL_FLAG_INACTIVE ? ", no effect now" : "";
}

static void add_menu(int fd, const struct v4l2_query_ext_ctrl *control, const char *name,
		     struct camera_listing *listing)
{
	for (int64_t i = control->minimum; i <= control->maximum; i++) {
		char entry[V4L2_CONTROL_NAME_MAX];

		if (v4l2_menu_entry(fd, control, i, entry) && entry[0])
			add_line(listing, "control %s=%s (%lld)", name, entry, (long long)i);
	}
}

static void add_control(int fd, const struct v4l2_query_ext_ctrl *control,
			struct camera_listing *listing)
{
	char name[V4L2_CONTROL_NAME_MAX], now[32] = "";
	int64_t value;

	v4l2_control_name(control->name, name);
	if (control->type == V4L2_CTRL_TYPE_BUTTON) {
		add_line(listing, "control %s, a button%s", name, control_remark(control));
		return;
	}
	if (v4l2_get_control(fd, control, &value) == 0)
		snprintf(now, sizeof(now), ", now %lld", (long long)value);
	add_line(listing, "control %s %lld..%lld, default %lld%s%s", name,
		 (long long)control->minimum, (long long)control->maximum,
		 (long long)control->default_value, now, control_remark(control));
	if (control->type == V4L2_CTRL_TYPE_MENU || control->type == V4L2_CTRL_TYPE_INTEGER_MENU)
		add_menu(fd, control, name, listing);
}

static void add_controls(int fd, struct camera_listing *listing)
{
	struct v4l2_query_ext_ctrl control = {.id = 0};

	while (v4l2_next_control(fd, &control))
		add_control(fd, &control, listing);
}

/* Adds the names that stay valid when the kernel renumbers nodes. */
static void add_links(const char *node, struct camera_listing *listing)
{
	static const char *const folders[] = {"/dev/v4l/by-id", "/dev/v4l/by-path"};
	char port[V4L2_PORT_MAX], link[INI_PATH_MAX];
	int number;

	if (sscanf(node, "/dev/video%d", &number) == 1 && v4l2_port_of_node(number, port))
		add_line(listing, "USB port %s", port);
	for (int i = 0; i < 2; i++)
		if (node_link(folders[i], node, link, sizeof(link)))
			add_line(listing, "link %s", link);
}

static void listing_describe(int fd, const struct v4l2_capability *capability,
			     struct camera_listing *listing)
{
	device_name(capability->card, listing->name, sizeof(listing->name));
	snprintf(listing->bus, sizeof(listing->bus), "%s", (const char *)capability->bus_info);
	add_links(listing->device, listing);
	add_formats(fd, device_buffer_type(capability), listing);
	add_inputs(fd, listing);
	add_controls(fd, listing);
}

/* Lists a camera; one that this user may not open is listed with the reason. False: there is
 * none. */
static bool list_one(int index, void (*found)(void *, const struct camera_listing *), void *context)
{
	struct camera_listing listing = {.lines = NULL};
	struct v4l2_capability capability;
	struct fault fault = {""};
	int fd;

	snprintf(listing.device, sizeof(listing.device), "/dev/video%d", index);
	fd = device_open(listing.device, &capability, &fault);
	if (fd >= 0 && device_is_part(&capability)) {
		close(fd);
		return false;
	}
	if (fd >= 0) {
		listing_describe(fd, &capability, &listing);
		close(fd);
	} else if (camera_situation_of(fd) == CAMERA_NO_DEVICE || fd == -ENOTTY) {
		return false;
	} else {
		add_line(&listing, "%s", camera_situation_names[camera_situation_of(fd)]);
	}
	found(context, &listing);
	free(listing.lines);
	return true;
}

int v4l2_list(void (*found)(void *context, const struct camera_listing *listing), void *context)
{
	int count = 0;

	for (int i = 0; i < V4L2_DEVICES_MAX; i++)
		count += list_one(i, found, context);
	return count;
}
