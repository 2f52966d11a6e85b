#include "app/eye.h"

bool eye_has_picture(const struct eye *eye)
{
	return eye->source && source_has_picture(eye->source);
}

int eye_fit(struct eye *eye, struct fault *fault)
{
	struct fault reason = {.text = ""};
	int err;

	if (!eye_has_picture(eye))
		return 0;
	if (eye->camera_width == eye->source->canvas.width &&
	    eye->camera_height == eye->source->canvas.height)
		return 0;
	eye->camera_width = eye->source->canvas.width;
	eye->camera_height = eye->source->canvas.height;
	eye->view = eye->wanted;
	err = view_resolve(&eye->view, eye->camera_width, eye->camera_height, &reason);
	if (err) {
		eye->camera_width = 0;
		return fault_say(fault, err, "[%s] %s", eye->section, reason.text);
	}
	return 0;
}

struct picture eye_picture(const struct eye *eye)
{
	return view_picture(&eye->view, eye->source->canvas.pixels, eye->source->canvas.stride);
}
