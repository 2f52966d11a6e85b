#include "bake/encode_part.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/transfer.h"

#define SAMPLE_MAX 1e30F /* so that no sum of a few overflows */
/* Below BASIS_VALUE_MAX by more than any rounding in the encoder. */
#define VALUE_MAX (0.999F * (float)BASIS_VALUE_MAX)
#define BLOCK 64 /* lights that are transposed at once */

void levels_fill(struct levels *levels)
{
	for (int k = 0; k <= LEVELS_STEPS; k++)
		levels->at[k] =
			(float)(255 * transfer_encode(TRANSFER_SRGB, (double)k / LEVELS_STEPS));
	levels->at[LEVELS_STEPS + 1] = levels->at[LEVELS_STEPS];
}

int part_create(struct part *part, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, skies = (size_t)settings->ensemble->skies;

	*part = (struct part){.kept = 0};
	part->cell_slope = calloc(3 * n, sizeof(*part->cell_slope));
	part->sky_x = calloc(skies * 3 * n, sizeof(*part->sky_x));
	part->cell_white = calloc(n, sizeof(*part->cell_white));
	part->sky_base = calloc(skies * PART_ROWS, sizeof(*part->sky_base));
	return part->cell_slope && part->cell_white && part->sky_x && part->sky_base ? 0 : -ENOMEM;
}

void part_free(struct part *part)
{
	free(part->value);
	free(part->direct);
	free(part->own_base);
	free(part->cell_white);
	free(part->cell_slope);
	free(part->sky_x);
	free(part->sky_base);
	*part = (struct part){.kept = 0};
}

static int room_for(float **array, size_t *room, size_t count)
{
	float *grown;

	if (count <= *room)
		return 0;
	grown = realloc(*array, count * sizeof(**array));
	if (!grown)
		return -ENOMEM;
	*array = grown;
	*room = count;
	return 0;
}

/* ---- values per unit of X ---- */

static bool sane(const struct encode_samples *s, const float *row, int count, bool direct)
{
	bool good = true;

	for (int i = 0; i < count; i++)
		good &= fabsf(row[i]) <= SAMPLE_MAX; /* false for NaN */
	for (int i = 0; direct && s->kind == BASIS_KIND_U && i < count; i++)
		good &= row[i] >= 0;
	return good;
}

/* to[light][row] = from[light] / X's factor, or += it. */
static void scatter(const struct encode_settings *settings, enum basis_kind kind, const float *from,
		    float *to, int rows, bool add)
{
	for (int first = 0; first < settings->lights; first += BLOCK)
		for (int i = first; i < settings->lights && i < first + BLOCK; i++) {
			const double w = settings->light[i].solid_angle_sr;
			const float value = kind == BASIS_KIND_V ? from[i]
					    : w > 0		 ? (float)((double)from[i] / w)
					    : from[i] == 0	 ? 0
								 : INFINITY;
			float *at = to + (size_t)i * (size_t)rows;

			*at = add ? *at + value : value;
		}
}

static bool scatter_all(const struct encode_settings *settings, const struct encode_samples *s,
			struct part *part)
{
	const size_t n = (size_t)settings->lights;

	for (int p = 0; p < s->pixels; p++)
		for (int c = 0; c < part->channels; c++) {
			const int own = s->channels == 3 ? c : 0;
			const float *direct = s->direct +
					      ((size_t)p * (size_t)s->channels + (size_t)own) * n;
			float *to = part->value + c * s->pixels + p;

			if (!sane(s, direct, settings->lights, true))
				return false;
			scatter(settings, s->kind, direct, to, part->rows, false);
			if (!s->bounce)
				continue;
			if (c < s->channels)
				scatter(settings, s->kind, direct, part->direct + c * s->pixels + p,
					s->channels * s->pixels, false);
			direct = s->bounce + ((size_t)p * 3 + (size_t)c) * n;
			if (!sane(s, direct, settings->lights, false))
				return false;
			scatter(settings, s->kind, direct, to, part->rows, true);
		}
	return true;
}

int part_load(struct part *part, const struct encode_settings *settings,
	      const struct encode_samples *s)
{
	const size_t n = (size_t)settings->lights;
	int err;

	part->kind = s->kind;
	part->ground = s->ground;
	part->pixels = s->pixels;
	memcpy(part->pixel, s->pixel, (size_t)s->pixels * sizeof(*s->pixel));
	part->direct_channels = s->channels;
	part->channels = s->bounce ? 3 : s->channels;
	part->rows = part->channels * s->pixels;
	err = room_for(&part->value, &part->value_room, n * (size_t)part->rows);
	if (!err && s->bounce)
		err = room_for(&part->direct, &part->direct_room,
			       n * (size_t)(s->channels * s->pixels));
	if (err)
		return err;
	if (!s->bounce) {
		free(part->direct);
		part->direct = NULL;
		part->direct_room = 0;
	}
	if (!scatter_all(settings, s, part))
		return -EDOM;
	part->largest = 0;
	for (size_t k = 0; k < n * (size_t)part->rows; k++) {
		const float size = fabsf(part->value[k]);

		if (!(size <= VALUE_MAX))
			return -EDOM;
		part->largest = size > part->largest ? size : part->largest;
	}
	part->base = part->value;
	return 0;
}

int part_pair(struct part *difference, struct part *whole, int lights)
{
	const int channels = difference->channels > whole->channels ? 3 : whole->channels;
	const size_t count = (size_t)lights * (size_t)whole->rows;
	int err;

	if (difference->channels != channels || whole->channels != channels)
		return -EINVAL;
	err = room_for(&whole->own_base, &whole->base_room, count);
	if (err)
		return err;
	for (size_t k = 0; k < count; k++)
		whole->own_base[k] = whole->value[k] - difference->value[k];
	difference->base = whole->base = whole->own_base;
	return 0;
}

/* ---- exposures ---- */

static float largest_of(const float *value, int count)
{
	float most = 0;

	for (int k = 0; k < count; k++)
		most = value[k] > most ? value[k] : most;
	return most;
}

static const double *ground_of(const struct encode_settings *settings, const struct part *part,
			       int channel)
{
	return settings->ground +
	       ((size_t)part->ground * 3 + (size_t)channel) * (size_t)settings->lights;
}

static void expose_cells(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights;
	double level = 0;

	for (int i = 0; i < n; i++)
		level += ensemble_projected_sr(&settings->light[i]) / M_PI;
	for (int c = 0; c < 3; c++) {
		double u = 0;

		for (int i = 0; part->kind == BASIS_KIND_V && i < n; i++)
			u += ground_of(settings, part, c)[i];
		part->cell_offset[c] = part->kind == BASIS_KIND_V ? (float)fmin(u / level, 1) : 0;
	}
	for (int i = 0; i < n; i++) {
		const float *base = part->base + (size_t)i * (size_t)part->rows;
		const double w = settings->light[i].solid_angle_sr;
		double white = ensemble_projected_sr(&settings->light[i]) / M_PI;

		if (part->kind != BASIS_KIND_V)
			white = fmax(white, w * (double)largest_of(base, part->rows));
		part->cell_white[i] = (float)white;
		for (int c = 0; c < 3; c++)
			part->cell_slope[(size_t)c * (size_t)n + (size_t)i] =
				part->kind == BASIS_KIND_V ? -part->cell_offset[c]
				: white > 0		   ? (float)(w / white)
							   : 0;
	}
}

static void sum_skies(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights, skies = settings->ensemble->skies;

	for (int c = 0; c < 3; c++)
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, part->pixels, n, 1,
			    part->sky_x + (size_t)c * (size_t)n, 3 * n,
			    part->base + (part->channels == 3 ? c * part->pixels : 0), part->rows,
			    0, part->sky_base + c * part->pixels, 3 * part->pixels);
}

/* V: X as shares of all light, the ground's own light as offset. */
static void expose_ground(struct part *part, const struct encode_settings *settings, int sky)
{
	const int n = settings->lights;
	double white = 0, all[3];

	for (int c = 0; c < 3; c++) {
		const float *l = settings->ensemble->radiance + (size_t)(sky * 3 + c) * (size_t)n;
		const double *u = ground_of(settings, part, c);
		double level = 0;

		all[c] = 0;
		for (int i = 0; i < n; i++) {
			all[c] += u[i] * (double)l[i];
			level += ensemble_projected_sr(&settings->light[i]) / M_PI * (double)l[i];
		}
		white = fmax(white, fmax(level, all[c]));
	}
	part->sky_white[sky] = white;
	for (int c = 0; c < 3; c++) {
		const float *l = settings->ensemble->radiance + (size_t)(sky * 3 + c) * (size_t)n;
		const double *u = ground_of(settings, part, c);
		float *x = part->sky_x + (size_t)(sky * 3 + c) * (size_t)n;

		for (int i = 0; i < n; i++)
			x[i] = all[c] > 0 ? (float)(u[i] * (double)l[i] / all[c]) : 0;
		part->sky_offset[sky][c] = white > 0 ? (float)(all[c] / white) : 0;
		part->sky_slope[sky][c] = -part->sky_offset[sky][c];
	}
}

/* The others: X = w L, brought down so that white ground and the brightest pixel are at most 1. */
static void expose_light(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights, skies = settings->ensemble->skies;

	for (int k = 0; k < skies * 3; k++)
		for (int i = 0; i < n; i++)
			part->sky_x[(size_t)k * (size_t)n + (size_t)i] =
				(float)((double)settings->ensemble
						->radiance[(size_t)k * (size_t)n + (size_t)i] *
					settings->light[i].solid_angle_sr);
	sum_skies(part, settings);
	for (int s = 0; s < skies; s++) {
		double white = largest_of(part->sky_base + (size_t)s * 3 * (size_t)part->pixels,
					  3 * part->pixels);

		for (int c = 0; c < 3; c++) {
			const float *x = part->sky_x + (size_t)(s * 3 + c) * (size_t)n;
			double level = 0;

			for (int i = 0; i < n; i++)
				level += fmax(settings->light[i].direction[2], ENSEMBLE_LOWEST) /
					 M_PI * (double)x[i];
			white = fmax(white, level);
		}
		part->sky_white[s] = white;
		for (int k = 0; k < 3 * n; k++)
			part->sky_x[(size_t)s * 3 * (size_t)n + (size_t)k] *=
				white > 0 ? (float)(1 / white) : 0;
		for (int c = 0; c < 3; c++) {
			part->sky_offset[s][c] = 0;
			part->sky_slope[s][c] = 1;
		}
	}
}

float part_cell_error(const struct part *part, const struct levels *levels, int lights, int light,
		      const float *left, float limit)
{
	const float *base = part->base + (size_t)light * (size_t)part->rows;
	float most = 0, worst = 0;

	for (int r = 0; r < part->rows; r++)
		most = fabsf(left[r]) > most ? fabsf(left[r]) : most;
	if (!(most > 0))
		return 0;
	for (int c = 0; c < 3; c++) {
		const float offset = part->cell_offset[c];
		const float slope = part->cell_slope[(size_t)c * (size_t)lights + (size_t)light];
		const int first = part->channels == 3 ? c * part->pixels : 0;

		if (most * fabsf(slope) * LEVELS_STEEPEST <= fminf(limit, 0.01F))
			continue;
		if (part->channels == 1 && c && offset == part->cell_offset[c - 1] &&
		    slope == part->cell_slope[(size_t)(c - 1) * (size_t)lights + (size_t)light])
			continue;
		for (int p = first; p < first + part->pixels; p++) {
			const float is = offset + slope * base[p];
			const float by = fabsf(level_of(levels, is) -
					       level_of(levels, is - slope * left[p]));

			worst = by > worst ? by : worst;
		}
		if (worst > limit)
			return worst;
	}
	return worst;
}

static void choose_pixels(struct part *part, const struct encode_settings *settings,
			  const struct levels *levels, float tolerance)
{
	const int n = settings->lights;

	part->kept = 0;
	for (int p = 0; p < part->pixels; p++) {
		bool keep = part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U;

		for (int k = 0; k < part->channels * n && !keep; k++) {
			const int c = k % part->channels, i = k / part->channels;
			const float value = part->value[(size_t)i * (size_t)part->rows +
							(size_t)(c * part->pixels + p)];

			for (int own = c; own < (part->channels == 3 ? c + 1 : 3); own++) {
				const float by =
					part->cell_slope[(size_t)own * (size_t)n + (size_t)i] *
					value;
				const float is = part->cell_offset[own] + by;

				if (fabsf(by) * LEVELS_STEEPEST <= tolerance)
					continue;
				keep |= fabsf(level_of(levels, is) -
					      level_of(levels, part->cell_offset[own])) > tolerance;
			}
		}
		part->keep[p] = keep;
		part->kept += keep;
	}
}

void part_expose(struct part *part, const struct encode_settings *settings,
		 const struct levels *levels, double tolerance)
{
	expose_cells(part, settings);
	if (part->kind == BASIS_KIND_V) {
		for (int s = 0; s < settings->ensemble->skies; s++)
			expose_ground(part, settings, s);
		sum_skies(part, settings);
	} else {
		expose_light(part, settings);
		sum_skies(part, settings);
	}
	choose_pixels(part, settings, levels, (float)tolerance);
}
