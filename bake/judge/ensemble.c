/* SPDX-License-Identifier: MIT */
#include "bake/judge/ensemble.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/random.h"

enum { EVEN = 2, SUN_HEIGHTS = 4, SUN_SIZES = 2, LAMPS = 4, WINDOWS = 12, RANDOM = 4 };
enum { STRONG_SUNS = SUN_HEIGHTS, DUSKS = 4, ROOMS = 4 };
#define BRIGHT                                                                                     \
	(EVEN + SUN_HEIGHTS * SUN_SIZES + LAMPS + WINDOWS + RANDOM + STRONG_SUNS + DUSKS + ROOMS)
/* Every DIM_STEP-th sky occurs again at an eighth of the exposure. */
#define DIM_STEP 5
#define DIM_EXPOSURE 0.125F
#define TRIED (BRIGHT + (BRIGHT + DIM_STEP - 1) / DIM_STEP)
enum { WATCHED_WINDOWS = 144, WATCHED_DUSKS = 24, WATCHED_SUNS = 48 };
#define SKIES (TRIED + WATCHED_WINDOWS + WATCHED_DUSKS + WATCHED_SUNS)
#define STRONG_SIZE 16
#define ROOM_LIGHTS 5

/* Azimuths of suns, and directions of lamps, are multiples of the inverse golden ratio (modulo 1),
 * so that no two agree. */
#define GOLDEN 0.6180339887498949
/* Multiples of the plastic number's inverse and of its square cover a square evenly (R2 of Roberts
 * 2018). */
#define PLASTIC 0.7548776662466927

const double ensemble_blue[3] = {0.8, 1, 1.25};

double ensemble_projected_sr(const struct basis_light *light)
{
	return light->solid_angle_sr * fmax(light->direction[2], ENSEMBLE_LOWEST);
}

static void direction_from(double height_rad, double azimuth_turns, double out[3])
{
	out[0] = cos(height_rad) * cos(2 * M_PI * azimuth_turns);
	out[1] = cos(height_rad) * sin(2 * M_PI * azimuth_turns);
	out[2] = sin(height_rad);
}

static double light_towards(const struct basis_light *light, const double dir[3])
{
	return light->direction[0] * dir[0] + light->direction[1] * dir[1] +
	       light->direction[2] * dir[2];
}

static int nearest_light(const struct basis_light *lights, int count, const double dir[3])
{
	int best = 0;

	for (int i = 1; i < count; i++)
		if (light_towards(&lights[i], dir) > light_towards(&lights[best], dir))
			best = i;
	return best;
}

/* Returns the irradiance of level ground under a sky of radiance 1. */
static double level_light(const struct basis_light *lights, int count)
{
	double sum = 0;

	for (int i = 0; i < count; i++)
		sum += ensemble_projected_sr(&lights[i]);
	return sum;
}

static float *sky_channel(struct ensemble *e, int sky, int channel)
{
	return e->radiance + ((size_t)sky * 3 + (size_t)channel) * (size_t)e->lights;
}

static void even_skies(struct ensemble *e, const struct basis_light *lights, int sky)
{
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < e->lights; i++) {
			const double height = fmax(lights[i].direction[2], 0);

			sky_channel(e, sky, c)[i] = 1;
			sky_channel(e, sky + 1, c)[i] = (float)((1 + 2 * height) / 3);
		}
}

void ensemble_sun(const struct basis_light *lights, int count, int cell, double size,
		  float *radiance)
{
	const double sun = size * level_light(lights, count) / ensemble_projected_sr(&lights[cell]);

	for (int c = 0; c < 3; c++) {
		float *to = radiance + (size_t)c * (size_t)count;

		for (int i = 0; i < count; i++)
			to[i] = (float)ensemble_blue[c];
		to[cell] += (float)sun;
	}
}

/* Makes a sun over the blue sky, and notes it in *sun. */
static void sky_sun(struct ensemble *e, const struct basis_light *lights, int sky,
		    double height_deg, double size, struct ensemble_sun *sun)
{
	const double level = level_light(lights, e->lights);
	double dir[3];
	int cell;

	direction_from(height_deg * M_PI / 180, sky * GOLDEN, dir);
	cell = nearest_light(lights, e->lights, dir);
	ensemble_sun(lights, e->lights, cell, size, sky_channel(e, sky, 0));
	*sun = (struct ensemble_sun){
		.cell = cell,
		.radiance = size * level / ensemble_projected_sr(&lights[cell]),
		.white = (ensemble_blue[2] + size) * level / M_PI,
	};
}

/* Makes a strong sun over a white background, at any height down to the horizon. */
static void sky_strong(struct ensemble *e, const struct basis_light *lights, int sky, int number)
{
	double dir[3];

	direction_from(M_PI / 2 * fmod(number * PLASTIC, 1), number * PLASTIC * PLASTIC, dir);
	ensemble_sun(lights, e->lights, nearest_light(lights, e->lights, dir), STRONG_SIZE,
		     sky_channel(e, sky, 0));
	e->strong[sky] = true;
}

/* Makes three small lamps, red, green and blue, in a dim room. */
static void sky_lamps(struct ensemble *e, const struct basis_light *lights, int sky)
{
	for (int c = 0; c < 3; c++) {
		double dir[3];
		int cell;

		direction_from(M_PI / 2 * fmod((sky + 1) * GOLDEN + c / 3.0, 1),
			       (sky * 3 + c) * GOLDEN, dir);
		cell = nearest_light(lights, e->lights, dir);
		for (int k = 0; k < 3; k++) {
			for (int i = 0; !c && i < e->lights; i++)
				sky_channel(e, sky, k)[i] = 0.1F;
			sky_channel(e, sky, k)[cell] +=
				(float)((k == c ? 1 : 0.2) * level_light(lights, e->lights) /
					ensemble_projected_sr(&lights[cell]));
		}
	}
}

/*
 * Makes a window: a lobe that sends several times as much light as the dim sky around it. The
 * object reflects the light of neighbouring cells to the same places of the ground. Each of them
 * reflects too little for its column to be read, but many together add up, as under a window. So
 * there are windows of several sizes all around, placed by a sequence that fills the hemisphere
 * evenly wherever it ends.
 */
static void sky_window(struct ensemble *e, const struct basis_light *lights, int sky, int number)
{
	const int sharpness = 2 << 2 * (number % 3);
	double dir[3];

	direction_from(M_PI / 2 * fmod(number * PLASTIC, 1), number * PLASTIC * PLASTIC, dir);
	for (int i = 0; i < e->lights; i++) {
		const double lobe = sharpness *
				    pow(fmax(light_towards(&lights[i], dir), 0), sharpness);

		for (int c = 0; c < 3; c++)
			sky_channel(e, sky, c)[i] = (float)(0.2 + lobe * (0.5 + 0.15 * (c - 1)));
	}
}

/* Makes a dusk: a sky that is bright along the horizon, falls to 1/e where the sine of the height
 * is `thick`, and is brightest in one direction. */
static void sky_dusk(struct ensemble *e, const struct basis_light *lights, int sky, int number)
{
	const double thick = 0.1 * (1 << number % 3);
	double dir[3];

	direction_from(0, number * GOLDEN, dir);
	for (int i = 0; i < e->lights; i++) {
		const double low = exp(-fmax(lights[i].direction[2], 0) / thick);
		const double lobe = pow((1 + light_towards(&lights[i], dir)) / 2, 3);

		for (int c = 0; c < 3; c++)
			sky_channel(e, sky, c)[i] = (float)(0.1 * (1 + 0.25 * (c - 1)) +
							    low * lobe * (1 - 0.3 * (c - 1)));
	}
}

/* Makes a room with windows and lamps of random sizes and directions. */
static void sky_room(struct ensemble *e, const struct basis_light *lights, int sky)
{
	struct random random = {random_hash(0x6669656c64, (uint64_t)sky, 0)};

	for (int k = 0; k < 3 * e->lights; k++)
		sky_channel(e, sky, 0)[k] = 0.05F;
	for (int k = 0; k < ROOM_LIGHTS; k++) {
		const double sharpness = pow(2, 1 + 5 * (double)random_next(&random));
		const double height_rad = M_PI / 2 * (double)random_next(&random);
		double dir[3];

		direction_from(height_rad, (double)random_next(&random), dir);
		for (int i = 0; i < e->lights; i++) {
			const double lobe = pow(fmax(light_towards(&lights[i], dir), 0), sharpness);

			for (int c = 0; c < 3; c++)
				sky_channel(e, sky, c)[i] += (float)lobe;
		}
	}
}

/* Makes a random radiance in every cell and channel; most are dim, few are bright. */
static void sky_unlike(struct ensemble *e, int sky)
{
	struct random random = {random_hash(0x656e73656d626c65, (uint64_t)sky, 0)};
	const double power = sky % 2 ? 1 : 4;

	for (int c = 0; c < 3; c++)
		for (int i = 0; i < e->lights; i++)
			sky_channel(e, sky, c)[i] =
				(float)pow(-log1p(-(double)random_next(&random)), power);
}

/* Sets the exposures, and copies every DIM_STEP-th sky to the dim ones. */
static void ensemble_dim(struct ensemble *e)
{
	const size_t each = 3 * (size_t)e->lights;

	for (int s = 0; s < ENSEMBLE_SKIES_MAX; s++)
		e->exposure[s] = s < BRIGHT || s >= TRIED ? 1 : DIM_EXPOSURE;
	for (int s = BRIGHT; s < TRIED; s++)
		memcpy(e->radiance + (size_t)s * each,
		       e->radiance + (size_t)((s - BRIGHT) * DIM_STEP) * each,
		       each * sizeof(*e->radiance));
}

int ensemble_create(struct ensemble *ensemble, const struct basis_light *lights, int count)
{
	static const double height_deg[SUN_HEIGHTS] = {75, 45, 25, 10};
	int sky = EVEN;

	_Static_assert(SUN_HEIGHTS * SUN_SIZES + STRONG_SUNS == ENSEMBLE_SUNS, "all are noted");
	_Static_assert(SKIES + ENSEMBLE_OWN_MAX <= ENSEMBLE_SKIES_MAX, "there is room for all");
	*ensemble = (struct ensemble){.lights = count, .skies = SKIES, .tried = TRIED};
	ensemble->radiance = calloc((size_t)SKIES * 3 * (size_t)count, sizeof(*ensemble->radiance));
	if (!ensemble->radiance)
		return -ENOMEM;
	even_skies(ensemble, lights, 0);
	for (int k = 0; k < SUN_HEIGHTS * SUN_SIZES; k++, sky++)
		sky_sun(ensemble, lights, sky, height_deg[k % SUN_HEIGHTS], k < SUN_HEIGHTS ? 1 : 4,
			&ensemble->sun[k]);
	for (int k = 0; k < LAMPS; k++, sky++)
		sky_lamps(ensemble, lights, sky);
	for (int k = 0; k < WINDOWS; k++, sky++)
		sky_window(ensemble, lights, sky, k);
	for (int k = 0; k < RANDOM; k++, sky++)
		sky_unlike(ensemble, sky);
	for (int k = 0; k < STRONG_SUNS; k++, sky++)
		sky_sun(ensemble, lights, sky, height_deg[k], STRONG_SIZE,
			&ensemble->sun[SUN_HEIGHTS * SUN_SIZES + k]);
	for (int k = 0; k < DUSKS; k++, sky++)
		sky_dusk(ensemble, lights, sky, k);
	for (int k = 0; k < ROOMS; k++, sky++)
		sky_room(ensemble, lights, sky);
	ensemble_dim(ensemble);
	sky = TRIED;
	for (int k = 0; k < WATCHED_WINDOWS; k++, sky++)
		sky_window(ensemble, lights, sky, WINDOWS + k);
	for (int k = 0; k < WATCHED_DUSKS; k++, sky++)
		sky_dusk(ensemble, lights, sky, DUSKS + k);
	for (int k = 0; k < WATCHED_SUNS; k++, sky++)
		sky_strong(ensemble, lights, sky, k);
	return 0;
}

void ensemble_free(struct ensemble *ensemble)
{
	free(ensemble->radiance);
	*ensemble = (struct ensemble){0};
}

void ensemble_error_add(struct ensemble_error *to, const struct ensemble_error *more)
{
	for (int s = 0; s < ENSEMBLE_SKIES_MAX; s++)
		to->sky_square[s] += more->sky_square[s];
	to->sky_count += more->sky_count;
	to->sky_max = fmax(to->sky_max, more->sky_max);
	to->cell_square += more->cell_square;
	to->cell_count += more->cell_count;
	to->cell_max = fmax(to->cell_max, more->cell_max);
}

double ensemble_sky_rms(const struct ensemble_error *error)
{
	double worst = 0;

	for (int s = 0; s < ENSEMBLE_SKIES_MAX; s++)
		worst = fmax(worst, error->sky_square[s]);
	return error->sky_count > 0 ? sqrt(worst / error->sky_count) : 0;
}

double ensemble_cell_rms(const struct ensemble_error *error)
{
	return error->cell_count > 0 ? sqrt(error->cell_square / error->cell_count) : 0;
}
