/* SPDX-License-Identifier: MIT */
/* Whether the light that is measured can be believed: the lens has to see its lights, outside of
 * its image circle a fisheye's picture is black, and ground of known reflectance is as bright as
 * the light makes it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "app/kiosk/kiosk_parts.h"

#define DOUBT_TICKS 10	     /* seconds for which a doubt lasts before it is said */
#define OUTSIDE_SHARE 0.02   /* of the sky, which a lens may miss along the horizon */
#define CORNER_FROM 1.25     /* radii of the field: a lens may see more than is configured */
#define CORNER_TO 1.6	     /* beyond, lenses and pictures end */
#define CORNER_POINTS_MIN 24 /* of which half must be lit */
#define CORNER_LIT 40	     /* code value; flare and noise stay below */
/* Shade on the ground, a dark coat on it or a sun that is clipped stay below this factor. */
#define GROUND_FACTOR 16
#define GROUND_LIT 0.05 /* linear: a sixteenth of it can still be expected from black */
#define AZIMUTHS 64
#define RADII 4

/* Share of the sky's solid angle whose lights lie outside of the picture. */
static double outside_share(const struct dome *dome, const struct fisheye *lens, int width,
			    int height, int *outside)
{
	double share = 0;

	*outside = 0;
	for (int i = 0; i < dome->count; i++) {
		double px[2];

		/* A light on the horizon lies on the rim, which may be the picture's edge. */
		if (fisheye_project(lens, dome->direction[i], px) && px[0] > -1 &&
		    px[0] < width + 1 && px[1] > -1 && px[1] < height + 1)
			continue;
		(*outside)++;
		share += dome->solid_angle_sr[i] / (2 * M_PI);
	}
	return share;
}

static int level_at(const struct frame_reader *reader, int x, int y)
{
	uint32_t pixel;

	frame_reader_make(reader, x, y, 1, 1, (uint8_t *)&pixel, 4);
	return (int)((pixel & 255) + 2 * (pixel >> 8 & 255) + (pixel >> 16 & 255)) / 4;
}

/* Whether the picture is lit where it lies outside of the image circle. False also where the circle
 * leaves no corners. */
static bool is_lit_outside(const struct frame_reader *reader, const struct fisheye *lens)
{
	const int width = reader->view.width, height = reader->view.height;
	int points = 0, lit = 0;

	for (int a = 0; a < AZIMUTHS; a++)
		for (int r = 0; r < RADII; r++) {
			const double phi = 2 * M_PI * a / AZIMUTHS;
			const double radius = lens->rim * (CORNER_FROM + (CORNER_TO - CORNER_FROM) *
										 r / (RADII - 1));
			const double x = lens->centre_px[0] + lens->focal_px[0] * radius * cos(phi);
			const double y = lens->centre_px[1] + lens->focal_px[1] * radius * sin(phi);

			if (!(x >= 0 && x < width && y >= 0 && y < height))
				continue;
			points++;
			lit += level_at(reader, (int)x, (int)y) > CORNER_LIT;
		}
	return points >= CORNER_POINTS_MIN && 2 * lit > points;
}

/* How much brighter the ground is than the measured light makes it, in the channel in which it is
 * nearest: above GROUND_FACTOR, or below 1 / GROUND_FACTOR; 0: nearer, or not known. Only a gain
 * that was measured ties one camera's light to the other's. */
static double ground_off(const struct kiosk *k)
{
	const struct eye *background = &k->inputs.eyes.background;
	struct frame_reader reader;
	double radiance[3], expected[3], brighter = INFINITY, darker = INFINITY;

	if (!(k->config->fisheye.measured.gain > 0) || !eye_has_picture(background))
		return 0;
	reader = eye_reader(background);
	if (!pipeline_ground_expected(k->picture.pipeline, &reader, radiance, expected))
		return 0;
	for (int c = 0; c < 3; c++) {
		brighter = fmin(brighter, radiance[c] < GROUND_LIT
						  ? 0
						  : radiance[c] / fmax(expected[c], 1e-4));
		darker = fmin(darker,
			      expected[c] < GROUND_LIT ? 0 : expected[c] / fmax(radiance[c], 1e-4));
	}
	return brighter > GROUND_FACTOR ? brighter : darker > GROUND_FACTOR ? 1 / darker : 0;
}

/* Writes a sentence on why the light cannot be right; empty: it can. */
static int find_doubt(struct kiosk *k, char text[OVERLAY_TEXT_MAX])
{
	const struct eye *fisheye = &k->inputs.eyes.fisheye;
	const struct pipeline *pipeline = k->picture.pipeline;
	const double off = ground_off(k);
	const struct frame_reader reader = eye_reader(fisheye);
	int outside;

	if (is_lit_outside(&reader, pipeline_lens(pipeline)))
		return snprintf(
			text, OVERLAY_TEXT_MAX,
			"The fisheye's picture has no image circle where its lens has one: are the cameras exchanged, or centre and focal length wrong?");
	if (off > 1)
		return snprintf(
			text, OVERLAY_TEXT_MAX,
			"The ground is over %d times brighter than the measured light makes it: is the fisheye covered, or an exposure not the calibrated one?",
			GROUND_FACTOR);
	if (off > 0)
		return snprintf(
			text, OVERLAY_TEXT_MAX,
			"The ground is over %d times darker than the measured light makes it: are the cameras exchanged, or an exposure not the calibrated one?",
			GROUND_FACTOR);
	if (outside_share(pipeline_dome(pipeline), pipeline_lens(pipeline), reader.view.width,
			  reader.view.height, &outside) >= OUTSIDE_SHARE)
		return snprintf(
			text, OVERLAY_TEXT_MAX,
			"%d of %d lights lie outside of the fisheye's picture and count as dark: is its circle cut off, or its centre or focal length wrong?",
			outside, pipeline_dome(pipeline)->count);
	return 0;
}

void kiosk_look_for_doubt(struct kiosk *k)
{
	struct kiosk_inputs *in = &k->inputs;

	if (!in->look_due || !eye_has_picture(&in->eyes.fisheye) ||
	    !pipeline_report(k->picture.pipeline).lit)
		return;
	in->look_due = false;
	in->doubt[0] = '\0';
	in->doubted = find_doubt(k, in->doubt) > 0 ? in->doubted + 1 : 0;
}

int kiosk_doubt(struct kiosk *k, char text[OVERLAY_TEXT_MAX])
{
	struct kiosk_inputs *in = &k->inputs;
	struct fault trouble = {.text = ""};

	in->look_due = true;
	snprintf(text, OVERLAY_TEXT_MAX, "%s", in->doubted >= DOUBT_TICKS ? in->doubt : "");
	snprintf(trouble.text, sizeof(trouble.text), "%s", text);
	kiosk_complain(&in->doubt_said, "light", *text ? &trouble : NULL);
	return *text ? 1 : 0;
}
