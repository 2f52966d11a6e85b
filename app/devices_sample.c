/* SPDX-License-Identifier: MIT */
#include "app/devices_sample.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "config/config.h"

enum { CAMERAS = 32, OFFERS = 6, LINE = sizeof(((struct camera_listing *)0)->lines[0]) };

struct sample_camera {
	char driver[32], name[128], bus[128];
	char device[INI_PATH_MAX]; /* as listed: its number may change */
	char link[INI_PATH_MAX]; /* path by id, which stays; empty: none, or it may be another's */
	char path[INI_PATH_MAX]; /* path by socket and node of the device; empty: none */
	char offers[OFFERS][LINE]; /* the first lines with a format that inlay decodes */
	int offer_count, offers_left_out;
	bool pictures;	     /* it offers them; else depths alone */
	bool colours;	     /* it offers pictures that are not grey */
	bool one_of_several; /* there are more such nodes on its bus */
};

struct sample_screen {
	char driver[32], name[128], device[INI_PATH_MAX], connector[64];
	int width, height; /* of the preferred mode; 0: none */
	char rate[16];
};

struct devices_sample {
	struct sample_camera depth; /* the first that offers depths alone; driver empty: none */
	struct sample_camera cameras[CAMERAS];
	int camera_count, cameras_left_out;
	struct sample_screen screen; /* the first connected one */
	int screens;		     /* number of connected ones */
	int cards;		     /* that have one */
	char chip[128], chip_text[INI_TEXT_MAX];
	bool keyboard;
	int refused; /* devices that this user may not open */
};

struct devices_sample *sample_create(void)
{
	return calloc(1, sizeof(struct devices_sample));
}

void sample_destroy(struct devices_sample *sample)
{
	free(sample);
}

/* Whether a driver's line says that this user may not open a device. */
static bool says_refused(const char *text)
{
	return strstr(text, "no permission") || strstr(text, "Permission denied") ||
	       strstr(text, "not for this user");
}

/* The pixel format of inlay, its second word, that a line like "YUYV YUYV 640x480 30 Hz" offers;
 * PIXEL_NONE: it offers none. */
static enum pixel_format offered(const char *line)
{
	char word[16];

	if (sscanf(line, "%*s %15s", word) != 1)
		return PIXEL_NONE;
	for (int i = PIXEL_NONE + 1; i < PIXEL_FORMAT_COUNT; i++)
		if (strcmp(word, pixel_format_names[i]) == 0)
			return (enum pixel_format)i;
	return PIXEL_NONE;
}

static void read_camera_line(struct sample_camera *camera, const char *line)
{
	static const char link[] = "link ";
	const enum pixel_format format = offered(line);

	if (format != PIXEL_NONE) {
		camera->pictures |= format != PIXEL_Z16;
		camera->colours |= format < PIXEL_GREY || format > PIXEL_Z16;
		if (camera->offer_count < OFFERS)
			snprintf(camera->offers[camera->offer_count++], LINE, "%s", line);
		else
			camera->offers_left_out++;
	} else if (strncmp(line, link, strlen(link)) == 0) {
		snprintf(strstr(line, "/by-id/") ? camera->link : camera->path, INI_PATH_MAX, "%s",
			 line + strlen(link));
	}
}

/* Whether both are nodes of one device. A link by id that not each of them has names the device
 * and leads to the node that udev saw last: it is none. */
static bool is_sibling(struct sample_camera *a, struct sample_camera *b)
{
	if (!*a->bus || strcmp(a->driver, b->driver) != 0 || strcmp(a->bus, b->bus) != 0)
		return false;
	a->one_of_several = b->one_of_several = true;
	if (!*a->link || !*b->link)
		*a->link = *b->link = '\0';
	return true;
}

/* The camera of the sample that this one is: v4l2 and libcamera both list a webcam, and a card with
 * several nodes is listed for each. NULL: it is new. */
static struct sample_camera *find_known(struct devices_sample *sample, struct sample_camera *camera)
{
	for (int i = 0; i < sample->camera_count; i++) {
		struct sample_camera *other = &sample->cameras[i];

		if (is_sibling(camera, other) ||
		    (strcmp(other->driver, camera->driver) != 0 && *camera->name &&
		     strstr(other->name, camera->name)))
			return other;
	}
	return NULL;
}

void sample_add_camera(struct devices_sample *sample, const char *driver,
		       const struct camera_listing *listing)
{
	struct sample_camera camera = {.offer_count = 0}, *known;

	snprintf(camera.driver, sizeof(camera.driver), "%s", driver);
	snprintf(camera.name, sizeof(camera.name), "%s", listing->name);
	snprintf(camera.bus, sizeof(camera.bus), "%s", listing->bus);
	snprintf(camera.device, sizeof(camera.device), "%s", listing->device);
	for (int i = 0; i < listing->line_count; i++) {
		read_camera_line(&camera, listing->lines[i]);
		sample->refused += says_refused(listing->lines[i]);
	}
	if (camera.offer_count == 0)
		return;
	known = find_known(sample, &camera);
	(void)is_sibling(&camera, &sample->depth);
	if (!camera.pictures && !*sample->depth.driver)
		sample->depth = camera;
	if (!camera.pictures)
		return;
	if (known && strcmp(known->driver, camera.driver) == 0 && camera.colours && !known->colours)
		*known = camera; /* what is grey is the infrared picture of a depth camera */
	else if (known)
		return;
	else if (sample->camera_count < CAMERAS)
		sample->cameras[sample->camera_count++] = camera;
	else
		sample->cameras_left_out++;
}

void sample_add_screen(struct devices_sample *sample, const char *driver,
		       const struct display_listing *listing)
{
	struct sample_screen *screen = &sample->screen;
	const char *device = listing->device;
	bool ours = false; /* the lines belong to the connector that was taken */
	const int before = sample->screens;

	sample->refused += says_refused(listing->name);
	for (int i = 0; i < listing->line_count; i++) {
		const char *line = listing->lines[i], *colon = strchr(line, ':');

		if (*line != ' ') {
			ours = false;
			if (strncmp(line, "link ", 5) == 0)
				device = line + 5;
			if (!colon || strcmp(colon, ": connected") != 0 || sample->screens++ > 0)
				continue;
			ours = true;
			snprintf(screen->driver, sizeof(screen->driver), "%s", driver);
			snprintf(screen->name, sizeof(screen->name), "%s", listing->name);
			snprintf(screen->device, sizeof(screen->device), "%s", device);
			snprintf(screen->connector, sizeof(screen->connector), "%.*s",
				 (int)(colon - line), line);
		} else if (ours && screen->width == 0 && strstr(line, "(preferred)")) {
			if (sscanf(line, "%dx%d %15s Hz", &screen->width, &screen->height,
				   screen->rate) != 3)
				screen->width = screen->height = 0;
		}
	}
	sample->cards += sample->screens > before;
}

/* Takes the chip's label, because its number may change. */
void sample_add_buttons(struct devices_sample *sample, const char *driver, const char *line)
{
	const char *open = strchr(line, '['), *close = strchr(line, ']');

	sample->refused += says_refused(line);
	if (strcmp(driver, "keyboard") == 0)
		sample->keyboard = true;
	if (strcmp(driver, "gpio") != 0 || *line == ' ' || !open || !close || close < open + 2 ||
	    *sample->chip)
		return;
	snprintf(sample->chip, sizeof(sample->chip), "%.*s", (int)(close - open - 1), open + 1);
	snprintf(sample->chip_text, sizeof(sample->chip_text), "%s", line);
}

/* Whether a camera's link by id may be another camera's after the next start: cameras with one
 * serial number share their link, which then leads to one of them, and the others seem to have
 * none. */
static bool shares_link(const struct devices_sample *sample, const struct sample_camera *camera)
{
	for (int i = 0; i < sample->camera_count; i++) {
		const struct sample_camera *other = &sample->cameras[i];

		if (other != camera && (strcmp(other->link, camera->link) == 0 ||
					(!*other->link && strcmp(other->name, camera->name) == 0)))
			return true;
	}
	return false;
}

/* A name that stays when device numbers change: the link by id, unless it is shared; else the bus
 * where v4l2 knows it, which names the socket, and the link by path where there are more nodes at
 * it. */
static const char *stable_name(const struct devices_sample *sample,
			       const struct sample_camera *camera)
{
	if (*camera->link && strlen(camera->link) < INI_TEXT_MAX && !shares_link(sample, camera))
		return camera->link;
	if (*camera->path && (camera->one_of_several || !*camera->bus))
		return camera->path;
	return *camera->bus ? camera->bus : camera->device;
}

/* mark: before each line that a comment is to be made of. */
static void write_camera(const struct devices_sample *sample, const struct sample_camera *camera,
			 const char *name, const char *mark, FILE *stream)
{
	fprintf(stream, "; %s, now %s%s%s. It offers:\n", *camera->name ? camera->name : "A camera",
		camera->device, *camera->bus ? " at " : "", camera->bus);
	for (int i = 0; i < camera->offer_count; i++)
		fprintf(stream, ";     %s\n", camera->offers[i]);
	if (camera->offers_left_out)
		fprintf(stream, ";     and %d more: see inlay devices\n", camera->offers_left_out);
	fprintf(stream, "%s[camera %s]\n%sdriver = %s\n%sdevice = %s\n", mark, name, mark,
		camera->driver, mark, stable_name(sample, camera));
	fprintf(stream, "; 0: the driver's choice.\n%swidth = 0\n%sheight = 0\n%srate = 0\n\n",
		mark, mark, mark);
}

static void write_cameras(const struct devices_sample *sample, FILE *stream)
{
	const int count = sample->camera_count;
	/* A camera beyond the configuration's limit is written as a comment. */
	const int most = CONFIG_CAMERAS_MAX - (*sample->depth.driver ? 1 : 0);

	for (int i = 0; i < count; i++) {
		char name[32];

		snprintf(name, sizeof(name), "camera%d", i + 1);
		write_camera(sample, &sample->cameras[i], name, i < most ? "" : "; ", stream);
	}
	if (sample->cameras_left_out)
		fprintf(stream, "; %d more cameras: see inlay devices\n\n",
			sample->cameras_left_out);
	if (count == 0)
		fputs("; No camera was found when this was written: this is the first one that comes.\n"
		      "[camera camera1]\n\n",
		      stream);
	if (count < 2)
		fputs("; Both views are of one camera, until there is another: x, y, width and height say\n"
		      "; which part of its picture each is (inlay check --sample).\n\n",
		      stream);
	else
		fputs("; Which camera looks at the sky? If it is the other one, exchange the two names.\n"
		      "\n",
		      stream);
	fputs("; The camera that measures the light, on its back beside the object.\n[fisheye]\n"
	      "camera = camera1\n"
	      "; The middle of its circle of light, in pixels; 0 0: the middle of the picture.\n"
	      "centre = 0 0\n"
	      "; Half of what it sees, in degrees; focal = 0 0: that fills the picture's smaller side.\n"
	      "field = 90\nfocal = 0 0\n\n; The camera in whose picture the object stands.\n",
	      stream);
	fprintf(stream, "[background]\ncamera = camera%d\n\n", count < 2 ? 1 : 2);
	if (!*sample->depth.driver)
		return;
	write_camera(sample, &sample->depth, "depth", "", stream);
	fputs("; How far people are, for [people] occlude = yes; it has to show what the background shows.\n"
	      "[depth]\ncamera = depth\n\n",
	      stream);
}

/* Whether inlay is installed as a service: the package makes this folder (board/appliance.conf). */
static bool is_installed(void)
{
	return access("/etc/inlay", F_OK) == 0;
}

static void write_service(FILE *stream)
{
	fputs("\n"
	      "; For the installed service: inlay control reaches it, and what was chosen outlasts a power cut.\n"
	      "[control]\nsocket = /run/inlay/control\ngroup = inlay\n\n[state]\n"
	      "file = /var/lib/inlay/state\n",
	      stream);
}

static void write_screen(const struct devices_sample *sample, FILE *stream)
{
	const struct sample_screen *screen = &sample->screen;

	const char *console = is_installed() ? "kms.vt = auto\n" : "";

	if (sample->screens == 0) {
		fprintf(stream,
			"; No connected screen was found when this was written: this is the first one that comes.\n"
			"[screen]\n%s\n",
			console);
		return;
	}
	fprintf(stream, "; %s at %s", screen->connector, screen->name);
	if (sample->screens > 1)
		fprintf(stream, "; inlay devices lists %d connected screens", sample->screens);
	fprintf(stream, "\n[screen]\ndriver = %s\n", screen->driver);
	if (sample->cards > 1)
		fprintf(stream, "device = %s\n", screen->device);
	fprintf(stream, "kms.connector = %s\n%s", screen->connector, console);
	if (screen->width)
		fprintf(stream,
			"; It prefers this, at %s Hz:\n;     width = %d\n;     height = %d\n",
			screen->rate, screen->width, screen->height);
	fputc('\n', stream);
}

static void write_buttons(const struct devices_sample *sample, FILE *stream)
{
	if (!*sample->chip && !sample->keyboard) {
		fputs("; No buttons were found: there is inlay control as well.\n[buttons]\n"
		      "driver = none\n",
		      stream);
		return;
	}
	if (*sample->chip)
		fprintf(stream,
			"; %s. Name the lines that your buttons are on, and the driver:\n"
			";     driver = %s\n;     gpio.threshold_next = 17\n"
			";     gpio.view_next = 27\n",
			sample->chip_text, sample->keyboard ? "gpio keyboard" : "gpio");
	fprintf(stream, "[buttons]\ndriver = %s\n", sample->keyboard ? "keyboard" : "none");
	if (*sample->chip)
		fprintf(stream, "gpio.chip = %s\n", sample->chip);
}

int sample_refused(const struct devices_sample *sample)
{
	return sample->refused;
}

void sample_write(const struct devices_sample *sample, FILE *stream)
{
	fputs("; A configuration for what was plugged in when inlay devices --sample wrote it.\n"
	      "; inlay check --config FILE says what is wrong with it; inlay check --sample shows every key.\n"
	      "\n[basis]\n; What inlay-bake made for the place of the background camera.\n"
	      "file = object.inlay\n\n",
	      stream);
	write_cameras(sample, stream);
	write_screen(sample, stream);
	write_buttons(sample, stream);
	if (is_installed())
		write_service(stream);
}
