#include "bake/encode_part.h"

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/transfer.h"

#define SAMPLE_MAX 1e30F /* so that no sum of a few overflows */
/* Below BASIS_VALUE_MAX by more than any rounding in the encoder. */
#define VALUE_MAX (0.999F * (float)BASIS_VALUE_MAX)
/* What tables and single precision may cost of the error asked for. */
#define MARGIN 0.99
/* The narrowest error that is told from others, against the largest value. */
#define NARROWEST 1e-6F
/* The widest: where a light is not seen at all. */
#define WIDEST 1e30F
/* Of a light whose error nobody sees, against the mean: so that none is ignored. */
#define LEAST_WEIGHT 0.01
#define BLOCK 64 /* lights that are transposed at once */

/* sRGB's own formulas, below black and beyond white too. */
static double light_of(double level)
{
	const double encoded = level / 255;

	return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

void levels_fill(struct levels *levels, double cell_error)
{
	/* The least of a step's two ends, so that what lies between is not beyond either. */
	float rise[LEVELS_STEPS + 2], fall[LEVELS_STEPS + 2];

	for (int k = 0; k <= LEVELS_STEPS + 1; k++) {
		const double x = fmin((double)k / LEVELS_STEPS, 1);
		const double level = 255 * transfer_encode(TRANSFER_SRGB, x);

		levels->at[k] = (float)level;
		rise[k] = (float)(MARGIN * (light_of(level + cell_error) - x));
		fall[k] = (float)(MARGIN * (x - light_of(level - cell_error)));
	}
	for (int k = 0; k <= LEVELS_STEPS + 1; k++) {
		const int next = k <= LEVELS_STEPS ? k + 1 : k;

		levels->rise[k] = fminf(rise[k], rise[next]);
		levels->fall[k] = fminf(fall[k], fall[next]);
	}
}

int part_create(struct part *part, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, skies = (size_t)settings->ensemble->skies;

	*part = (struct part){.kept = 0};
	part->cell_slope = calloc(3 * n, sizeof(*part->cell_slope));
	part->sky_x = calloc(skies * 3 * n, sizeof(*part->sky_x));
	part->cell_white = calloc(n, sizeof(*part->cell_white));
	part->weight = calloc(n, sizeof(*part->weight));
	part->sky_base = calloc(skies * PART_ROWS, sizeof(*part->sky_base));
	return part->cell_slope && part->cell_white && part->weight && part->sky_x && part->sky_base
		       ? 0
		       : -ENOMEM;
}

void part_free(struct part *part)
{
	free(part->value);
	free(part->direct);
	free(part->own_base);
	free(part->least_left);
	free(part->most_left);
	free(part->cell_white);
	free(part->weight);
	free(part->cell_slope);
	free(part->sky_x);
	free(part->sky_base);
	*part = (struct part){.kept = 0};
}

int part_room_for(float **array, size_t *room, size_t count)
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

/* False where a value is larger than the file may hold. */
static bool measure(struct part *part, int lights)
{
	bool fits = true;

	part->largest = part->rounded = 0;
	for (int i = 0; i < lights; i++) {
		const float *value = part->value + (size_t)i * (size_t)part->rows;
		const float *direct =
			part->direct ? part->direct + (size_t)i * (size_t)(part->direct_channels *
									   part->pixels)
				     : value;

		for (int r = 0; r < part->rows; r++) {
			const int own = part->direct && part->direct_channels == 1
						? r % part->pixels
						: r;
			const float size = fabsf(value[r]);
			const float both = fabsf(direct[own]) + fabsf(value[r] - direct[own]);

			fits &= size <= VALUE_MAX; /* false for NaN */
			part->largest = size > part->largest ? size : part->largest;
			part->rounded = both > part->rounded ? both : part->rounded;
		}
	}
	return fits;
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
	err = part_room_for(&part->value, &part->value_room, n * (size_t)part->rows);
	if (!err)
		err = part_room_for(&part->least_left, &part->least_room, n * (size_t)part->rows);
	if (!err)
		err = part_room_for(&part->most_left, &part->most_room, n * (size_t)part->rows);
	if (!err && s->bounce)
		err = part_room_for(&part->direct, &part->direct_room,
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
	if (!measure(part, settings->lights))
		return -EDOM;
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
	err = part_room_for(&whole->own_base, &whole->base_room, count);
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

/* Shown light less what is left of it, within rise and fall: slope * left in -rise..fall. */
static void limit_row(const struct levels *levels, float offset, float slope, const float *base,
		      float *least, float *most, int count, bool again)
{
	const float per = fabsf(slope) > FLT_MIN ? 1 / fabsf(slope) : WIDEST;

	for (int p = 0; p < count; p++) {
		const float is = offset + slope * base[p];
		const float rise = fminf(levels_read(levels->rise, is) * per, WIDEST);
		const float fall = fminf(levels_read(levels->fall, is) * per, WIDEST);
		const float low = slope < 0 ? -fall : -rise, high = slope < 0 ? rise : fall;

		least[p] = again ? fmaxf(least[p], low) : low;
		most[p] = again ? fminf(most[p], high) : high;
	}
}

static void limit_cells(struct part *part, const struct levels *levels, int lights)
{
	for (int i = 0; i < lights; i++)
		for (int c = 0; c < 3; c++) {
			const size_t k = (size_t)c * (size_t)lights + (size_t)i;
			const size_t at = (size_t)i * (size_t)part->rows +
					  (size_t)(part->channels == 3 ? c * part->pixels : 0);
			const bool again = part->channels == 1 && c;

			if (again && part->cell_offset[c] == part->cell_offset[0] &&
			    part->cell_slope[k] == part->cell_slope[i])
				continue;
			limit_row(levels, part->cell_offset[c], part->cell_slope[k],
				  part->base + at, part->least_left + at, part->most_left + at,
				  part->pixels, again);
		}
}

/* Lights that allow little error count more: by the mean of what is allowed, inverted. */
static void weigh_lights(struct part *part, int lights)
{
	const float narrowest = NARROWEST * part->largest + FLT_MIN;
	double all = 0;

	for (int i = 0; i < lights; i++) {
		const float *least = part->least_left + (size_t)i * (size_t)part->rows;
		const float *most = part->most_left + (size_t)i * (size_t)part->rows;
		float sum = 0;

		for (int r = 0; r < part->rows; r++) {
			const float narrow = most[r] < -least[r] ? most[r] : -least[r];

			sum += 1 / (narrow > narrowest ? narrow : narrowest);
		}
		part->weight[i] = sum;
		all += (double)sum;
	}
	for (int i = 0; i < lights; i++)
		part->weight[i] =
			all > 0 ? (float)((double)part->weight[i] * lights / all + LEAST_WEIGHT)
				: 1;
}

bool part_cell_holds(const struct part *part, int light, const float *left)
{
	const size_t first = (size_t)light * (size_t)part->rows;

	for (int c = 0; c < part->channels; c++) {
		const int from = c * part->pixels;
		const float *least = part->least_left + first + from;
		const float *most = part->most_left + first + from;
		int beyond = 0;

		for (int p = 0; p < part->pixels; p++)
			beyond |= (left[from + p] < least[p]) | (left[from + p] > most[p]);
		if (beyond)
			return false;
	}
	return true;
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
	limit_cells(part, levels, settings->lights);
	weigh_lights(part, settings->lights);
	choose_pixels(part, settings, levels, (float)tolerance);
}
