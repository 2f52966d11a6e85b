/* SPDX-License-Identifier: MIT */
/*
 * A simulated camera for demonstrations and tests. It shows a fisheye or perspective view of a room
 * with moving lamps (studio) or of an HDR panorama, or pictures from files. On demand it fails as
 * real cameras do.
 *
 * With clock=real, frames are ready when they are due, as those of a device. With clock=frames the
 * next frame is always ready, and its time stamp is one period later: each run gives the same
 * pictures, as fast as the program takes them.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/sim/sim.h"
#include "hal/base/clock.h"
#include "hal/base/number.h"

/* A change of exposure that was asked for. */
struct sim_change {
	uint64_t from; /* the first frame that shows it */
	double exposure;
};

struct sim {
	struct studio_view *studio;
	struct studio_layer *people; /* if there are walkers */
	struct panorama_view *panorama;
	struct player *player;
	struct sensor sensor;
	struct automatic automatic;
	float *linear;	 /* radiance of a studio or panorama frame; depths of one of Z16 */
	float *spread;	 /* two pictures of blurred light, if there is edge spread */
	uint8_t *bgrx;	 /* output of the sensor */
	uint8_t *output; /* the frame in a format that is converted from bgrx or linear */
	int descriptor;	 /* timerfd or eventfd; -1: the player has its own */
	int64_t start_ns, period_ns;
	uint64_t next; /* sequence number of the frame to come */
	uint64_t delivered;
	struct sim_change changes[SIM_DELAY_MAX + 1]; /* in order of time; at most one per frame */
	int change_count;
	double turn_rad; /* angle of the panorama in linear; NAN: not rendered yet */
	enum colour_matrix matrix;
	enum colour_range range;
};

static void sim_close(struct camera *camera)
{
	struct sim *sim = camera->state;

	camera->state = NULL;
	if (!sim)
		return;
	if (sim->descriptor >= 0)
		close(sim->descriptor);
	studio_view_destroy(sim->studio);
	free(sim->people);
	panorama_view_destroy(sim->panorama);
	player_close(sim->player);
	free(sim->linear);
	free(sim->spread);
	free(sim->bgrx);
	free(sim->output);
	free(sim);
}

static int sim_open_scene(struct camera *camera, struct sim *sim, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	struct sim_eye eye;
	int err = sim_eye(options, &camera->settings, &eye, fault);

	if (err)
		return err;
	camera->width = eye.width;
	camera->height = eye.height;
	sim->linear = calloc((size_t)eye.width * (size_t)eye.height, 3 * sizeof(float));
	if (!sim->linear)
		return fault_say(fault, -ENOMEM, "sim: no memory for a picture of %dx%d", eye.width,
				 eye.height);
	if (options->source == SIM_SOURCE_PANORAMA)
		return panorama_view_create(&sim->panorama, options->file, &eye, fault);
	err = studio_view_create(&sim->studio, &eye);
	if (!err && options->walkers > 0) {
		sim->people = calloc((size_t)eye.width * (size_t)eye.height, sizeof(*sim->people));
		err = sim->people ? 0 : -ENOMEM;
	}
	if (err)
		return fault_say(fault, err, "sim: no memory for the studio at %dx%d", eye.width,
				 eye.height);
	return 0;
}

static int sim_open_files(struct camera *camera, struct sim *sim, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	const struct player_settings settings = {
		.path = options->file,
		.loop = options->loop,
		.matrix = camera->settings.matrix,
		.range = camera->settings.range,
	};
	struct player_picture picture;
	int err = player_open(&sim->player, &settings, fault);

	if (err == -ETIMEDOUT)
		camera->situation = CAMERA_NO_SIGNAL;
	if (err == -ENOENT)
		camera->situation = CAMERA_NO_DEVICE;
	if (err)
		return err;
	picture = player_picture(sim->player);
	camera->width = picture.width;
	camera->height = picture.height;
	if (camera->rate_hz == 0)
		camera->rate_hz = picture.rate_hz;
	return 0;
}

static int choose_format(struct camera *camera, struct sim *sim, struct fault *fault)
{
	const struct camera_settings *settings = &camera->settings;

	camera->format = settings->format ? (enum pixel_format)settings->format : PIXEL_BGRX;
	if (camera->format != PIXEL_BGRX && camera->format != PIXEL_RGBF &&
	    camera->format != PIXEL_YUYV && camera->format != PIXEL_Z16) {
		camera->situation = CAMERA_UNSUPPORTED_FORMAT;
		return fault_say(fault, -EINVAL, "sim: format %s, expected BGRX, YUYV, RGBF or Z16",
				 pixel_format_names[camera->format]);
	}
	if (camera->format == PIXEL_Z16 &&
	    (!sim->studio || studio_view_eye(sim->studio)->fisheye)) {
		camera->situation = CAMERA_UNSUPPORTED_FORMAT;
		return fault_say(
			fault, -EINVAL,
			"sim: format Z16, expected sim.source = studio and sim.view = perspective, or another format");
	}
	if (camera->format == PIXEL_YUYV && camera->width % 2) {
		camera->situation = CAMERA_UNSUPPORTED_FORMAT;
		return fault_say(fault, -EINVAL, "sim: YUYV of width %d, expected an even width",
				 camera->width);
	}
	sim->matrix = settings->matrix ? (enum colour_matrix)(settings->matrix - 1) : MATRIX_BT601;
	sim->range = settings->range ? (enum colour_range)(settings->range - 1) : RANGE_LIMITED;
	return 0;
}

static int sim_allocate(const struct camera *camera, struct sim *sim, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	const size_t pixels = (size_t)camera->width * (size_t)camera->height;

	sim->bgrx = malloc(pixels * 4);
	sim->output = malloc(pixels * 3 * sizeof(float));
	if (options->edge_spread_px > 0)
		sim->spread = malloc(2 * pixels * 3 * sizeof(float));
	if (!sim->bgrx || !sim->output || (options->edge_spread_px > 0 && !sim->spread))
		return fault_say(fault, -ENOMEM, "sim: no memory for a picture of %dx%d",
				 camera->width, camera->height);
	return 0;
}

static int start_clock(const struct camera *camera, struct sim *sim, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	const int64_t first_ns = sim->start_ns;
	const struct itimerspec times = {
		.it_value = {first_ns / NS_PER_S, first_ns % NS_PER_S},
		.it_interval = {sim->period_ns / NS_PER_S, sim->period_ns % NS_PER_S},
	};

	if (sim->player && player_picture(sim->player).descriptor >= 0)
		return 0; /* the pipe's writer sets the pace */
	if (options->pace == SIM_CLOCK_FRAMES)
		sim->descriptor = eventfd(1, EFD_CLOEXEC | EFD_NONBLOCK);
	else
		sim->descriptor = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (sim->descriptor < 0 ||
	    (options->pace == SIM_CLOCK_REAL &&
	     timerfd_settime(sim->descriptor, TFD_TIMER_ABSTIME, &times, NULL)))
		return fault_say(fault, -errno, "sim: no timer: %s", strerror(errno));
	return 0;
}

static int sim_open(struct camera *camera, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	struct sim *sim;
	int err;

	if (options->source != SIM_SOURCE_STUDIO && !*options->file)
		return fault_say(fault, -EINVAL, "sim.file: is empty, expected the %s to be seen",
				 options->source == SIM_SOURCE_FILES ? "pictures" : "panorama");
	sim = calloc(1, sizeof(*sim));
	if (!sim)
		return fault_say(fault, -ENOMEM, "sim: no memory");
	sim->descriptor = -1;
	sim->turn_rad = NAN;
	camera->state = sim;
	camera->rate_hz = camera->settings.rate_hz;
	err = options->source == SIM_SOURCE_FILES ? sim_open_files(camera, sim, fault)
						  : sim_open_scene(camera, sim, fault);
	if (!err)
		err = choose_format(camera, sim, fault);
	if (!err)
		err = sim_allocate(camera, sim, fault);
	if (err)
		goto fail;
	sensor_prepare(&sim->sensor, &(struct sensor_settings){
					     .exposure = options->exposure,
					     .transfer = (enum transfer)options->transfer,
					     .black_level = options->black_level,
					     .read_noise = options->read_noise,
					     .shot_noise = options->shot_noise,
					     .seed = options->seed,
				     });
	sim->automatic.settings = options->automatic;
	if (camera->rate_hz <= 0)
		camera->rate_hz = 25;
	camera->on_demand = options->pace == SIM_CLOCK_FRAMES;
	sim->period_ns = llround((double)NS_PER_S / camera->rate_hz);
	sim->start_ns = clock_now_ns();
	err = start_clock(camera, sim, fault);
	if (err)
		goto fail;
	return 0;
fail:
	sim_close(camera);
	return err;
}

static int sim_descriptor(struct camera *camera)
{
	const struct sim *sim = camera->state;

	return sim->descriptor >= 0 ? sim->descriptor : player_picture(sim->player).descriptor;
}

/* Stalls: the descriptor can still be polled, but never becomes readable again. */
static void fall_silent(struct sim *sim)
{
	const struct itimerspec never = {{0, 0}, {0, 0}};
	uint64_t count;

	if (sim->descriptor < 0)
		return;
	/* The descriptor is a timer or an event: one of the calls applies, the other fails
	 * harmlessly. */
	(void)timerfd_settime(sim->descriptor, 0, &never, NULL);
	(void)!read(sim->descriptor, &count, sizeof(count));
}

/* Returns how many frames have become due since the last call; 0: none. */
static uint64_t take_ticks(const struct camera *camera, const struct sim *sim)
{
	const struct sim_options *options = camera->options;
	uint64_t ticks = 1;

	if (sim->descriptor >= 0 && options->pace == SIM_CLOCK_REAL &&
	    read(sim->descriptor, &ticks, sizeof(ticks)) != sizeof(ticks))
		return 0;
	return ticks;
}

/*
 * Returns the time in the scene. With clock=real it is the same for all cameras of all programs, so
 * that fisheye and background match. With clock=frames it counts from the first frame.
 */
static double scene_time_s(const struct camera *camera, const struct sim *sim, uint64_t sequence)
{
	const struct sim_options *options = camera->options;
	const double elapsed = (double)sequence * (double)sim->period_ns / (double)NS_PER_S;

	if (options->pace == SIM_CLOCK_FRAMES)
		return elapsed;
	return (double)sim->start_ns / (double)NS_PER_S + elapsed;
}

static void render_walkers(const struct sim_options *options, struct sim *sim,
			   const struct studio_lamps *lamps, double time_s)
{
	struct walker walkers[WALKER_STYLES];
	const int count = walkers_at(time_s, options->walkers, walkers);

	studio_people_shade(sim->studio, lamps, walkers, count, sim->linear);
	studio_people_draw(sim->studio, lamps, walkers, count, sim->people);
	studio_people_over(sim->studio, sim->people, sim->linear);
}

static void render_depths(const struct sim_options *options, struct sim *sim, double time_s)
{
	const struct studio_lamps lamps = studio_lamps(time_s, options->switch_s);
	struct walker walkers[WALKER_STYLES];

	studio_view_depth(sim->studio, &lamps, sim->linear);
	if (options->walkers == 0)
		return;
	studio_people_draw(sim->studio, &lamps, walkers,
			   walkers_at(time_s, options->walkers, walkers), sim->people);
	studio_people_depth(sim->studio, sim->people, sim->linear);
}

static void render_scene(const struct camera *camera, struct sim *sim, uint64_t sequence)
{
	const struct sim_options *options = camera->options;
	const double time_s = scene_time_s(camera, sim, sequence);
	double turn_rad;

	if (camera->format == PIXEL_Z16) {
		render_depths(options, sim, time_s);
		return;
	}
	if (sim->studio) {
		struct studio_lamps lamps = studio_lamps(time_s, options->switch_s);

		lamps.mains = options->mains;
		studio_view_render(sim->studio, &lamps, sim->linear);
		if (options->walkers > 0)
			render_walkers(options, sim, &lamps, time_s);
		return;
	}
	turn_rad = fmod(options->turn_rate_deg * time_s, 360) * M_PI / 180;
	if (turn_rad == sim->turn_rad)
		return; /* the panorama stands still: linear holds this frame already */
	panorama_view_render(sim->panorama, turn_rad, sim->linear);
	sim->turn_rad = turn_rad;
}

static void fill_plane(struct frame *frame, const void *data)
{
	const size_t stride = frame_plane_stride(frame->format, 0, frame->width);

	frame->planes[0] = (struct frame_plane){
		.data = data,
		.stride = stride,
		.bytes = frame_plane_bytes(frame->format, 0, stride, frame->height),
	};
}

static void output_linear(const struct camera *camera, struct sim *sim, const float *linear,
			  struct frame *frame)
{
	const size_t values = (size_t)camera->width * (size_t)camera->height * 3;
	const float exposure = (float)sim->sensor.settings.exposure;
	float *to = (float *)(void *)sim->output;

	for (size_t i = 0; i < values; i++)
		to[i] = exposure * sim->sensor.gain[i % 3] * linear[i];
	fill_plane(frame, to);
}

/* Converts 8-bit files to linear light. */
static void output_decoded(const struct camera *camera, struct sim *sim, const uint8_t *bgrx,
			   struct frame *frame)
{
	const size_t pixels = (size_t)camera->width * (size_t)camera->height;
	float *to = (float *)(void *)sim->output;
	float decode[256];

	for (int i = 0; i < 256; i++)
		decode[i] = (float)transfer_decode(sim->sensor.settings.transfer, i / 255.0);
	for (size_t i = 0; i < pixels; i++)
		for (size_t c = 0; c < 3; c++)
			to[3 * i + c] = decode[bgrx[4 * i + 2 - c]];
	fill_plane(frame, to);
}

static void output_codes(const struct camera *camera, struct sim *sim, const uint8_t *bgrx,
			 struct frame *frame)
{
	if (camera->format == PIXEL_BGRX) {
		fill_plane(frame, bgrx);
		return;
	}
	sensor_pack_yuyv(bgrx, (size_t)camera->width * (size_t)camera->height, sim->matrix,
			 sim->range, sim->output);
	fill_plane(frame, sim->output);
}

/* What the lens and the camera's automatics make of linear light. */
static const float *sim_through_lens(const struct camera *camera, struct sim *sim,
				     const float *linear)
{
	const struct sim_options *options = camera->options;
	const size_t pixels = (size_t)camera->width * (size_t)camera->height;

	if (sim->spread) {
		spread_edges(linear, camera->width, camera->height, options->edge_spread_px,
			     sim->spread + 3 * pixels, sim->spread);
		linear = sim->spread;
	}
	if (options->automatic.level > 0 || options->automatic.white)
		automatic_gain(&sim->automatic, linear, pixels, sim->sensor.settings.exposure,
			       (double)sim->period_ns / (double)NS_PER_S, sim->sensor.gain);
	return linear;
}

static void output_depths(const struct camera *camera, struct sim *sim, uint64_t sequence,
			  struct frame *frame)
{
	const struct sim_options *options = camera->options;
	const struct sensor_depth sensor = {options->depth_noise_mm, options->seed};

	sensor_measure(&sensor, sequence, sim->linear, camera->width, camera->height, sim->output);
	fill_plane(frame, sim->output);
}

static void output_frame(const struct camera *camera, struct sim *sim, uint64_t sequence,
			 struct frame *frame)
{
	const float *linear = sim->linear;
	const uint8_t *bgrx = NULL;

	if (camera->format == PIXEL_Z16) {
		output_depths(camera, sim, sequence, frame);
		return;
	}
	if (sim->player) {
		linear = player_picture(sim->player).linear;
		bgrx = player_picture(sim->player).bgrx;
	}
	if (linear)
		linear = sim_through_lens(camera, sim, linear);
	if (camera->format == PIXEL_RGBF) {
		if (linear)
			output_linear(camera, sim, linear, frame);
		else
			output_decoded(camera, sim, bgrx, frame);
		return;
	}
	if (linear) {
		sensor_expose(&sim->sensor, sequence, linear,
			      (size_t)camera->width * (size_t)camera->height, sim->bgrx);
		bgrx = sim->bgrx;
	}
	output_codes(camera, sim, bgrx, frame);
}

static int sim_play(struct camera *camera, struct sim *sim, uint64_t steps, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	int err = player_next(sim->player, steps, fault);

	if (err == -ENODATA) {
		camera->situation = CAMERA_NO_SIGNAL;
		return fault_say(fault, -ENODEV, "%s: has ended", options->file);
	}
	return err;
}

static int64_t timestamp_ns(const struct camera *camera, const struct sim *sim, uint64_t sequence)
{
	const struct sim_options *options = camera->options;

	if (sim->descriptor < 0 && options->pace == SIM_CLOCK_REAL)
		return clock_now_ns(); /* a picture from a pipe: the time of arrival */
	return sim->start_ns + (int64_t)sequence * sim->period_ns;
}

static bool frames_reached(int limit, uint64_t count)
{
	return limit > 0 && count >= (uint64_t)limit;
}

/* Applies the changes of exposure that are due. */
static void apply_changes(struct sim *sim, uint64_t sequence)
{
	struct sensor_settings settings = sim->sensor.settings;
	int due = 0;

	while (due < sim->change_count && sim->changes[due].from <= sequence)
		settings.exposure = sim->changes[due++].exposure;
	if (due == 0)
		return;
	sensor_prepare(&sim->sensor, &settings);
	sim->change_count -= due;
	memmove(sim->changes, sim->changes + due,
		(size_t)sim->change_count * sizeof(*sim->changes));
}

/* The first frames after it was opened: zeros in the camera's own format, as in a buffer that
 * nobody has filled (green in YUV), then an exposure that falls from the fourfold to the right
 * one. */
static void output_warming(const struct camera *camera, struct sim *sim, uint64_t sequence,
			   struct frame *frame)
{
	const struct sim_options *options = camera->options;
	const double done = 2.0 * (double)sim->delivered / options->warm_up - 1;

	sim->sensor.settings.exposure = options->exposure * (4 - 3 * done);
	output_frame(camera, sim, sequence, frame);
	sim->sensor.settings.exposure = options->exposure;
	if (done >= 0)
		return;
	memset(sim->output, 0, frame->planes[0].bytes);
	fill_plane(frame, sim->output);
}

/* Produces one frame; a damaged one keeps the format PIXEL_NONE. */
static int sim_take_frame(struct camera *camera, struct sim *sim, struct frame *frame,
			  struct fault *fault)
{
	const struct sim_options *options = camera->options;
	const uint64_t ticks = take_ticks(camera, sim);
	uint64_t sequence;
	int err;

	if (ticks == 0)
		return -EAGAIN;
	err = sim->player ? sim_play(camera, sim, ticks, fault) : 0;
	if (err)
		return err;
	sequence = sim->next + ticks - 1;
	sim->next = sequence + 1;
	camera->lost += ticks - 1;
	if (options->corrupt_every && sim->next % (uint64_t)options->corrupt_every == 0) {
		camera->broken++;
		return 0;
	}
	apply_changes(sim, sequence);
	if (!sim->player)
		render_scene(camera, sim, sequence);
	*frame = (struct frame){
		.format = camera->format,
		.width = camera->width,
		.height = camera->height,
		.matrix = sim->matrix,
		.range = camera->format == PIXEL_YUYV ? sim->range : RANGE_FULL,
		.timestamp_ns = timestamp_ns(camera, sim, sequence),
		.sequence = (uint32_t)sequence,
	};
	if (sim->delivered < (uint64_t)options->warm_up)
		output_warming(camera, sim, sequence, frame);
	else
		output_frame(camera, sim, sequence, frame);
	return 0;
}

static int sim_grab(struct camera *camera, struct frame *frame, struct fault *fault)
{
	const struct sim_options *options = camera->options;
	struct sim *sim = camera->state;
	int err;

	if (frames_reached(options->vanish_after, sim->delivered)) {
		camera->situation = CAMERA_NO_DEVICE;
		return fault_say(fault, -ENODEV, "sim: the camera vanished, as it was told to");
	}
	if (frames_reached(options->stall_after, sim->delivered)) {
		fall_silent(sim);
		return -EAGAIN;
	}
	do
		err = sim_take_frame(camera, sim, frame, fault);
	while (err == 0 && frame->format == PIXEL_NONE);
	if (err == 0)
		sim->delivered++;
	return err;
}

/* Whether the sensor is simulated: 8-bit files are passed on as they are. */
static bool has_exposure(const struct sim *sim)
{
	return !sim->player || player_picture(sim->player).linear;
}

/* Returns the number of the first frame that is not captured yet. A real camera, too, applies a
 * control only to frames that are still to come. */
static uint64_t to_come(const struct camera *camera, const struct sim *sim)
{
	const struct sim_options *options = camera->options;
	const int64_t since_ns = clock_now_ns() - sim->start_ns;
	uint64_t captured;

	if (options->pace == SIM_CLOCK_FRAMES || sim->descriptor < 0)
		return sim->next;
	captured = (uint64_t)(since_ns / sim->period_ns) + 1;
	return captured > sim->next ? captured : sim->next;
}

static int sim_control(struct camera *camera, const char *name, const char *value, double *taken,
		       struct fault *fault)
{
	const struct sim_options *options = camera->options;
	struct sim *sim = camera->state;
	const uint64_t from = to_come(camera, sim) + (uint64_t)options->control_delay;
	double exposure;

	(void)taken; /* no number is rounded */
	if (!has_exposure(sim))
		return fault_say(fault, -ENOTSUP, "sim: %s: 8-bit pictures have no exposure",
				 options->file);
	if (strcmp(name, "exposure") != 0)
		return fault_say(fault, -EINVAL,
				 "sim: the camera has no control \"%s\", expected exposure", name);
	if (number_of(value, &exposure) < 0)
		return fault_say(fault, -EINVAL, "sim: exposure is \"%s\", expected a number",
				 value);
	if (exposure < 0 || exposure > SIM_EXPOSURE_MAX)
		return fault_say(fault, -ERANGE, "sim: exposure is %s, expected 0 to %g", value,
				 SIM_EXPOSURE_MAX);
	/* If two changes concern one frame, the later one counts. */
	if (sim->change_count == 0 || sim->changes[sim->change_count - 1].from < from)
		sim->change_count++;
	sim->changes[sim->change_count - 1] = (struct sim_change){from, exposure};
	return 0;
}

static void sim_release(struct camera *camera, struct frame *frame)
{
	(void)camera;
	(void)frame;
}

const struct camera_ops camera_sim = {
	.name = "sim",
	.description = "simulated: a studio, a panorama or pictures from files",
	.keys = sim_keys,
	.options_size = sizeof(struct sim_options),
	.open = sim_open,
	.descriptor = sim_descriptor,
	.grab = sim_grab,
	.release = sim_release,
	.close = sim_close,
	.control = sim_control,
};
