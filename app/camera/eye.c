/* SPDX-License-Identifier: MIT */
#include "app/camera/eye.h"

void eyes_list(const struct eyes *eyes, const struct eye *list[EYES])
{
	list[0] = &eyes->fisheye;
	list[1] = &eyes->background;
	list[2] = &eyes->scene;
	list[3] = &eyes->depth;
}

struct source *eyes_leader(const struct eyes *eyes)
{
	struct source *candidates[] = {eyes->background.source, eyes->fisheye.source,
				       eyes->scene.source};
	struct source *silent = NULL;

	for (int i = 2; i >= 0; i--) {
		if (candidates[i] && source_is_open(candidates[i]))
			silent = candidates[i];
	}
	for (int i = 0; i < 3; i++) {
		if (candidates[i] && source_is_open(candidates[i]) &&
		    candidates[i]->opening.situation == CAMERA_FINE)
			return candidates[i];
	}
	return silent;
}

bool eye_has_picture(const struct eye *eye)
{
	return eye->source && source_has_picture(eye->source) && !eye->unfit;
}

int eye_fit(struct eye *eye, struct fault *fault)
{
	struct fault reason = {.text = ""};
	int err;

	if (!eye->source || !source_has_picture(eye->source))
		return 0;
	if (!eye->unfit && eye->camera_width == eye->source->canvas.width &&
	    eye->camera_height == eye->source->canvas.height)
		return 0;
	eye->camera_width = eye->source->canvas.width;
	eye->camera_height = eye->source->canvas.height;
	eye->view = eye->wanted;
	err = view_resolve(&eye->view, eye->camera_width, eye->camera_height, &reason);
	eye->unfit = err != 0;
	return err ? fault_say(fault, err, "[%s] %s", eye->section, reason.text) : 0;
}

bool eye_read(const struct eye *eye, struct frame_reader *reader)
{
	const struct source *source = eye->source;

	/* A frame that is to be turned is the picture only where it holds depths. */
	return source->shown && !source->whole && source->settings.turn == PICTURE_UPRIGHT &&
	       frame_reader_open(reader, &source->held, &eye->view, NULL) == 0;
}

struct picture eye_picture(const struct eye *eye)
{
	source_make_whole(eye->source);
	return view_picture(&eye->view, eye->source->canvas.pixels, eye->source->canvas.stride);
}

struct frame_reader eye_reader(const struct eye *eye)
{
	struct frame_reader reader;
	struct picture picture;

	if (eye_read(eye, &reader))
		return reader;
	picture = eye_picture(eye);
	return frame_reader_of(&picture);
}

bool eye_depth(const struct eye *eye, double unit_m, struct depth_map *map)
{
	const struct source *source = eye->source;

	return source && source->shown && eye_has_picture(eye) &&
	       depth_map_of(map, &source->held, source->settings.turn, &eye->view, unit_m, NULL) ==
		       0;
}

bool eye_has_settled(const struct eye *eye, bool metering)
{
	struct source *source = eye->source;
	struct frame_reader reader;
	struct settling_look look;

	if (source->camera.on_demand ||
	    (source->settling.settled && source->settling.opening == source->opening.count))
		return true;
	reader = eye_reader(eye);
	look = settling_look_at(&reader);
	return settling_take(&source->settling, source->opening.count, &look, metering,
			     source->picture_ns);
}
