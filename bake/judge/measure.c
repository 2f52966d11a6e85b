/* SPDX-License-Identifier: MIT */
#include "bake/judge/measure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As the compositor has it: beyond this a ratio is not shown. */
#define RATIO_MAX 16.0
/* Error of the difference of two levels, each read from the table. Measured errors include it, so
 * that exact levels, too, are within what was asked for. */
#define DIFFERENCE_ERROR (2 * LEVELS_ERROR)

void measure_free(struct measure *m)
{
	free(m->sums);
	free(m->bound);
	free(m->cell_most);
	*m = (struct measure){.room = 0};
}

static int measure_reserve(struct measure *m, int count)
{
	if (count <= m->room && m->cell_most)
		return 0;
	free(m->sums);
	free(m->bound);
	m->room = 0;
	m->sums = calloc((size_t)count + 1, sizeof(*m->sums));
	free(m->cell_most);
	m->cell_most = calloc((size_t)m->settings->lights, sizeof(*m->cell_most));
	m->bound = calloc((size_t)count + 1, sizeof(*m->bound));
	if (!m->sums || !m->bound || !m->cell_most)
		return -ENOMEM;
	m->room = count;
	return 0;
}

/* ---- a picture from sums ---- */

static void measure_clear(struct measure *m)
{
	struct measure_picture *q = &m->picture;

	memset(q, 0, sizeof(*q));
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < m->places; k++)
			q->ratio_is[c][m->place[k]] = q->ratio_got[c][m->place[k]] = 1;
}

static void place_object(struct measure *m, const struct part *part,
			 const struct measure_sums *sums, double factor)
{
	struct measure_picture *q = &m->picture;

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++) {
			q->object_is[c][part->pixel[p]] = factor * sums->is[c][p];
			q->object_got[c][part->pixel[p]] = factor * sums->got[c][p];
		}
}

/* sums of shares of the ground's light; back: that light. */
static void place_shadow(struct measure *m, const struct part *part,
			 const struct measure_sums *sums, const double back[3])
{
	struct measure_picture *q = &m->picture;

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++) {
			q->ratio_is[c][part->pixel[p]] = 1 - sums->is[c][p];
			q->ratio_got[c][part->pixel[p]] = 1 - sums->got[c][p];
			q->back[c][part->pixel[p]] = back[c];
		}
}

static void place_pair(struct measure *m, const struct part *part, const struct measure_sums *d,
		       const struct measure_sums *u, double factor)
{
	struct measure_picture *q = &m->picture;

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++) {
			const int at = part->pixel[p];

			if (u->is[c][p] > 0)
				q->ratio_is[c][at] = 1 - d->is[c][p] / u->is[c][p];
			if (u->got[c][p] > 0)
				q->ratio_got[c][at] = 1 - d->got[c][p] / u->got[c][p];
			q->back[c][at] = u->is[c][p] > 0 ? factor * u->is[c][p] : 0;
		}
}

static inline float level_seen(const struct levels *levels, double object, double ratio,
			       double back)
{
	const double shown = ratio < 0 ? 0 : ratio > RATIO_MAX ? RATIO_MAX : ratio;

	return levels_at(levels, (float)(object + shown * back));
}

/* Sum of squared differences over the listed places; *most grows. */
static double measure_compare(const struct measure *m, double *most)
{
	const struct measure_picture *q = &m->picture;
	double square = 0;

	for (int c = 0; c < 3; c++)
		for (int k = 0; k < m->places; k++) {
			const int at = m->place[k];
			const double back = q->back[c][at] * m->open[k];
			const double is = (double)level_seen(m->levels, q->object_is[c][at],
							     q->ratio_is[c][at], back);
			const double got = (double)level_seen(m->levels, q->object_got[c][at],
							      q->ratio_got[c][at], back);
			const double by = got > is ? got - is : is - got;

			square += by * by;
			*most = by > *most ? by : *most;
		}
	return square;
}

/* ---- lightings ---- */

static void sum_sky(struct measure *m, const struct part *part, const struct block_reader *reader,
		    int sky, struct measure_sums *sums)
{
	const size_t n = (size_t)m->settings->lights;
	const float *x = part->sky_x + (size_t)sky * 3 * n;

	block_reader_sky(reader, sky, sums->got);
	if (part->base == part->value) {
		for (int c = 0; c < 3; c++)
			for (int p = 0; p < part->pixels; p++)
				sums->is[c][p] =
					(double)part->sky_base[((size_t)sky * 3 + (size_t)c) *
								       (size_t)part->pixels +
							       (size_t)p];
		return;
	}
	memset(sums->is, 0, sizeof(sums->is));
	for (size_t i = 0; i < n; i++)
		for (int c = 0; c < 3; c++) {
			const float *value = part->value + i * (size_t)part->rows +
					     (part->channels == 3 ? c * part->pixels : 0);

			for (int p = 0; p < part->pixels; p++)
				sums->is[c][p] += (double)(x[(size_t)c * n + i] * value[p]);
		}
}

/* A sum of every light alone, in units of L = 1 (of its shares, for V). */
static void sum_cell(struct measure *m, const struct part *part, const struct block_reader *reader,
		     int light, struct measure_sums *sums, double *bound)
{
	const double w = part->kind == BASIS_KIND_V ? 1 : m->settings->light[light].solid_angle_sr;

	block_reader_light(reader, light, sums->got);
	for (int c = 0; c < 3; c++) {
		const float *value = part->value + (size_t)light * (size_t)part->rows +
				     (part->channels == 3 ? c * part->pixels : 0);

		for (int p = 0; p < part->pixels; p++) {
			*bound = fmax(*bound, fabs((double)value[p] - sums->got[c][p]));
			sums->is[c][p] = w * (double)value[p];
			sums->got[c][p] *= w;
		}
	}
}

static double sky_error(struct measure *m, const struct part *parts,
			const struct block_reader *readers, int count, int sky, double *most)
{
	double white = 0;

	for (int k = 0; k < count; k++) {
		white = fmax(white, parts[k].sky_white[sky]);
		sum_sky(m, &parts[k], &readers[k], sky, &m->sums[k]);
	}
	measure_clear(m);
	for (int k = 0; k < count && white > 0; k++) {
		const double factor = parts[k].sky_white[sky] / white;
		double back[3];

		for (int c = 0; c < 3; c++)
			back[c] = factor * (double)parts[k].sky_offset[sky][c];
		if (parts[k].kind == BASIS_KIND_T)
			place_object(m, &parts[k], &m->sums[k], factor);
		else if (parts[k].kind == BASIS_KIND_V)
			place_shadow(m, &parts[k], &m->sums[k], back);
		else if (parts[k].kind == BASIS_KIND_U && k)
			place_pair(m, &parts[k], &m->sums[k - 1], &m->sums[k], factor);
	}
	return measure_compare(m, most);
}

static double cell_error(struct measure *m, const struct part *parts,
			 const struct block_reader *readers, int count, int light, double *most)
{
	double white = 0;

	for (int k = 0; k < count; k++) {
		white = fmax(white, (double)parts[k].cell_white[light]);
		sum_cell(m, &parts[k], &readers[k], light, &m->sums[k], &m->bound[k]);
	}
	measure_clear(m);
	for (int k = 0; k < count && white > 0; k++) {
		double back[3];

		for (int c = 0; c < 3; c++)
			back[c] = (double)(parts[k].cell_offset[c] * parts[k].cell_white[light]) /
				  white;
		if (parts[k].kind == BASIS_KIND_T)
			place_object(m, &parts[k], &m->sums[k], 1 / white);
		else if (parts[k].kind == BASIS_KIND_V)
			place_shadow(m, &parts[k], &m->sums[k], back);
		else if (parts[k].kind == BASIS_KIND_U && k)
			place_pair(m, &parts[k], &m->sums[k - 1], &m->sums[k], 1 / white);
	}
	return measure_compare(m, most);
}

static void measure_skies(struct measure *m, const struct part *parts,
			  const struct block_reader *readers, int count, const int *number,
			  struct ensemble_error *error)
{
	const struct encode_target *target = &m->settings->target;

	for (int s = 0; s < m->settings->ensemble->skies; s++) {
		double most = 0;
		const double square = sky_error(m, parts, readers, count, s, &most);

		error->sky_square[number[s]] = square;
		error->sky_max = fmax(error->sky_max, most);
		m->sky_rms[s] = (sqrt(square / fmax(error->sky_count, 1)) + DIFFERENCE_ERROR) /
				target->rms;
		m->sky_most[s] = (most + DIFFERENCE_ERROR) / target->max;
	}
}

int measure_tile(struct measure *m, const struct part *parts, const struct block_reader *readers,
		 int count, const uint16_t *coverage, const int *number,
		 struct ensemble_error *error)
{
	bool listed[PART_PIXELS] = {false};
	int err = measure_reserve(m, count);

	*error = (struct ensemble_error){.sky_count = 0};
	if (err)
		return err;
	for (int k = 0; k < count; k++) {
		m->bound[k] = 0;
		for (int p = 0; p < parts[k].pixels; p++)
			listed[parts[k].pixel[p]] = true;
	}
	m->places = 0;
	for (int at = 0; at < PART_PIXELS; at++)
		if (listed[at]) {
			m->open[m->places] = 1 - coverage[at] / 65535.0;
			m->place[m->places++] = at;
		}
	error->sky_count = 3.0 * m->places;
	error->cell_count = 3.0 * m->places * m->settings->lights;
	measure_skies(m, parts, readers, count, number, error);
	for (int i = 0; i < m->settings->lights; i++) {
		double most = 0;

		error->cell_square += cell_error(m, parts, readers, count, i, &most);
		error->cell_max = fmax(error->cell_max, most);
		m->cell_most[i] = (float)((most + DIFFERENCE_ERROR) / m->settings->target.cell);
	}
	for (int k = 0; k < count; k++)
		m->bound[k] += block_reader_rounding(&readers[k]);
	return 0;
}

double measure_worst_sky(const struct measure *m)
{
	double worst = 0;

	for (int s = 0; s < m->settings->ensemble->skies; s++)
		worst = fmax(worst, fmax(m->sky_rms[s], m->sky_most[s]));
	return worst;
}

double measure_worst(const struct measure *m)
{
	return fmax(measure_worst_sky(m),
		    (double)part_largest(m->cell_most, m->settings->lights, 1));
}
