/* SPDX-License-Identifier: MIT */
#include "hal/optics/dome.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/dome_parts.h"
#include "hal/optics/vec.h"

/* Relative tolerance of the sum of all solid angles. Nodes of a file may be such that cells reach
 * too far, or have too many corners. */
#define COVERED 1e-9

static int corners_of(const struct dome *dome, int light)
{
	return dome->cells->first[light + 1] - dome->cells->first[light];
}

static int fill_cells(struct dome *dome)
{
	double sum = 0;

	for (int i = 0; i < dome->count; i++) {
		double moment[3];

		if (dome->cells->first[i + 1] == dome->cells->first[i])
			return -EINVAL;
		dome->solid_angle_sr[i] = dome->cells->cumulative_sr[dome->cells->first[i + 1] - 1];
		dome_cells_moment(dome->cells, i, moment);
		dome->projected_sr[i] = moment[2];
		sum += dome->solid_angle_sr[i];
	}
	return fabs(sum / (2 * M_PI) - 1) < COVERED ? 0 : -EINVAL;
}

static bool frequency_fits(int frequency)
{
	return frequency >= 1 && frequency <= DOME_FREQUENCY_MAX;
}

/* Makes all else from the directions. */
static int dome_fill(struct dome *dome)
{
	const double spacing_rad = sqrt(2 * M_PI / dome->count);
	int ret;

	dome->solid_angle_sr = calloc((size_t)dome->count, sizeof(*dome->solid_angle_sr));
	dome->projected_sr = calloc((size_t)dome->count, sizeof(*dome->projected_sr));
	if (!dome->solid_angle_sr || !dome->projected_sr)
		return -ENOMEM;
	ret = dome_cells_create(&dome->cells, (const double(*)[3])dome->direction, dome->count,
				spacing_rad);
	if (ret < 0)
		return ret;
	ret = dome_lookup_create(&dome->lookup, dome->cells->radius,
				 (const double(*)[3])dome->direction, dome->count);
	if (ret < 0)
		return ret;
	return fill_cells(dome);
}

static int dome_end(struct dome *dome, int ret, struct fault *fault)
{
	if (ret < 0) {
		dome_free(dome);
		return fault_say(fault, ret, "dome: cannot be made: %s",
				 ret == -EINVAL ? "the lights do not cover the sky"
						: strerror(-ret));
	}
	return 0;
}

int dome_create_fine(struct dome *dome, int frequency, const struct dome_fine *fine, int count,
		     int *wrong, struct fault *fault)
{
	int ret;

	*dome = (struct dome){.frequency = frequency};
	*wrong = -1;
	if (!frequency_fits(frequency))
		return fault_say(fault, -EINVAL, "dome: frequency is %d, expected 1 to %d",
				 frequency, DOME_FREQUENCY_MAX);
	for (int k = 0; k < count; k++) {
		*wrong = k;
		if (!frequency_fits(fine[k].frequency) || fine[k].frequency % frequency)
			return fault_say(
				fault, -EINVAL,
				"frequency is %d, expected a multiple of the dome's %d up to %d",
				fine[k].frequency, frequency, DOME_FREQUENCY_MAX);
		if (!(fine[k].direction[2] >= 0))
			return fault_say(fault, -EINVAL, "is below the horizon");
	}
	*wrong = -1;
	ret = dome_nodes_create(frequency, fine, count, &dome->direction, &dome->count);
	return dome_end(dome, ret < 0 ? ret : dome_fill(dome), fault);
}

int dome_create(struct dome *dome, int frequency, struct fault *fault)
{
	int none;

	return dome_create_fine(dome, frequency, NULL, 0, &none, fault);
}

/* Order of nodes for qsort(), by height. */
static int by_height(const void *pa, const void *pb)
{
	const double *const *a = pa, *const *b = pb;

	return (*a)[2] < (*b)[2] ? -1 : (*a)[2] > (*b)[2];
}

/* Whether all nodes are unit, above the horizon, and apart from each other. */
static int check_nodes(const double (*node)[3], int count)
{
	const double **sorted = malloc((size_t)count * sizeof(*sorted));
	int ret = sorted ? 0 : -ENOMEM;

	for (int k = 0; k < count && !ret; k++) {
		sorted[k] = node[k];
		if (!(fabs(vec_length(node[k]) - 1) < 1e-9) || !(node[k][2] >= 0))
			ret = -EINVAL;
	}
	if (!ret)
		qsort(sorted, (size_t)count, sizeof(*sorted), by_height);
	for (int k = 0; k < count && !ret; k++)
		for (int j = k + 1;
		     j < count && !ret && sorted[j][2] - sorted[k][2] < DOME_NODES_APART; j++) {
			double apart[3];

			for (int c = 0; c < 3; c++)
				apart[c] = sorted[j][c] - sorted[k][c];
			if (vec_length(apart) < DOME_NODES_APART)
				ret = -EINVAL;
		}
	free(sorted);
	return ret;
}

int dome_create_nodes(struct dome *dome, const double *node, int stride, int count, int frequency,
		      struct fault *fault)
{
	int ret;

	*dome = (struct dome){.frequency = frequency};
	if (count < 1 || count > DOME_LIGHTS_MAX)
		return fault_say(fault, -EINVAL, "dome: %d lights, expected 1 to %d", count,
				 DOME_LIGHTS_MAX);
	dome->count = count;
	dome->direction = malloc((size_t)count * sizeof(*dome->direction));
	if (!dome->direction)
		return dome_end(dome, -ENOMEM, fault);
	for (int k = 0; k < count; k++)
		memcpy(dome->direction[k], node + (size_t)k * (size_t)stride,
		       sizeof(dome->direction[k]));
	ret = check_nodes((const double(*)[3])dome->direction, count);
	if (ret != -EINVAL)
		return dome_end(dome, ret < 0 ? ret : dome_fill(dome), fault);
	dome_free(dome);
	return fault_say(fault, ret,
			 "dome: expected unit directions above the horizon, %g rad apart",
			 DOME_NODES_APART);
}

void dome_free(struct dome *dome)
{
	free(dome->direction);
	free(dome->solid_angle_sr);
	free(dome->projected_sr);
	dome_cells_destroy(dome->cells);
	dome_lookup_destroy(dome->lookup);
	memset(dome, 0, sizeof(*dome));
}

bool dome_is_fine(const struct dome *dome)
{
	return !dome->frequency || dome->count != dome_node_count(dome->frequency);
}

void dome_angles(const struct dome *dome, int light, double *theta_rad, double *phi_rad)
{
	const double *d = dome->direction[light];

	*theta_rad = atan2(hypot(d[0], d[1]), d[2]);
	*phi_rad = atan2(d[1], d[0]);
}

int dome_cell_of(const struct dome *dome, const double dir[3])
{
	return dome_lookup_find(dome->lookup, dome->direction, dir);
}

/*
 * Draws a point uniform in the spherical triangle a b c (Arvo, "Stratified sampling of spherical
 * triangles", 1995): an arc from b that cuts off the share u of the area, and on the arc a point
 * that cuts off the share v of the thin triangle at b. The arc's end is a cos x + t sin x, with t
 * the unit tangent at a towards c. Van Oosterom and Strackee's formula gives tan(area / 2) of the
 * part cut off as a ratio linear in tau = tan(x / 2), which is solved here: it uses no angles,
 * whose digits would cancel in small triangles.
 */
static void sample_triangle(const double a[3], const double b[3], const double c[3], double u,
			    double v, double dir[3])
{
	const double half_area = tan(0.5 * u * dome_triangle_sr(a, b, c));
	double t[3], normal[3], end[3], across[3], tau, sine, chord, half;

	for (int k = 0; k < 3; k++)
		t[k] = c[k] - a[k];
	vec_cross(a, t, normal);
	vec_cross(normal, a, t);
	vec_normalize(t);
	vec_cross(b, t, normal); /* a . (b x t) = det(a, b, t) */
	tau = half_area * (1 + vec_dot(a, b)) / (vec_dot(a, normal) - half_area * vec_dot(b, t));
	for (int k = 0; k < 3; k++) {
		end[k] = (a[k] * (1 - tau * tau) + t[k] * 2 * tau) / (1 + tau * tau);
		across[k] = end[k] - b[k];
	}
	/* 1 - cos(angle) is uniform along the arc: sin(angle / 2) = sqrt(v) sin(whole / 2) */
	chord = vec_length(across);
	half = asin(sqrt(v) * fmin(0.5 * chord, 1));
	sine = sin(2 * half);
	vec_cross(b, across, normal);
	vec_cross(normal, b, across);
	vec_normalize(across);
	for (int k = 0; k < 3; k++)
		dir[k] = b[k] * cos(2 * half) + across[k] * sine;
}

void dome_cell_sample(const struct dome *dome, int light, double u, double v, double dir[3])
{
	const struct dome_cells *cells = dome->cells;
	const int first = cells->first[light], last = cells->first[light + 1] - 1;
	const double wanted = u * cells->cumulative_sr[last];
	double below = 0, share;
	int k = first;

	while (k < last && cells->cumulative_sr[k] <= wanted)
		below = cells->cumulative_sr[k++];
	share = (wanted - below) / (cells->cumulative_sr[k] - below);
	sample_triangle(cells->corner[k], dome->direction[light],
			cells->corner[k < last ? k + 1 : first], share < 1 ? share : 1, v, dir);
	dir[2] = fmax(dir[2], 0);
	vec_normalize(dir);
}

double dome_cell_reach_rad(const struct dome *dome, int light)
{
	return dome->cells->radius[light];
}

int dome_cell_corners(const struct dome *dome, int light, double (*corner)[3], int room)
{
	const int count = corners_of(dome, light);
	const int written = count < room ? count : room;

	for (int k = 0; k < written; k++)
		memcpy(corner[k], dome->cells->corner[dome->cells->first[light] + k],
		       sizeof(corner[k]));
	return count;
}
