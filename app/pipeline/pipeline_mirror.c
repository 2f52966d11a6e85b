/* SPDX-License-Identifier: MIT */
/* The sky as mirrors show it: the fisheye's picture, with the light that it clips. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_parts.h"

int pipeline_mirror_prepare(struct pipeline *p, struct fault *fault)
{
	const size_t lights = p->basis->info.lights;
	struct pipeline_mirror *m = &p->mirror;

	for (uint32_t pose = 0; pose < p->basis->info.poses; pose++)
		m->on |= p->basis->poses[pose].mirror_count > 0;
	if (!m->on)
		return 0;
	m->limit[0] = -1;
	m->measured = calloc(lights, sizeof(*m->measured));
	m->clipped = calloc(lights, sizeof(*m->clipped));
	m->more = calloc(lights, sizeof(*m->more));
	if (!m->measured || !m->clipped || !m->more)
		return fault_say(fault, -ENOMEM, "not enough memory for mirrors");
	return mirror_map_create(&m->map, p->basis, fault);
}

void pipeline_mirror_free(struct pipeline *p)
{
	mirror_eye_free(&p->mirror.eye);
	mirror_map_free(&p->mirror.map);
	free(p->mirror.measured);
	free(p->mirror.clipped);
	free(p->mirror.more);
	p->mirror = (struct pipeline_mirror){.on = false};
}

void pipeline_mirror_given(struct pipeline *p)
{
	p->mirror.seen = false;
	p->mirror.due = true;
}

int pipeline_mirror_take(struct pipeline *p, const struct frame_reader *frame,
			 const struct image *linear)
{
	const size_t lights = p->basis->info.lights;
	struct pipeline_mirror *m = &p->mirror;
	int err;

	if (!m->on || (linear && p->light.exposure > 0))
		return 0;
	err = linear ? mirror_eye_take_linear(&m->eye, linear)
		     : mirror_eye_take(&m->eye, frame, p->light.exposure);
	if (p->light.exposure > 0)
		return err;
	memcpy(m->measured, p->light.radiance, lights * sizeof(*m->measured));
	memcpy(m->clipped, p->light.left, lights * sizeof(*m->clipped));
	m->seen = m->due = !err;
	return err;
}

/* Multiplies gain, matrix and what makes light neutral (mix_grey()) into one matrix. */
static void fill_colours(const struct pipeline_settings *settings, double colours[9])
{
	static const double luminance[] = {0.2126, 0.7152, 0.0722}; /* ITU-R BT.709 */
	const struct light_sampler_settings *s = &settings->sampler;
	double from[9];
	bool none = true;

	for (int k = 0; k < 9; k++)
		none = none && s->colours[k] == 0;
	for (int k = 0; k < 9; k++)
		from[k] = s->gain * (none ? k % 4 == 0 : s->colours[k]);
	for (int k = 0; k < 9; k++) {
		double grey = 0;

		for (int c = 0; c < 3; c++)
			grey += luminance[c] * from[3 * c + k % 3];
		colours[k] = from[k] + settings->neutral * (grey - from[k]);
	}
}

/* What the light has above the pictures is what pixels lack that clip in all of them. */
static void fill_clipped(const struct pipeline *p)
{
	const struct pipeline_mirror *m = &p->mirror;

	for (int i = 0; i < p->selection.count; i++)
		for (int c = 0; c < 3; c++)
			m->more[i][c] = m->clipped[i] > 0 ? fmax((double)p->light.radiance[i][c] -
									 (double)m->measured[i][c],
								 0) /
								    (double)m->clipped[i]
							  : 0;
}

/* Fills no more of the map than what the poses in the picture look up. */
static void limit_map(struct pipeline *p)
{
	struct pipeline_mirror *m = &p->mirror;
	const int limit[3] = {p->choice.pose, p->choice.share > 0 ? p->choice.next : p->choice.pose,
			      m->seen ? m->eye.level : MIRROR_LIGHTS_LEVEL};

	if (memcmp(m->limit, limit, sizeof(limit)) == 0)
		return;
	memcpy(m->limit, limit, sizeof(limit));
	mirror_map_limit(&m->map, limit[2], p->basis, limit, 1 + (limit[1] != limit[0]));
	m->due = true;
}

void pipeline_mirror_show(struct pipeline *p)
{
	static const double none[3] = {0, 0, 0};
	struct pipeline_mirror *m = &p->mirror;
	struct mirror_colours colours = {.ratio = p->settings.exposure,
					 .clipped = (const double(*)[3])m->more};

	if (!m->on)
		return;
	limit_map(p);
	p->selection.mirror = &m->map;
	for (int c = 0; c < 3; c++)
		p->selection.mirror_gain[c] = 1;
	if (!m->seen) {
		for (int i = 0; i < p->selection.count; i++)
			for (int c = 0; c < 3; c++)
				m->more[i][c] = (double)p->light.radiance[i][c];
		if (m->due)
			mirror_map_fill(&m->map, (const double(*)[3])m->more, none);
		m->due = false;
		return;
	}
	if (!m->due)
		return;
	for (int code = 0; code < 256; code++)
		colours.decode[code] = fmin(
			fmax(transfer_curve_decode(&p->settings.sampler.curve, code / 255.0), 0),
			1);
	fill_colours(&p->settings, colours.matrix);
	fill_clipped(p);
	mirror_eye_fill(&m->eye, &colours, p->pool, &m->map);
	m->due = false;
}
