/* SPDX-License-Identifier: MIT */
/* The configuration that is written for what is plugged in. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/devices_sample.h"
#include "tests/support/test.h"

static void add_node(struct devices_sample *sample, const char *name, const char *bus,
		     const char *link, const char *offer)
{
	char lines[2][160] = {"", ""};
	struct camera_listing listing = {.device = "/dev/video7", .lines = lines, .line_count = 1};

	snprintf(lines[0], sizeof(lines[0]), "%s", offer);
	snprintf(listing.name, sizeof(listing.name), "%s", name);
	snprintf(listing.bus, sizeof(listing.bus), "%s", bus);
	if (link)
		snprintf(lines[listing.line_count++], sizeof(lines[0]), "link /dev/v4l/by-id/%s",
			 link);
	sample_add_camera(sample, "v4l2", &listing);
}

static void add_camera(struct devices_sample *sample, const char *name, const char *bus,
		       const char *link)
{
	add_node(sample, name, bus, link, "MJPG MJPEG 640x480 30 Hz");
}

static char *written(const struct devices_sample *sample)
{
	char *text = NULL;
	size_t length;
	FILE *stream = open_memstream(&text, &length);

	assert_non_null(stream);
	sample_write(sample, stream);
	fclose(stream);
	return text;
}

TEST("a serial number of its own names a camera")
{
	struct devices_sample *sample = sample_create();
	char *text;

	add_camera(sample, "C920", "usb-1", "usb-C920_A-video-index0");
	add_camera(sample, "C920", "usb-2", "usb-C920_B-video-index0");
	text = written(sample);
	assert_non_null(strstr(text, "device = /dev/v4l/by-id/usb-C920_A-video-index0\n"));
	assert_non_null(strstr(text, "device = /dev/v4l/by-id/usb-C920_B-video-index0\n"));
	free(text);
	sample_destroy(sample);
}

/* The only link leads to one of the two, which may be the other one after the next start. */
TEST("a shared serial number does not")
{
	struct devices_sample *sample = sample_create();
	char *text;

	add_camera(sample, "UVC", "usb-1", NULL);
	add_camera(sample, "UVC", "usb-2", "usb-UVC_0001-video-index0");
	add_camera(sample, "Other", "usb-3", "usb-Other-video-index0");
	text = written(sample);
	assert_non_null(strstr(text, "device = usb-1\n"));
	assert_non_null(strstr(text, "device = usb-2\n"));
	assert_non_null(strstr(text, "device = /dev/v4l/by-id/usb-Other-video-index0\n"));
	free(text);
	sample_destroy(sample);
}

/* A depth camera has a node for depths and others for pictures, all on one bus. */
TEST("depths are no picture")
{
	struct devices_sample *sample = sample_create();
	char *text;

	add_node(sample, "D435", "usb-1", NULL, "Z16 Z16 640x480 30 Hz");
	add_node(sample, "D435", "usb-1", NULL, "YUYV YUYV 640x480 30 Hz");
	for (int i = 2; i < 6; i++) {
		const char bus[] = {'u', 's', 'b', '-', (char)('0' + i), '\0'};

		add_camera(sample, "C920", bus, NULL);
	}
	text = written(sample);
	assert_non_null(strstr(text, "\n[camera camera1]\ndriver = v4l2\ndevice = usb-1\n"));
	assert_non_null(strstr(text, "[fisheye]\ncamera = camera1\n"));
	assert_non_null(strstr(text, "\n[camera depth]\ndriver = v4l2\ndevice = usb-1\n"));
	assert_non_null(strstr(text, "\n[depth]\ncamera = depth\n"));
	assert_non_null(strstr(text, "\n[camera camera3]\n")); /* four are the most */
	assert_non_null(strstr(text, "\n; [camera camera4]\n"));
	free(text);
	sample_destroy(sample);
}

static void add_path(struct devices_sample *sample, int node, const char *id, const char *offer)
{
	char lines[3][160] = {"", "", ""};
	struct camera_listing listing = {
		.name = "D435", .bus = "usb-1", .lines = lines, .line_count = id ? 3 : 2};

	snprintf(listing.device, sizeof(listing.device), "/dev/video%d", node);
	snprintf(lines[0], sizeof(lines[0]), "link /dev/v4l/by-path/usb-1-video%d", node);
	snprintf(lines[1], sizeof(lines[1]), "%s", offer);
	snprintf(lines[2], sizeof(lines[2]), "link /dev/v4l/by-id/%s", id ? id : "");
	sample_add_camera(sample, "v4l2", &listing);
}

/* udev's link by id names the device, and any of its three nodes may have it. */
TEST("a depth camera shows its colours")
{
	for (int winner = 0; winner < 3; winner++) {
		const char *const id = "usb-D435-video-index0";
		struct devices_sample *sample = sample_create();
		char *text;

		add_path(sample, 0, winner == 0 ? id : NULL, "Z16 Z16 640x480 30 Hz");
		add_path(sample, 2, winner == 1 ? id : NULL, "GREY GREY 640x480 30 Hz");
		add_path(sample, 4, winner == 2 ? id : NULL, "YUYV YUYV 640x480 30 Hz");
		text = written(sample);
		assert_non_null(strstr(text, "[camera camera1]\ndriver = v4l2\n"
					     "device = /dev/v4l/by-path/usb-1-video4\n"));
		assert_non_null(strstr(text, "[camera depth]\ndriver = v4l2\n"
					     "device = /dev/v4l/by-path/usb-1-video0\n"));
		assert_null(strstr(text, "[camera camera2]"));
		free(text);
		sample_destroy(sample);
	}
}

static void add_card(struct devices_sample *sample, int number, const char *first,
		     const char *second)
{
	char lines[3][160];
	struct display_listing listing = {.name = "card", .lines = lines, .line_count = 3};

	snprintf(listing.device, sizeof(listing.device), "/dev/dri/card%d", number);
	snprintf(lines[0], sizeof(lines[0]), "link /dev/dri/by-path/pci-0000:0%d:00.0-card",
		 number);
	snprintf(lines[1], sizeof(lines[1]), "HDMI-A-1: %s", first);
	snprintf(lines[2], sizeof(lines[2]), "HDMI-A-2: %s", second);
	sample_add_screen(sample, "kms", &listing);
}

TEST("a card is named where several have a screen")
{
	struct devices_sample *sample = sample_create();
	char *text;

	add_card(sample, 0, "disconnected", "disconnected");
	add_card(sample, 1, "connected", "connected");
	text = written(sample);
	assert_non_null(strstr(text, "[screen]\ndriver = kms\nkms.connector = HDMI-A-1\n"));
	free(text);
	add_card(sample, 2, "connected", "disconnected");
	text = written(sample);
	assert_non_null(strstr(text, "device = /dev/dri/by-path/pci-0000:01:00.0-card\n"));
	free(text);
	sample_destroy(sample);
}
