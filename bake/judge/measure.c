/* SPDX-License-Identifier: MIT */
#include "bake/judge/measure.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The compositor clamps ratios to this (bake/judge/README.md, Measurement). */
#define RATIO_MAX 16.0F
/* Two levels read from the table differ by at most this much more than exact ones. It is added to
 * measured errors, so that the target holds for exact levels too. */
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

static void add_object(const struct measure *m, const struct part *part,
		       const float (*sum)[PART_PIXELS], float factor, float (*to)[PART_PIXELS])
{
	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++)
			to[c][m->place[part->pixel[p]]] += factor * sum[c][p];
}

static inline float ratio_shown(float ratio)
{
	return smaller(larger(ratio, 0), RATIO_MAX);
}

/* Adds a V: the ground's light `back` times the ratio 1 - sum. */
static void add_ground(const struct measure *m, const struct part *part,
		       const float (*sum)[PART_PIXELS], const float back[3],
		       float (*to)[PART_PIXELS])
{
	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++) {
			const int at = m->place[part->pixel[p]];

			to[c][at] += ratio_shown(1 - sum[c][p]) * back[c] * m->open[at];
		}
}

/* Adds a pair's receiver: its light without the object, `back`, times the ratio 1 - d / u. */
static void add_receiver(const struct measure *m, const struct part *part,
			 const float (*d)[PART_PIXELS], const float (*u)[PART_PIXELS],
			 const float (*back)[PART_PIXELS], float factor, float (*to)[PART_PIXELS])
{
	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++) {
			const int at = m->place[part->pixel[p]];
			const float ratio = u[c][p] > 0 ? 1 - d[c][p] / u[c][p] : 1;

			to[c][at] += ratio_shown(ratio) * factor * larger(back[c][p], 0) *
				     m->open[at];
		}
}

/* Adds part k to the picture under a lighting. Its sums are multiplied by factor. A V
 * is a share of the ground's light, back. */
static void add_part(struct measure *m, const struct part *parts, int k, float factor,
		     const float back[3])
{
	const struct measure_sums *sums = &m->sums[k];
	struct measure_sums *q = &m->picture;

	if (parts[k].kind == BASIS_KIND_T) {
		add_object(m, &parts[k], sums->truth, factor, q->truth);
		add_object(m, &parts[k], sums->decoded, factor, q->decoded);
	} else if (parts[k].kind == BASIS_KIND_V) {
		add_ground(m, &parts[k], sums->truth, back, q->truth);
		add_ground(m, &parts[k], sums->decoded, back, q->decoded);
	} else if (parts[k].kind == BASIS_KIND_U) {
		add_receiver(m, &parts[k], sums[-1].truth, sums->truth, sums->truth, factor,
			     q->truth);
		add_receiver(m, &parts[k], sums[-1].decoded, sums->decoded, sums->truth, factor,
			     q->decoded);
	}
}

/* Returns the sum of squared differences over the picture; *most becomes the largest difference. */
static double measure_compare(const struct measure *m, double *most)
{
	double square = 0;

	*most = 0;
	for (int c = 0; c < 3; c++) {
		const float *truth = m->picture.truth[c], *decoded = m->picture.decoded[c];
		float by[PART_PIXELS];

		for (int k = 0; k < m->places; k++)
			by[k] = levels_at(m->levels, decoded[k]) - levels_at(m->levels, truth[k]);
		for (int k = 0; k < m->places; k++)
			square += (double)(by[k] * by[k]);
		*most = fmax(*most, (double)part_magnitude(by, m->places));
	}
	return square;
}

/* ---- lightings ---- */

/* Makes the picture under a sky; returns its sum of squared errors, and the largest in *most. */
static double sky_error(struct measure *m, const struct part *parts,
			const struct block_reader *readers, int count, int sky, double *most)
{
	const bool strong = m->settings->ensemble->strong[sky];
	double white = 0;

	memset(&m->picture, 0, sizeof(m->picture));
	for (int k = 0; k < count; k++)
		white = fmax(white, parts[k].sky.white[sky]);
	for (int k = 0; k < count && white > 0; k++) {
		const size_t pixels = (size_t)parts[k].pixels;
		const float *truth = parts[k].sky.value + (size_t)sky * 3 * pixels;
		const float factor = (float)(parts[k].sky.white[sky] / white);
		float back[3];

		block_reader_sky(&readers[k], sky, m->sums[k].decoded);
		for (size_t c = 0; c < 3; c++) {
			back[c] = (strong ? 1 : factor) * parts[k].sky.offset[sky][c];
			memcpy(m->sums[k].truth[c], truth + c * pixels, pixels * sizeof(*truth));
		}
		add_part(m, parts, k, factor, back);
	}
	return measure_compare(m, most);
}

/* Computes the sums under a light alone, with L = 1 (V: X = 1). Values are compared in double
 * precision, as their largest error bounds the error under all skies. */
static void sum_cell(struct measure *m, const struct part *part, const struct block_reader *reader,
		     int light, struct measure_sums *sums, double *bound)
{
	const double w = part->kind == BASIS_KIND_V ? 1 : m->settings->light[light].solid_angle_sr;
	double decoded[3][PART_PIXELS];

	block_reader_light(reader, light, decoded);
	for (int c = 0; c < 3; c++) {
		const float *value = part->value + (size_t)light * (size_t)part->rows +
				     (part->channels == 3 ? c * part->pixels : 0);
		float off[PART_PIXELS];

		for (int p = 0; p < part->pixels; p++) {
			off[p] = (float)((double)value[p] - decoded[c][p]);
			sums->truth[c][p] = (float)(w * (double)value[p]);
			sums->decoded[c][p] = (float)(w * decoded[c][p]);
		}
		*bound = fmax(*bound, (double)part_magnitude(off, part->pixels));
	}
}

/* Makes the picture under a light alone; returns its sum of squared errors, and the largest in
 * *most. */
static double cell_error(struct measure *m, const struct part *parts,
			 const struct block_reader *readers, int count, int light, double *most)
{
	double white = 0;

	memset(&m->picture, 0, sizeof(m->picture));
	for (int k = 0; k < count; k++)
		white = fmax(white, (double)parts[k].cell.white[light]);
	for (int k = 0; k < count; k++) {
		const double own = (double)parts[k].cell.white[light];
		float back[3];

		sum_cell(m, &parts[k], &readers[k], light, &m->sums[k], &m->bound[k]);
		for (int c = 0; c < 3 && white > 0; c++)
			back[c] = (float)((double)parts[k].cell.offset[c] * own / white);
		if (white > 0)
			add_part(m, parts, k, (float)(1 / white), back);
	}
	return measure_compare(m, most);
}

static void measure_skies(struct measure *m, const struct part *parts,
			  const struct block_reader *readers, int count,
			  struct ensemble_error *error)
{
	const struct encode_target *target = &m->settings->target;

	for (int s = 0; s < m->settings->ensemble->skies; s++) {
		const double limit = encode_sky_most(m->settings, s);
		double most;
		const double square = sky_error(m, parts, readers, count, s, &most);

		error->sky_square[s] = square;
		/* A strong sun may have the larger error of a light alone, and counts as one. */
		if (limit > target->max)
			error->cell_max = fmax(error->cell_max, most);
		else
			error->sky_max = fmax(error->sky_max, most);
		m->sky_rms[s] = (sqrt(square / fmax(error->sky_count, 1)) + DIFFERENCE_ERROR) /
				target->rms;
		m->sky_most[s] = (most + DIFFERENCE_ERROR) / limit;
	}
}

/* Numbers the pixels that any part lists. */
static void find_places(struct measure *m, const struct part *parts, int count,
			const uint16_t *coverage)
{
	bool listed[PART_PIXELS] = {false};

	for (int k = 0; k < count; k++)
		for (int p = 0; p < parts[k].pixels; p++)
			listed[parts[k].pixel[p]] = true;
	m->places = 0;
	for (int at = 0; at < PART_PIXELS; at++)
		if (listed[at]) {
			m->open[m->places] = 1 - (float)coverage[at] / 65535;
			m->place[at] = m->places++;
		}
}

int measure_tile(struct measure *m, const struct part *parts, const struct block_reader *readers,
		 int count, const uint16_t *coverage, struct ensemble_error *error)
{
	int err = measure_reserve(m, count);

	*error = (struct ensemble_error){.sky_count = 0};
	if (err)
		return err;
	memset(m->bound, 0, (size_t)count * sizeof(*m->bound));
	find_places(m, parts, count, coverage);
	error->sky_count = 3.0 * m->places;
	error->cell_count = 3.0 * m->places * m->settings->lights;
	measure_skies(m, parts, readers, count, error);
	for (int i = 0; i < m->settings->lights; i++) {
		double most;

		error->cell_square += cell_error(m, parts, readers, count, i, &most);
		error->cell_max = fmax(error->cell_max, most);
		m->cell_most[i] = (float)((most + DIFFERENCE_ERROR) / m->settings->target.cell);
	}
	for (int k = 0; k < count; k++)
		m->bound[k] = m->bound[k] * (1 + (double)FLT_EPSILON) +
			      block_reader_rounding(&readers[k]);
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
	return fmax(measure_worst_sky(m), (double)part_largest(m->cell_most, m->settings->lights));
}
