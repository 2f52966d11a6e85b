#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/compositor/compositor.h"

const char *const threshold_mode_names[] = {"ambient", "drop", NULL};

int light_selection_create(struct light_selection *selection, const struct basis *basis)
{
	const size_t n = basis->info.lights;

	*selection = (struct light_selection){.count = (int)n};
	selection->radiance = calloc(n, sizeof(*selection->radiance));
	selection->used = calloc(n, sizeof(*selection->used));
	if (!selection->radiance || !selection->used) {
		light_selection_free(selection);
		return -ENOMEM;
	}
	return 0;
}

void light_selection_free(struct light_selection *selection)
{
	free(selection->radiance);
	free(selection->used);
	*selection = (struct light_selection){0};
}

static double clean(float radiance)
{
	return isfinite(radiance) && radiance > 0 ? (double)radiance : 0;
}

void light_selection_choose(struct light_selection *selection, const struct basis *basis, int pose,
			    const float (*radiance)[3], double threshold, enum threshold_mode mode,
			    double gain)
{
	const float(*peak)[3] = basis->poses[pose].peak;
	double power[3] = {0}, lost[3] = {0};

	selection->used_count = 0;
	for (int i = 0; i < selection->count; i++) {
		const double rgb[3] = {clean(radiance[i][0]), clean(radiance[i][1]),
				       clean(radiance[i][2])};
		const bool used = !(rgb[0] < threshold && rgb[1] < threshold && rgb[2] < threshold);

		selection->used[i] = used;
		selection->used_count += used;
		for (int c = 0; c < 3; c++) {
			selection->radiance[i][c] = used ? rgb[c] : 0;
			if (used)
				continue;
			power[c] += basis->lights[i].solid_angle_sr * rgb[c];
			lost[c] += rgb[c] * (double)peak[i][c];
		}
	}
	for (int c = 0; c < 3; c++) {
		const double ambient = mode == THRESHOLD_AMBIENT ? power[c] / (2 * M_PI) : 0;
		const double added = ambient * (double)peak[selection->count][c];

		selection->ambient[c] = ambient;
		selection->dropped_error[c] = fmax(lost[c], added) * gain;
	}
}
