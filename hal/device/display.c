/* SPDX-License-Identifier: MIT */
#include "hal/device/display.h"

#include <errno.h>
#include <string.h>

const char *const display_situation_names[] = {
	"fine",	   "no device", "no screen", "busy", "no permission",
	"no mode", "stalled",	"broken",    NULL,
};

_Static_assert(sizeof(display_situation_names) / sizeof(display_situation_names[0]) ==
		       DISPLAY_SITUATION_COUNT + 1,
	       "a name for each situation");

/* Sets the situation after an error, unless the driver has set it. */
static void name_situation(struct display *display, int err)
{
	if (!err || display->situation != DISPLAY_FINE)
		return;
	display->situation = err == -ENODEV			 ? DISPLAY_NO_DEVICE
			     : err == -ENOLINK || err == -ESTALE ? DISPLAY_NO_SCREEN
			     : err == -EACCES || err == -EPERM	 ? DISPLAY_NO_PERMISSION
			     : err == -EBUSY			 ? DISPLAY_BUSY
			     : err == -ETIMEDOUT		 ? DISPLAY_STALLED
								 : DISPLAY_BROKEN;
}

bool display_may_return(enum display_situation situation)
{
	switch (situation) {
	case DISPLAY_NO_DEVICE:
	case DISPLAY_NO_SCREEN:
	case DISPLAY_BUSY:
	case DISPLAY_STALLED:
		return true;
	default:
		return false;
	}
}

/* ---- turn and margins ---- */

static bool display_is_plain(const struct display *display)
{
	const double *m = display->settings.margins;

	return display->settings.turn == PICTURE_UPRIGHT && m[0] + m[1] + m[2] + m[3] == 0;
}

static bool display_is_sideways(const struct display *display)
{
	return picture_turn_is_sideways((enum picture_turn)display->settings.turn);
}

/* The part of a driver's buffer within the margins. */
static struct display_buffer buffer_within(const struct display *display,
					   const struct display_buffer *whole)
{
	const double *m = display->settings.margins;
	struct display_buffer part = *whole;

	part.pixels += (size_t)m[1] * whole->stride + 4 * (size_t)m[0];
	part.width -= (int)m[0] + (int)m[2];
	part.height -= (int)m[1] + (int)m[3];
	return part;
}

static void blacken(const struct display_buffer *buffer, int x, int y, int width, int height)
{
	for (int row = y; row < y + height; row++)
		memset(buffer->pixels + (size_t)row * buffer->stride + 4 * (size_t)x, 0,
		       4 * (size_t)width);
}

static void blacken_margins(const struct display_buffer *whole, const double m[4])
{
	const int left = (int)m[0], top = (int)m[1], right = (int)m[2], bottom = (int)m[3];
	const int between = whole->height - top - bottom;

	blacken(whole, 0, 0, whole->width, top);
	blacken(whole, 0, top, left, between);
	blacken(whole, whole->width - right, top, right, between);
	blacken(whole, 0, whole->height - bottom, whole->width, bottom);
}

/* The driver's free size, so that the picture fits within the margins when it is turned. */
static void allow_for_turn(struct display *display)
{
	struct display_settings *s = &display->settings;
	const int width = s->picture_width, height = s->picture_height;

	if (width < 1 || height < 1)
		return;
	s->picture_width = (display_is_sideways(display) ? height : width) + (int)s->margins[0] +
			   (int)s->margins[2];
	s->picture_height = (display_is_sideways(display) ? width : height) + (int)s->margins[1] +
			    (int)s->margins[3];
}

static int check_margins(const struct display *display, struct fault *fault)
{
	const struct display_buffer whole = {.width = display->width, .height = display->height};
	const struct display_buffer part = buffer_within(display, &whole);

	if (part.width >= 1 && part.height >= 1)
		return 0;
	return fault_say(fault, -EINVAL, "the margins leave nothing of a screen of %dx%d",
			 display->width, display->height);
}

/* Makes of the driver's buffer the one that the program draws in. 0 or -ENOMEM. */
static int buffer_lay(struct display *display, struct display_buffer *buffer)
{
	const struct display_buffer part = buffer_within(display, buffer);
	const bool sideways = display_is_sideways(display);
	struct canvas *upright = &display->upright;
	int width = sideways ? part.height : part.width;
	int height = sideways ? part.width : part.height, err;

	blacken_margins(buffer, display->settings.margins);
	*buffer = part;
	if (display->settings.turn == PICTURE_UPRIGHT)
		return 0;
	err = canvas_fit(upright, width, height);
	if (err)
		return err;
	*buffer = (struct display_buffer){upright->pixels, upright->stride, width, height,
					  part.index};
	return 0;
}

static void turn_upright(const struct display *display)
{
	const struct display_buffer part = buffer_within(display, &display->whole);

	if (display->settings.turn != PICTURE_UPRIGHT)
		canvas_turn(&display->upright, (enum picture_turn)display->settings.turn,
			    part.pixels, part.stride);
}

/* ---- the wrappers ---- */

int display_open(struct display *display, const struct display_ops *ops,
		 const struct display_settings *settings, void *options, struct fault *fault)
{
	int err;

	*display = (struct display){0};
	if (!ops || !settings || (ops->options_size && !options))
		return fault_say(fault, -EINVAL, "a display is opened without driver or settings");
	display->ops = ops;
	display->settings = *settings;
	display->options = options;
	allow_for_turn(display);
	err = ops->open(display, fault);
	display->settings.turn = (settings->turn + display->mounted) % PICTURE_TURN_COUNT;
	if (!err)
		err = check_margins(display, fault);
	if (err) {
		name_situation(display, err);
		ops->close(display, NULL);
		*display = (struct display){.ops = ops, .situation = display->situation};
	}
	return err;
}

int display_descriptor(struct display *display)
{
	return display->state ? display->ops->descriptor(display) : -EBADF;
}

int display_fit(struct display *display, int width, int height, double squash)
{
	if (!display->state)
		return -EBADF;
	if (!display_is_plain(display))
		return -ENOTSUP;
	return display->ops->fit ? display->ops->fit(display, width, height, squash) : -ENOTSUP;
}

int display_power(struct display *display, bool on, struct fault *fault)
{
	int err;

	if (!display->state)
		return fault_say(fault, -EBADF, "a display that is not open");
	if (display->off == !on)
		return 0;
	if (!display->ops->power)
		return fault_say(fault, -ENOTSUP, "the %s display cannot be switched off",
				 display->ops->name);
	err = display->ops->power(display, on, fault);
	name_situation(display, err);
	if (err)
		return err;
	display->off = !on;
	display->acquired = false;
	return 0;
}

int display_acquire(struct display *display, struct display_buffer *buffer)
{
	int err;

	*buffer = (struct display_buffer){0};
	if (!display->state)
		return -EBADF;
	if (display->off)
		return -EAGAIN;
	err = display->ops->acquire(display, buffer);
	if (err)
		return err;
	display->whole = *buffer;
	err = display_is_plain(display) ? 0 : buffer_lay(display, buffer);
	if (err)
		return err;
	display->acquired = true;
	display->acquired_index = buffer->index;
	return 0;
}

int display_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		   struct fault *fault)
{
	int err;

	if (!display->state)
		return fault_say(fault, -EBADF, "a display that is not open");
	if (!buffer->pixels || !display->acquired || buffer->index != display->acquired_index)
		return fault_say(fault, -EINVAL, "a display buffer that was not acquired");
	turn_upright(display);
	err = display->ops->submit(display, &display->whole, token, fault);
	name_situation(display, err);
	display->acquired = false;
	*buffer = (struct display_buffer){0};
	return err;
}

int display_dispatch(struct display *display, struct display_event *event, struct fault *fault)
{
	int err;

	*event = (struct display_event){.kind = DISPLAY_NOTHING};
	if (!display->state)
		return fault_say(fault, -EBADF, "a display that is not open");
	err = display->ops->dispatch(display, event, fault);
	name_situation(display, err);
	if (!err && event->kind == DISPLAY_SHOWN)
		display->shown++;
	return err;
}

int display_close(struct display *display, struct fault *fault)
{
	int err = 0;

	if (display->ops && display->state)
		err = display->ops->close(display, fault);
	canvas_free(&display->upright);
	display->state = NULL;
	display->acquired = display->hidden = display->off = false;
	return err;
}

int display_free_size(const struct display *display, int *width, int *height, struct fault *fault)
{
	const struct display_settings *s = &display->settings;

	*width = s->width ? s->width : s->picture_width;
	*height = s->height ? s->height : s->picture_height;
	if (*width < 1 || *height < 1)
		return fault_say(fault, -EINVAL,
				 "the %s display is told neither its own size nor the picture's",
				 display->ops->name);
	return 0;
}
