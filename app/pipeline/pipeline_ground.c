/* SPDX-License-Identifier: MIT */
/* Light that is clipped in the sky, recovered from the ground (hal/lights/recovery.h). */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/lights/recovery.h"

struct ground {
	struct pipeline_patch patch;
	float decode[256];
	uint32_t *row;
	double *term[3]; /* [lights] each: u of the patch; one allocation */
	struct clipped_pieces *pieces;
};

static void ground_destroy(struct ground *g)
{
	if (!g)
		return;
	free(g->row);
	free(g->term[0]);
	clipped_pieces_destroy(g->pieces);
	free(g);
}

void pipeline_ground_free(struct pipeline *p)
{
	ground_destroy(p->light.ground);
	p->light.ground = NULL;
}

static bool is_known(const struct pipeline_patch *patch)
{
	return patch->reflectance[0] > 0 || patch->reflectance[1] > 0 || patch->reflectance[2] > 0;
}

/* u of each light, per channel: reflectance / pi * projected_sr of its cell where the reflectance
 * is given, else the basis's ground. */
static void fill_terms(struct ground *g, const struct pipeline *p)
{
	const bool known = is_known(&g->patch);
	const int lights = p->dome.count;

	for (int c = 0; c < 3; c++) {
		g->term[c] = g->term[0] + (size_t)c * (size_t)lights;
		for (int i = 0; i < lights; i++)
			g->term[c][i] = known ? g->patch.reflectance[c] / M_PI *
							p->dome.projected_sr[i]
					      : basis_ground(p->basis, 0, c)[i];
	}
}

int pipeline_check_patch(const struct pipeline_patch *patch, const struct basis *basis,
			 struct fault *fault)
{
	const struct basis_info_chunk *info = &basis->info;

	if (!patch->width)
		return 0;
	if (patch->x + patch->width > (int)info->width ||
	    patch->y + patch->height > (int)info->height)
		return fault_say(
			fault, -EINVAL,
			"[background] ground_patch: reaches to %d, %d, expected at most %u, %u as the basis was baked",
			patch->x + patch->width, patch->y + patch->height, info->width,
			info->height);
	if (!is_known(patch) && !info->grounds)
		return fault_say(
			fault, -EINVAL,
			"[background] ground_reflectance: the basis was baked without a ground, expected the patch's reflectance");
	return 0;
}

int pipeline_ground_prepare(struct pipeline *p, const struct pipeline_settings *settings,
			    struct fault *fault)
{
	const struct pipeline_patch *patch = &settings->patch;
	struct ground *g;
	int err = pipeline_check_patch(patch, p->basis, fault);

	if (err)
		return err;
	if (patch->width == 0) {
		pipeline_ground_free(p);
		return 0;
	}
	g = calloc(1, sizeof(*g));
	if (g) {
		g->patch = *patch;
		g->row = calloc((size_t)patch->width, sizeof(*g->row));
		g->term[0] = calloc(3 * (size_t)p->dome.count, sizeof(double));
	}
	if (!g || !g->row || !g->term[0] || clipped_pieces_create(&g->pieces, &p->dome)) {
		ground_destroy(g);
		return fault_say(fault, -ENOMEM, "not enough memory for a patch of ground");
	}
	fill_terms(g, p);
	for (int code = 0; code < 256; code++)
		g->decode[code] = (float)transfer_curve_decode(&settings->background, code / 255.0);
	pipeline_ground_free(p);
	p->light.ground = g;
	return 0;
}

static bool patch_is_within(const struct pipeline_patch *patch,
			    const struct frame_reader *background)
{
	return patch->x + patch->width <= background->view.width &&
	       patch->y + patch->height <= background->view.height;
}

static struct light_ground see_patch(const struct ground *g, const struct frame_reader *background)
{
	return light_ground_see(background, g->patch.x, g->patch.y, g->patch.width, g->patch.height,
				g->decode, g->row);
}

bool pipeline_ground_expected(const struct pipeline *p, const struct frame_reader *background,
			      double radiance[3], double expected[3])
{
	const struct ground *g = p->light.ground;
	struct light_ground ground;

	if (!g || !is_known(&g->patch) || !patch_is_within(&g->patch, background))
		return false;
	ground = see_patch(g, background);
	for (int c = 0; c < 3; c++) {
		radiance[c] = ground.radiance[c];
		expected[c] = 0;
		for (int i = 0; i < p->dome.count; i++)
			expected[c] += g->term[c][i] * (double)p->light.radiance[i][c];
	}
	return true;
}

void pipeline_recover(struct pipeline *p, const struct frame_reader *background)
{
	const struct ground *g = p->light.ground;
	struct light_clipping clipping = {.lights = p->dome.count,
					  .solid_angle_sr = p->dome.solid_angle_sr,
					  .clipped = p->light.left,
					  .white = light_exposures_white(p->light.exposures)};
	struct light_ground ground;

	if (!g || !(p->light.clipped > 0) || !(clipping.white > 0) ||
	    !patch_is_within(&g->patch, background))
		return;
	for (int c = 0; c < 3; c++)
		clipping.term[c] = g->term[c];
	clipping.piece_sr = clipped_pieces_find(g->pieces, p->light.left);
	ground = see_patch(g, background);
	p->light.recovery = light_recover(&ground, &clipping, p->light.radiance);
	p->mirror.due = true;
}
