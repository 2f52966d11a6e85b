#include "hal/display.h"

#include <errno.h>

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
	err = ops->open(display, fault);
	if (err) {
		ops->close(display, NULL);
		*display = (struct display){0};
	}
	return err;
}

int display_descriptor(struct display *display)
{
	return display->state ? display->ops->descriptor(display) : -EBADF;
}

int display_acquire(struct display *display, struct display_buffer *buffer)
{
	int err;

	*buffer = (struct display_buffer){0};
	if (!display->state)
		return -EBADF;
	err = display->ops->acquire(display, buffer);
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
	err = display->ops->submit(display, buffer, token, fault);
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
	if (!err && event->kind == DISPLAY_SHOWN)
		display->shown++;
	return err;
}

int display_close(struct display *display, struct fault *fault)
{
	int err = 0;

	if (display->ops && display->state)
		err = display->ops->close(display, fault);
	display->state = NULL;
	display->acquired = false;
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
