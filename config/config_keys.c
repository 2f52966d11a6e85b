/* SPDX-License-Identifier: MIT */
/* Tables of every key except those of drivers: name, type, range, default, help. */
#include "config/config_parts.h"

#include <stdio.h>
#include <string.h>

#include "config/config_hours.h"
#include "hal/basis/basis_format.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/compositor.h"
#include "hal/lights/exposure_schedule.h"
#include "hal/lights/light_filter.h"
#include "hal/lights/sampler.h"

const char *const config_show_names[] = {"composite", "before", "fisheye", "scene", "quad",
					 "split",     "off",	"guide",   NULL};
const char *const config_timeline_names[] = {"none", "loop", "swing", NULL};
const char *const config_scale_names[] = {"none", "fit", NULL};
const char *const config_hours_off_names[] = {"signal", "black", NULL};

_Static_assert(sizeof(config_show_names) / sizeof(*config_show_names) == SHOW_COUNT + 1,
	       "a name for each view");
_Static_assert(sizeof(config_timeline_names) / sizeof(*config_timeline_names) == TIMELINE_COUNT + 1,
	       "a name for each timeline");
_Static_assert(sizeof(config_scale_names) / sizeof(*config_scale_names) == SCALE_COUNT + 1,
	       "a name for each scale");
_Static_assert(sizeof(config_hours_off_names) / sizeof(*config_hours_off_names) ==
		       HOURS_OFF_COUNT + 1,
	       "a name for each end of the hours");

/* At 1 km a scene of 1 m sees a lamp from the same direction to a pixel: what is farther need
 * not be named. */
#define PLACE_MAX 1000
/* Nothing of a room is larger; of metres and centimetres it tells one that was mistaken. */
#define LAMP_RADIUS_MAX 50

/* Indexed by the value of the enum plus 1; 0 leaves it to the driver. */
static const char *const matrix_names[] = {"driver", "bt601", "bt709", NULL};
static const char *const range_names[] = {"driver", "limited", "full", NULL};

_Static_assert(sizeof(matrix_names) / sizeof(*matrix_names) == MATRIX_COUNT + 2,
	       "a name for each matrix");
_Static_assert(sizeof(range_names) / sizeof(*range_names) == RANGE_COUNT + 2,
	       "a name for each range");

#define AT(section, field) offsetof(struct config_##section, field)

static const struct ini_key basis_keys[] = {
	{"file", INI_PATH, AT(basis, file), .fallback = "",
	 .help = "The basis file that inlay-bake made. Put another in its place with install or mv, never with cp over the file of a running kiosk; it counts from the next reload (SIGHUP)."},
	{"pose", INI_INT, AT(basis, pose), .max = 65535, .fallback = "0",
	 .help = "Which of the file's poses is shown first."},
	INI_KEYS_END};

static const struct ini_key poses_keys[] = {
	{"timeline", INI_CHOICE, AT(poses, timeline), .choices = config_timeline_names,
	 .fallback = "none",
	 .help = "Whether poses follow each other by themselves: from the last to the first, or back and forth."},
	{"rate", INI_REAL, AT(poses, rate), .min = 0.001, .max = 1000, .fallback = "12",
	 .unit = "poses a second", .help = "How fast, by the time at which frames are captured."},
	{"fade", INI_BOOL, AT(poses, fade), .fallback = "no",
	 .help = "Mix neighbours on the way from one to the next; a frame then takes twice as long."},
	INI_KEYS_END};

static const struct ini_key camera_keys[] = {
	{"driver", INI_TEXT, AT(camera, driver), .fallback = "v4l2",
	 .help = "Which driver: inlay devices lists them."},
	{"device", INI_TEXT, AT(camera, settings.device), .fallback = "",
	 .help = "Which device, in the driver's own words; empty: the first found."},
	{"width", INI_INT, AT(camera, settings.width), .max = BASIS_SIDE_MAX, .fallback = "0",
	 .unit = "px", .help = "Wanted width; 0: the driver's choice."},
	{"height", INI_INT, AT(camera, settings.height), .max = BASIS_SIDE_MAX, .fallback = "0",
	 .unit = "px", .help = "Wanted height; 0: the driver's choice."},
	{"rate", INI_REAL, AT(camera, settings.rate_hz), .max = 1000, .fallback = "0", .unit = "Hz",
	 .help = "Wanted frames a second; 0: the driver's choice."},
	{"format", INI_CHOICE, AT(camera, settings.format), .choices = pixel_format_names,
	 .fallback = "none",
	 .help = "Wanted pixel format; none: the cheapest to convert. Y10, Y12, Y14 also read Y16 whose upper bits are empty."},
	{"buffers", INI_INT, AT(camera, settings.buffers), .min = 2, .max = 8, .fallback = "4",
	 .help = "Buffers that the driver cycles through."},
	{"matrix", INI_CHOICE, AT(camera, settings.matrix), .choices = matrix_names,
	 .fallback = "driver", .help = "Y'CbCr matrix; driver: as the driver says."},
	{"range", INI_CHOICE, AT(camera, settings.range), .choices = range_names,
	 .fallback = "driver", .help = "Y'CbCr range; driver: as the driver says."},
	{"deinterlace", INI_CHOICE, AT(camera, deinterlace), .choices = deinterlace_names,
	 .fallback = "weave",
	 .help = "Interlaced video: both fields line by line, the later one interpolated, or both averaged."},
	{"rotate", INI_CHOICE, AT(camera, turn), .choices = picture_turn_names, .fallback = "0",
	 .unit = "deg",
	 .help = "How far its picture is turned clockwise to be upright, for a camera that hangs on its side; views and calibration see it turned."},
	{"controls", INI_TEXT, AT(camera, settings.controls), .fallback = "",
	 .help = "Set at every opening, \"name=value, name=value\", as inlay devices lists them."},
	{"give_up", INI_TEXT, AT(camera, settings.give_up), .fallback = "format rate",
	 .help = "What may go, in this order, when the bus has no room: words of format, size, rate."},
	INI_KEYS_END};

/* The four views differ only in the default of their camera. */
#define VIEW_CAMERA_KEY(camera_default, text)                                                      \
	{                                                                                          \
		.name = "camera", .type = INI_TEXT, .offset = AT(view, camera),                    \
		.fallback = (camera_default), .help = (text)                                       \
	}

static const struct ini_key fisheye_camera_keys[] = {
	VIEW_CAMERA_KEY("fisheye", "The [camera NAME] that looks at the sky."), INI_KEYS_END};

static const struct ini_key background_camera_keys[] = {
	VIEW_CAMERA_KEY("background", "The [camera NAME] whose picture the object stands in."),
	INI_KEYS_END};

static const struct ini_key scene_camera_keys[] = {
	VIEW_CAMERA_KEY("", "A [camera NAME] that looks on, for show = quad; empty: none."),
	INI_KEYS_END};

static const struct ini_key depth_camera_keys[] = {
	VIEW_CAMERA_KEY(
		"",
		"A [camera NAME] that measures depths (Z16) of what the background shows, so that [people] need not tell by their feet; empty: none."),
	INI_KEYS_END};

static const struct ini_key view_keys[] = {
	{"x", INI_INT, AT(view, view.x), .max = BASIS_SIDE_MAX, .fallback = "0", .unit = "px",
	 .help = "Left edge of the view in the camera's picture."},
	{"y", INI_INT, AT(view, view.y), .max = BASIS_SIDE_MAX, .fallback = "0", .unit = "px",
	 .help = "Upper edge of the view in the camera's picture."},
	{"width", INI_INT, AT(view, view.width), .max = BASIS_SIDE_MAX, .fallback = "0",
	 .unit = "px", .help = "Width of the view; 0: to the camera's right edge."},
	{"height", INI_INT, AT(view, view.height), .max = BASIS_SIDE_MAX, .fallback = "0",
	 .unit = "px", .help = "Height of the view; 0: to the camera's lower edge."},
	{"hflip", INI_BOOL, AT(view, view.hflip), .fallback = "no",
	 .help = "Left and right are swapped in the camera's picture."},
	{"vflip", INI_BOOL, AT(view, view.vflip), .fallback = "no",
	 .help = "The camera's picture is upside down, but not mirrored."},
	{"squash", INI_REAL, AT(view, view.squash), .min = 0.1, .max = 10, .fallback = "1",
	 .help = "Height of a pixel over its width; 2 where every other line was lost. Stretches what is shown."},
	INI_KEYS_END};

static const struct ini_key depth_keys[] = {
	{"unit", INI_REAL, AT(depth, unit_mm), .min = 0.001, .max = 1000, .fallback = "1",
	 .unit = "mm", .help = "What 1 in the camera's depths stands for."},
	{"calibration", INI_PATH, AT(depth, calibration), .fallback = "",
	 .help = "A file with a [camera] section, as inlay-calibrate camera writes it, of the depth camera in the same world as the background's. Empty: its view shows what the background shows, as if from the same place."},
	INI_KEYS_END};

static const struct ini_key fisheye_place_keys[] = {
	{"position", INI_REALS, offsetof(struct lamps, fisheye), 3, .min = -PLACE_MAX,
	 .max = PLACE_MAX, .fallback = "0 0 0", .unit = "m",
	 .help = "Where the lens stands in the world, whose origin and axes are those of the basis: how near each [lamp NAME] is to it."},
	INI_KEYS_END};

static const struct ini_key lamp_keys[] = {
	{"position", INI_REALS, offsetof(struct lamp, position), 3, .min = -PLACE_MAX,
	 .max = PLACE_MAX, .unit = "m", .help = "Its middle, in the world."},
	{"radius", INI_REAL, offsetof(struct lamp, radius), .min = 0.001, .max = LAMP_RADIUS_MAX,
	 .unit = "m",
	 .help = "Of a ball that looks as large; of a shade or a panel, half of what lies between its edges."},
	INI_KEYS_END};

static const struct ini_key fisheye_lens_keys[] = {
	{"lens", INI_PATH, AT(fisheye, lens_file), .fallback = "",
	 .help = "A file with a [fisheye] section, as inlay-calibrate fisheye writes it. Its keys replace the seven that follow here; empty: none."},
	INI_KEYS_END};

static const struct ini_key fisheye_light_keys[] = {
	{"transfer", INI_CHOICE, AT(fisheye, transfer), .choices = transfer_names,
	 .fallback = "srgb", .help = "Transfer function of the camera's 8-bit code values."},
	{"black_level", INI_INT, AT(fisheye, black_level), .max = 254, .fallback = "0",
	 .help = "Code value that is no light."},
	{"gain", INI_REAL, AT(fisheye, gain), .max = 1e6, .fallback = "1",
	 .help = "Linear light is multiplied by it: this camera's units to the background's."},
	{"light", INI_PATH, AT(fisheye, light), .fallback = "",
	 .help = "What inlay-calibrate light measured; what it says goes before transfer, black_level and gain."},
	{"exposures", INI_LIST, AT(fisheye, exposures), EXPOSURES_MAX, .min = 1e-6, .max = 1e9,
	 .fallback = "",
	 .help = "2 to 5 values of exposure_control, descending, that the camera takes in turn; light is proportional to them, and the other keys are those of the first. Empty: it keeps one."},
	{"exposure_control", INI_TEXT, AT(fisheye, exposure_control),
	 .fallback = "exposure_time_absolute",
	 .help = "The camera's control that sets the exposure, as inlay devices lists it; its automatics are off by [camera NAME] controls."},
	{"exposure_delay", INI_INT, AT(fisheye, exposure_delay), .min = -1,
	 .max = EXPOSURE_DELAY_MAX, .fallback = "-1", .unit = "frames",
	 .help = "How many frames still show the exposure before; -1: as light says, or else measured whenever the camera is opened."},
	INI_KEYS_END};

static const struct ini_key background_keys[] = {
	{"transfer", INI_CHOICE, AT(background, transfer), .choices = transfer_names,
	 .fallback = "srgb",
	 .help = "Transfer function of the camera's 8-bit code values; the picture on the screen keeps it."},
	{"light", INI_PATH, AT(background, light), .fallback = "",
	 .help = "What inlay-calibrate light measured: its black_level counts, and its response goes before transfer."},
	{"ground_patch", INI_REALS, AT(background, patch), 4, .max = BASIS_SIDE_MAX,
	 .fallback = "0 0 0 0", .unit = "px",
	 .help = "x, y, width and height of a patch of open ground in the view: what the sky's clipped parts must be, so that it is as bright as it is. Width 0: none."},
	{"ground_reflectance", INI_REALS, AT(background, reflectance), 3, .max = 1,
	 .fallback = "0 0 0",
	 .help = "The reflectance of that patch, R G B in linear light, as it was given for the gain; 0 0 0: that of the ground that was baked."},
	INI_KEYS_END};

static const struct ini_key lights_keys[] = {
	{"threshold", INI_LEVEL, AT(lights, threshold), .max = 255, .fallback = "0",
	 .unit = "grey levels",
	 .help = "A light none of whose channels reaches this 8-bit level of the fisheye's picture is left out; 0 uses all. A percentage: the most lights that together change no pixel by more of white."},
	{"threshold_step", INI_REAL, AT(lights, threshold_step), .min = 0.1, .max = 255,
	 .fallback = "8", .unit = "grey levels, or percent",
	 .help = "What one press of a button changes, in the unit of the threshold."},
	{"threshold_mode", INI_CHOICE, AT(lights, threshold_mode), .choices = threshold_mode_names,
	 .fallback = "ambient",
	 .help = "What becomes of the light left out: ambient returns it from all directions alike, drop loses it."},
	{"follow", INI_REAL, AT(lights, follow_s), .max = LIGHT_FILTER_FOLLOW_MAX,
	 .fallback = "0.1", .unit = "s",
	 .help = "The time within which 90 % of a change of the light are shown; changes as small as the camera's noise are averaged for longer. 0: each frame's light as it is."},
	INI_KEYS_END};

static const struct ini_key composite_keys[] = {
	{"gain", INI_REAL, AT(composite, gain), .max = COMPOSITOR_GAIN_MAX, .fallback = "1",
	 .help = "The object's light is multiplied by it."},
	{"threads", INI_INT, AT(composite, threads), .max = 256, .fallback = "0",
	 .help = "Threads that composite; 0: one for each processor."},
	{"mode", INI_CHOICE, AT(composite, mode), .choices = compositor_mode_names,
	 .fallback = "fast",
	 .help = "fast: within the errors that the basis declares; exact: every light's own picture, where the basis holds them, with all of the file in memory."},
	{"follow_exposure", INI_BOOL, AT(composite, follow_exposure), .fallback = "no",
	 .help = "yes: the object becomes brighter, darker or warmer as the background camera's automatic exposure and white balance make the place. A change that the fisheye sees as well is light, and is not followed. Lamps that flicker in the picture's rows flicker on the object, too."},
	{"neutral", INI_REAL, AT(composite, neutral_percent), .max = 100, .fallback = "0",
	 .unit = "%",
	 .help = "Share of the object's light that is grey instead of coloured, as bright as it was: 20 lets the colours of a brand be recognised in warm light. The shadow's colour follows."},
	{"grain", INI_BOOL, AT(composite, grain), .fallback = "no",
	 .help = "yes: the object gets the noise of the background's camera, which is measured meanwhile."},
	{"kernel", INI_TEXT, AT(composite, kernel), .fallback = "auto",
	 .help = "Instructions that the sums are made with, like c or avx2; auto: the fastest that the processor has. inlay bench lists them."},
	INI_KEYS_END};

static const struct ini_key people_keys[] = {
	{"occlude", INI_BOOL, AT(people, occlude), .fallback = "no",
	 .help = "yes: people who walk between camera and object stand before it, and its shadow does not lie on them. The place without people is learned in the first seconds and kept for the light of each moment; \"learn\" takes what is seen as empty, \"forget\" begins anew."},
	{"mask", INI_PATH, AT(people, mask), .fallback = "",
	 .help = "A picture of the background's size (PNG, JPEG or WebP): nobody is looked for where it is dark, such as in a screen or a mirror, which show people who are not there. inlay grab background -o mask.png makes one to paint on."},
	INI_KEYS_END};

static const struct ini_key screen_keys[] = {
	{"driver", INI_TEXT, AT(screen, driver), .fallback = "kms",
	 .help = "Which driver: inlay devices lists them."},
	{"device", INI_PATH, AT(screen, settings.device), .fallback = "",
	 .help = "Which device or output file; empty: the first found."},
	{"width", INI_INT, AT(screen, settings.width), .max = BASIS_SIDE_MAX, .fallback = "0",
	 .unit = "px", .help = "Wanted width; 0: the driver's choice."},
	{"height", INI_INT, AT(screen, settings.height), .max = BASIS_SIDE_MAX, .fallback = "0",
	 .unit = "px", .help = "Wanted height; 0: the driver's choice."},
	{"rate", INI_REAL, AT(screen, settings.rate_hz), .max = 1000, .fallback = "0", .unit = "Hz",
	 .help = "Wanted refreshes a second; 0: the driver's choice."},
	{"show", INI_CHOICE, AT(screen, show), .choices = config_show_names,
	 .fallback = "composite",
	 .help = "What is shown first: the picture with the object, before it, the fisheye with its marked lights, the scene camera, all four, before and after side by side, nothing; guide, for setting up: the calibrated ground and directions."},
	{"scale", INI_CHOICE, AT(screen, scale), .choices = config_scale_names, .fallback = "none",
	 .help = "none: pixel by pixel in the middle of the screen, cut where larger; fit: as large as fits."},
	{"rotate", INI_CHOICE, AT(screen, settings.turn), .choices = picture_turn_names,
	 .fallback = "0", .unit = "deg",
	 .help = "How far the picture is turned clockwise, for a screen that hangs on its side; added to how the panel is built in, where the kernel knows that."},
	{"margins", INI_REALS, AT(screen, settings.margins), 4, .max = 4096, .fallback = "0 0 0 0",
	 .unit = "px",
	 .help = "Black at the left, top, right and bottom of the screen as it is driven: what a television's frame hides."},
	{"split", INI_REAL, AT(screen, split), .max = 1, .fallback = "0.5",
	 .help = "Where the line of show = split stands, as a share of the width."},
	{"information", INI_BOOL, AT(screen, information), .fallback = "no",
	 .help = "A line of figures: lights used, threshold, error, frames a second, latency."},
	{"trouble", INI_BOOL, AT(screen, trouble), .fallback = "yes",
	 .help = "What is wrong is named on the screen."},
	{"blank_after", INI_REAL, AT(screen, blank_after_s), .max = 86400, .fallback = "0",
	 .unit = "s",
	 .help = "After this time without a new picture the last one goes black; 0: never."},
	{"hours", INI_TEXT, AT(screen, hours), .check = config_hours_check, .fallback = "",
	 .help = "When the screen is on, as in \"mon-fri 09:00-12:30, 13:30-18:30, sat 20:00-02:00\"; else it is off and the cameras rest. Empty: always."},
	{"hours_off", INI_CHOICE, AT(screen, hours_off), .choices = config_hours_off_names,
	 .fallback = "signal",
	 .help = "What ends with the hours: the signal; or it stays and is black, for televisions that do not come back by themselves."},
	{"cec", INI_PATH, AT(screen, cec), .fallback = "",
	 .help = "Tells a television by HDMI when hours end and begin, as in /dev/cec0; empty: nothing does."},
	{"time_zone", INI_TEXT, AT(screen, time_zone), .check = config_zone_check, .fallback = "",
	 .help = "The time zone of hours: Europe/Berlin, or CET-1CEST,M3.5.0,M10.5.0/3 on a system that knows no such names; empty: the system's."},
	INI_KEYS_END};

static const struct ini_key buttons_keys[] = {
	{"driver", INI_TEXT, AT(buttons, driver), .fallback = "none",
	 .help = "Which drivers, separated by blanks, or none: inlay devices lists them."},
	INI_KEYS_END};

static const struct ini_key control_keys[] = {
	{"socket", INI_PATH, AT(control, socket), .fallback = "",
	 .help = "Where inlay control reaches a running kiosk; empty: nowhere."},
	{"group", INI_TEXT, AT(control, group), .fallback = "",
	 .help = "Whose members may command, besides the owner and root; empty: nobody."},
	INI_KEYS_END};

static const struct ini_key state_keys[] = {
	{"file", INI_PATH, AT(state, file), .fallback = "",
	 .help = "Where threshold, view and pose are kept over a power cut; empty: nowhere. Beside it, under its name and .place, what [people] has learned of the place."},
	{"interval", INI_REAL, AT(state, interval_s), .max = 86400, .fallback = "5", .unit = "s",
	 .help = "The least time between two writes, besides that at the end; the place is written 360 times as rarely."},
	INI_KEYS_END};

static const struct ini_key metrics_keys[] = {
	{"file", INI_PATH, AT(metrics, file), .fallback = "",
	 .help = "Text file for Prometheus' node exporter, whose name ends in .prom; it is written every 15 s. Empty: none."},
	INI_KEYS_END};

/*
 * Most sections lie in struct config itself. For these, place() returns the struct and .part is the
 * section's offset in it. The three sections with drivers are blocks of their own.
 */
static void *keys_place_config(void *root, const char *instance)
{
	(void)instance;
	return root;
}

static void *keys_place_screen(void *root, const char *instance)
{
	(void)instance;
	return ((struct config *)root)->screen;
}

static void *keys_place_buttons(void *root, const char *instance)
{
	(void)instance;
	return ((struct config *)root)->buttons;
}

/* Creates the camera if the name is new. */
static void *keys_place_camera(void *root, const char *instance)
{
	struct config *config = root;
	struct config_camera *camera = config_camera_named(config, instance);

	if (camera || config->camera_count == CONFIG_CAMERAS_MAX)
		return camera;
	camera = config_block_create(config, CONFIG_CAMERA, camera_keys);
	if (!camera)
		return NULL;
	snprintf(camera->name, sizeof(camera->name), "%s", instance);
	config->cameras[config->camera_count++] = camera;
	return camera;
}

static void *keys_place_lamp(void *root, const char *instance)
{
	struct config *config = root;
	struct lamps *lamps = &config->lamps;
	int i = 0;

	while (i < lamps->count && strcmp(config->lamp_name[i], instance) != 0)
		i++;
	if (i == LAMPS_MAX)
		return NULL;
	if (i == lamps->count) {
		snprintf(config->lamp_name[i], sizeof(config->lamp_name[i]), "%s", instance);
		lamps->count++;
	}
	return &lamps->lamp[i];
}

#define IN_CONFIG(member) .place = keys_place_config, .part = offsetof(struct config, member)

const struct ini_table config_tables[] = {
	{"basis", .keys = basis_keys, IN_CONFIG(basis),
	 .help = "The object, as inlay-bake rendered it."},
	{"poses", .keys = poses_keys, IN_CONFIG(poses),
	 .help = "What follows what, where the basis holds several poses."},
	{"camera", .named = true, .keys = camera_keys, .place = keys_place_camera,
	 .sample = "fisheye background",
	 .help = "A camera. Views below read it by its name; two views may share one."},
	{"fisheye", .keys = fisheye_camera_keys, IN_CONFIG(fisheye.view),
	 .help = "The picture that the light is measured in."},
	{"fisheye", .keys = view_keys, IN_CONFIG(fisheye.view)},
	{"fisheye", .keys = fisheye_lens_keys, IN_CONFIG(fisheye)},
	{"fisheye", .keys = fisheye_keys, IN_CONFIG(fisheye.lens)},
	{"fisheye", .keys = fisheye_light_keys, IN_CONFIG(fisheye)},
	{"fisheye", .keys = fisheye_place_keys, IN_CONFIG(lamps)},
	{"lamp", .named = true, .keys = lamp_keys, .place = keys_place_lamp, .sample = "",
	 .help = "A lamp in the room: its light comes from a place, and not, as all other, from afar. inlay-calibrate lamps finds them; a tape measure does, too."},
	{"background", .keys = background_camera_keys, IN_CONFIG(background.view),
	 .help = "The picture that the object is put into; as large as the basis."},
	{"background", .keys = view_keys, IN_CONFIG(background.view)},
	{"background", .keys = background_keys, IN_CONFIG(background)},
	{"scene", .keys = scene_camera_keys, IN_CONFIG(scene.view),
	 .help = "A picture of the whole set-up, for people."},
	{"scene", .keys = view_keys, IN_CONFIG(scene.view)},
	{"depth", .keys = depth_camera_keys, IN_CONFIG(depth.view),
	 .help = "The distances of what the background shows."},
	{"depth", .keys = view_keys, IN_CONFIG(depth.view)},
	{"depth", .keys = depth_keys, IN_CONFIG(depth)},
	{"lights", .keys = lights_keys, IN_CONFIG(lights), .help = "Which lights are used."},
	{"composite", .keys = composite_keys, IN_CONFIG(composite),
	 .help = "How the object is put into the picture."},
	{"people", .keys = people_keys, IN_CONFIG(people),
	 .help = "Who walks in front of the object."},
	{"screen", .keys = screen_keys, .place = keys_place_screen,
	 .help = "Where the picture goes."},
	{"buttons", .keys = buttons_keys, .place = keys_place_buttons,
	 .help = "Buttons besides the window's keys."},
	{"control", .keys = control_keys, IN_CONFIG(control),
	 .help = "Commands from other programs."},
	{"state", .keys = state_keys, IN_CONFIG(state),
	 .help = "What was chosen with the buttons."},
	{"metrics", .keys = metrics_keys, IN_CONFIG(metrics),
	 .help = "Figures for those who watch many kiosks."},
	INI_TABLES_END};

const size_t config_table_count = sizeof(config_tables) / sizeof(*config_tables) - 1;
