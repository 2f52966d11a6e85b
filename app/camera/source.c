/* SPDX-License-Identifier: MIT */
#include "app/camera/source.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/colour/transfer.h"
#include "hal/frame/frame_decode.h"
#include "hal/frame/frame_reader.h"

#define SILENT_NS (2 * NS_PER_S)       /* without a frame: the camera is stalled */
#define SILENT_FRAMES 3		       /* the same for a slow camera, in frames */
#define SILENT_MOST_NS (60 * NS_PER_S) /* limit for SILENT_FRAMES, whatever rate the camera names */
#define GIVE_UP 3 /* times the silence after which it is closed and opened twice */

/* With fewer buffers a frame is converted at once and given back: drivers need one buffer to fill
 * and one to go on with. */
#define BUFFERS_TO_HOLD 3

int source_create(struct source *source, const struct source_settings *settings)
{
	int err;

	*source = (struct source){.settings = *settings};
	err = frame_decoder_create(&source->decoder, settings->deinterlace, settings->turn);
	if (err)
		return err;
	err = opener_create(&source->opening.opener);
	source->tables = malloc(sizeof(*source->tables));
	if (!err && !source->tables)
		err = -ENOMEM;
	if (err) {
		source_destroy(source);
		return err;
	}
	transfer_tables_fill(source->tables, &settings->curve);
	return 0;
}

/* Converts the picture first: its frame is readable only until the camera is closed. */
static void close_camera(struct source *source)
{
	source_make_whole(source);
	source_drop(source);
	camera_close(&source->camera);
	source->damaged_ns = 0;
	source->odd_width = source->odd_height = 0;
	source->counts.frames += source->camera.frames;
	source->counts.lost += source->camera.lost;
	source->counts.broken += source->camera.broken;
	source->camera.frames = source->camera.lost = source->camera.broken = 0;
}

void source_destroy(struct source *source)
{
	opener_destroy(source->opening.opener); /* now the camera belongs to the source */
	source->opening.begun = false;
	close_camera(source);
	frame_decoder_destroy(source->decoder);
	free(source->tables);
	canvas_free(&source->canvas);
	canvas_free(&source->spare);
	image_free(&source->linear);
	*source = (struct source){.decoder = NULL};
}

void source_complain(struct source *source, const struct fault *fault)
{
	if (source->opening.situation == source->opening.said)
		return;
	source->counts.losses += source->opening.said == CAMERA_FINE && source->fresh_ns;
	source->opening.said = source->opening.situation;
	source->opening.why = *fault;
	if (source->opening.said == CAMERA_FINE)
		log_info_paced("camera %s: fine again, %dx%d %s", source->settings.name,
			       source->camera.width, source->camera.height,
			       pixel_format_names[source->camera.format]);
	else
		log_warning_paced("camera %s: %s%s%s", source->settings.name,
				  camera_situation_names[source->opening.said],
				  *fault->text ? ": " : "", fault->text);
}

void source_open(struct source *source)
{
	if (source->opening.begun || source->opening.resting || source_is_open(source))
		return;
	source->opening.begun = true;
	opener_start(source->opening.opener, &source->camera, source->settings.ops,
		     &source->settings.camera, source->settings.options);
}

void source_rest(struct source *source, bool resting)
{
	source->opening.resting = resting;
	if (!resting)
		return;
	if (!source->opening.begun)
		close_camera(source);
	source->whole = source->is_linear = false;
	canvas_free(&source->canvas);
}

bool source_is_open(const struct source *source)
{
	return !source->opening.begun && source->camera.state != NULL;
}

void source_size(const struct source *source, int *width, int *height)
{
	const bool sideways = picture_turn_is_sideways(source->settings.turn);

	*width = sideways ? source->camera.height : source->camera.width;
	*height = sideways ? source->camera.width : source->camera.height;
}

const char *source_device_name(const struct source *source)
{
	return *source->opening.device_name ? source->opening.device_name : source->settings.name;
}

int source_descriptor(struct source *source)
{
	if (source->opening.begun)
		return opener_descriptor(source->opening.opener);
	if (!source_is_open(source) || (source->camera.on_demand && source_has_news(source)))
		return -1;
	return camera_descriptor(&source->camera);
}

void source_drop(struct source *source)
{
	if (source->held.format != PIXEL_NONE)
		camera_release(&source->camera, &source->held);
	source->shown = false;
}

/* A camera that was opened keeps its situation until a frame proves that it works. */
static int take_opening(struct source *source, int64_t now_ns, struct fault *fault)
{
	int err;

	if (!opener_take(source->opening.opener, &err, fault))
		return 0;
	source->opening.begun = false;
	source->opening.tried = true;
	source->heard_ns = now_ns;
	if (err)
		source->opening.situation = source->camera.situation;
	else
		snprintf(source->opening.device_name, sizeof(source->opening.device_name), "%s",
			 source->camera.name);
	source->opening.count += !err;
	if (source->opening.resting)
		source_rest(source, true);
	return err;
}

/* Whether rows can be read from the frame as it is. */
static bool is_readable(const struct frame *frame)
{
	return frame_is_raw(frame) && frame_check(frame, NULL) == 0;
}

static void convert_frame(struct source *source, const struct frame *frame)
{
	source->whole = frame_decode(source->decoder, frame, &source->canvas, NULL) == 0;
}

/*
 * Gives the held frame back, before it is known whether the next one is good: only one frame may be
 * out, and the descriptor says that there is another. Returns the frame if it was the only picture,
 * for the caller to convert should the next one fail; it is not converted here, because the next
 * frame most likely replaces it. A camera that makes frames on demand waits for others and may have
 * to show its last picture again, and a frozen one has to: there the picture is converted.
 */
static struct frame give_back(struct source *source)
{
	struct frame last = {.format = PIXEL_NONE};

	if (source_has_news(source))
		source->counts.superseded++;
	else if (source->camera.on_demand || source->kept)
		source_make_whole(source);
	if (!source->whole && source->canvas.width > 0) {
		last = source->held;
		if (source_has_news(source))
			source->picture_ns = source->held_ns;
	}
	source_drop(source);
	return last;
}

static void source_take_frame(struct source *source, int64_t now_ns)
{
	struct fault fault = {.text = ""};
	struct frame frame, last = give_back(source);
	bool changed, damaged;
	int err;

	err = camera_grab(&source->camera, &frame, &fault);
	/* The frame that was given back stays readable until the next grab, and no camera fills the
	 * buffer that it got back last while it has others. */
	if (last.format != PIXEL_NONE && (err || !is_readable(&frame)))
		convert_frame(source, &last);
	/* -EAGAIN does not mean that a camera which was lost works again, and a frame not that it
	 * decodes. */
	damaged = !err && source->opening.situation == CAMERA_DAMAGED;
	if (!damaged && (err != -EAGAIN || source->camera.situation != CAMERA_FINE))
		source->opening.situation = source->camera.situation;
	if (err)
		source_complain(source, &fault);
	changed = err == -ESTALE && source->camera.frames > 0;
	if (err && err != -EAGAIN)
		close_camera(source);
	if (changed) /* a camera that never gave a frame is opened twice with the next tick only */
		source_open(source);
	if (err)
		return;
	source->held = frame;
	/* Frames on demand carry the time of a simulated clock. */
	source->held_ns = source->camera.on_demand ? now_ns : frame.timestamp_ns;
	source->heard_ns = now_ns;
	source_complain(source, &fault);
}

int source_take(struct source *source, int64_t now_ns, struct fault *fault)
{
	if (!source->opening.begun) {
		source_take_frame(source, now_ns);
		return 0;
	}
	return take_opening(source, now_ns, fault);
}

static int64_t silence_of(const struct camera *camera)
{
	const double frames_s = camera->rate_hz > 0 ? SILENT_FRAMES / camera->rate_hz : 0;

	if (!(frames_s * NS_PER_S > SILENT_NS))
		return SILENT_NS;
	return frames_s * NS_PER_S < SILENT_MOST_NS ? (int64_t)(frames_s * NS_PER_S)
						    : SILENT_MOST_NS;
}

void source_watch(struct source *source, int64_t now_ns)
{
	const struct camera *camera = &source->camera;
	struct fault why = {.text = ""};
	int64_t silence_ns, most_ns;

	if (!source_is_open(source) || source_has_news(source))
		return;
	silence_ns = silence_of(camera);
	if (now_ns - source->heard_ns < silence_ns)
		return;
	most_ns = GIVE_UP * silence_ns;
	/* A key frame that opening has not brought would only be put off by opening again. */
	if (camera->keyless_ns && now_ns - camera->keyless_ns < silence_ns && camera->frames == 0) {
		most_ns = SILENT_MOST_NS;
		fault_say(&why, 0,
			  "it sends pictures, and the key frame that they need is waited for");
	}
	if (source->opening.situation == CAMERA_FINE)
		source->opening.situation = CAMERA_STALLED;
	source_complain(source, &why);
	if (now_ns - source->heard_ns >= most_ns)
		close_camera(source);
}

void source_excuse(struct source *source, int64_t now_ns)
{
	source->heard_ns = now_ns;
}

bool source_has_news(const struct source *source)
{
	return source->held.format != PIXEL_NONE && !source->shown;
}

bool source_has_picture(const struct source *source)
{
	return source->canvas.width > 0 && (source->whole || source->shown);
}

void source_make_whole(struct source *source)
{
	if (source->shown && !source->whole)
		convert_frame(source, &source->held);
}

int source_control(struct source *source, const char *name, const char *value, double *taken,
		   struct fault *fault)
{
	if (!source_is_open(source))
		return fault_say(fault, -EBADF, "a camera that is not open");
	return camera_set_control(&source->camera, name, value, taken, fault);
}

void source_encode_as(struct source *source, const struct transfer_curve *curve)
{
	if (transfer_curve_same(&source->settings.curve, curve))
		return;
	source->settings.curve = *curve;
	transfer_tables_fill(source->tables, curve);
}

static int fit_canvas(const struct source *source, struct canvas *canvas, struct fault *fault)
{
	const bool sideways = picture_turn_is_sideways(source->settings.turn);
	const int width = sideways ? source->held.height : source->held.width;
	const int height = sideways ? source->held.width : source->held.height;
	int err = canvas_fit(canvas, width, height);

	return err ? fault_say(fault, err, "not enough memory for a picture of %dx%d", width,
			       height)
		   : 0;
}

static void encode_linear(const struct source *source)
{
	const struct image *linear = &source->linear;
	const struct canvas *canvas = &source->canvas;

	for (int y = 0; y < linear->height; y++)
		encode_row(source->tables, linear->f32 + 3 * (size_t)y * (size_t)linear->width,
			   linear->width, canvas->pixels + (size_t)y * canvas->stride);
}

static int copy_linear(struct source *source, const struct frame *frame)
{
	const struct frame_plane *plane = &frame->planes[0];
	size_t row = (size_t)frame->width * 3 * sizeof(float);

	if (plane->stride < row || plane->bytes < plane->stride * (size_t)(frame->height - 1) + row)
		return -EINVAL;
	for (int y = 0; y < frame->height; y++)
		memcpy((char *)source->linear.f32 + (size_t)y * row,
		       plane->data + (size_t)y * plane->stride, row);
	return 0;
}

static int decode_raw(struct source *source, struct fault *fault)
{
	const struct frame *frame = &source->held;
	int err = frame_check(frame, fault);

	if (!err)
		err = fit_canvas(source, &source->canvas, fault);
	if (err)
		return err;
	source->shown = true;
	source->whole = false;
	if (source->settings.camera.buffers < BUFFERS_TO_HOLD)
		source_make_whole(source);
	return 0;
}

static int decode_linear(struct source *source, struct fault *fault)
{
	const struct frame *frame = &source->held;
	int err = fit_canvas(source, &source->canvas, fault);

	if (!err &&
	    (source->linear.width != frame->width || source->linear.height != frame->height)) {
		image_free(&source->linear);
		err = image_create_f32(&source->linear, frame->width, frame->height);
	}
	source->whole = true;
	if (!err)
		err = copy_linear(source, frame);
	if (err)
		return fault_say(fault, err, "a short frame, or not enough memory");
	encode_linear(source);
	return 0;
}

/* Some cameras send JPEG pictures of another size than they have agreed to. Such a size counts once
 * it has come twice in a row: a damaged header may tell any size. */
static int accept_size(struct source *source, struct fault *fault)
{
	struct frame *frame = &source->held;
	bool twice;
	int width, height, err;

	err = frame_decoder_size(source->decoder, frame, &width, &height, fault);
	if (err || (width == frame->width && height == frame->height))
		return err;
	twice = width == source->odd_width && height == source->odd_height;
	source->odd_width = width;
	source->odd_height = height;
	if (!twice)
		return fault_say(fault, -EBADMSG, "a JPEG picture of %dx%d, expected %dx%d", width,
				 height, frame->width, frame->height);
	if (source->canvas.width + source->canvas.height != width + height)
		log_warning_paced(
			"camera %s: it sends pictures of %dx%d in place of the %dx%d that it agreed to",
			source->settings.name, width, height, frame->width, frame->height);
	frame->width = width;
	frame->height = height;
	return 0;
}

/* Decodes into the spare canvas, which becomes the picture if the frame is whole. */
static int decode_whole(struct source *source, struct fault *fault)
{
	const struct canvas before = source->canvas;
	int err = accept_size(source, fault);

	if (!err)
		err = fit_canvas(source, &source->spare, fault);
	if (!err)
		err = frame_decode(source->decoder, &source->held, &source->spare, fault);
	if (err)
		return err;
	source->canvas = source->spare;
	source->spare = before;
	source->whole = true;
	return 0;
}

static int decode_held(struct source *source, struct fault *fault)
{
	const bool upright = source->settings.turn == PICTURE_UPRIGHT ||
			     source->held.format == PIXEL_Z16; /* eye_depth() turns it */

	source->is_linear = source->held.format == PIXEL_RGBF;
	if (frame_is_raw(&source->held) && upright)
		return decode_raw(source, fault);
	return source->is_linear ? decode_linear(source, fault) : decode_whole(source, fault);
}

/* Frames that do not decode are passed over; a camera that gives no others for as long as it may be
 * silent does not work. */
static void complain_of_damage(struct source *source, int64_t now_ns, const struct fault *fault)
{
	if (!source->counts.undecodable++)
		log_warning_paced("camera %s: a frame does not decode and is passed over: %s",
				  source->settings.name, fault->text);
	if (!source->damaged_ns)
		source->damaged_ns = now_ns;
	if (now_ns - source->damaged_ns < silence_of(&source->camera))
		return;
	source->opening.situation = CAMERA_DAMAGED;
	source_complain(source, fault);
}

bool source_decode(struct source *source, int64_t now_ns)
{
	static const struct fault nothing = {.text = ""};
	struct fault fault = {.text = ""};
	int err = decode_held(source, &fault);

	if (err) {
		complain_of_damage(source, now_ns, &fault);
	} else {
		source->damaged_ns = 0;
		if (source->opening.situation == CAMERA_DAMAGED)
			source->opening.situation = CAMERA_FINE;
		source_complain(source, &nothing);
		source->picture_ns = source->held_ns;
		source->stamp_ns = source->held.timestamp_ns;
		source->sequence = source->held.sequence;
		source->fresh_ns = now_ns;
	}
	if (err || source->whole)
		source_drop(source);
	return !err;
}

struct source_counts source_counts(const struct source *source)
{
	/* While the camera is being opened it belongs to the opener, and it has given no frames. */
	static const struct camera none;
	const struct camera *camera = source->opening.begun ? &none : &source->camera;

	return (struct source_counts){
		.frames = source->counts.frames + camera->frames,
		.lost = source->counts.lost + camera->lost + source->counts.superseded,
		.broken = source->counts.broken + camera->broken + source->counts.undecodable,
	};
}
