/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>
#include <string.h>

#include "hal/optics/vec.h"

/* Coordinates in a body: ahead, left, up; m at height 1. */
struct posing {
	const struct walker *walker;
	struct walker_body *body;
	double scale;
};

static void posed_point(const struct posing *posing, const double own[3], double world[3])
{
	for (int i = 0; i < 3; i++)
		world[i] = posing->scale *
			   (own[0] * posing->body->ahead[i] + own[1] * posing->body->side[i]);
	world[0] += posing->walker->place[0];
	world[1] += posing->walker->place[1];
	world[2] += posing->scale * own[2];
}

static void pose_part(struct posing *posing, enum walker_cloth cloth, const double from[3],
		      const double to[3], double radius, double widen)
{
	struct walker_part *part = &posing->body->part[posing->body->count++];

	part->cloth = cloth;
	part->radius = posing->scale * radius;
	part->widen = widen;
	posed_point(posing, from, part->from);
	posed_point(posing, to, part->along);
	for (int i = 0; i < 3; i++)
		part->along[i] -= part->from[i];
}

/* The joint between two bones of a limb that reaches from `from` to `to`: bent towards `bend` (1
 * ahead, -1 back), in the plane of the walk. */
static void bend_limb(const double from[3], const double to[3], double upper, double lower,
		      double bend, double joint[3])
{
	const double reach[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
	const double length = fmin(vec_length(reach), upper + lower - 1e-6);
	const double along = (upper * upper - lower * lower + length * length) / (2 * length);
	const double off = sqrt(fmax(upper * upper - along * along, 0));
	double across[3] = {-reach[2], 0, reach[0]};

	vec_normalize(across);
	for (int i = 0; i < 3; i++)
		joint[i] = from[i] + reach[i] * along / length + bend * off * across[i];
}

/* Where an ankle is in a step, relative to the hip: it stands for 0.6 of a stride, during which the
 * body passes over it, and swings forward for the rest. */
static void step_ankle(double phase, double pace, double *ahead, double *up, double *tilt)
{
	const double stand = 0.6, half = stand * WALKER_STRIDE_M / 2;

	phase -= floor(phase);
	if (phase < stand) {
		*ahead = half - phase * WALKER_STRIDE_M;
		*up = 0;
		/* The heel rises before the foot leaves. */
		*tilt = phase > 0.45 ? (phase - 0.45) / 0.15 : 0;
		*up = 0.05 * *tilt;
	} else {
		const double t = (phase - stand) / (1 - stand);

		*ahead = -half + 2 * half * (t * t * (3 - 2 * t));
		*up = 0.05 * (1 - t) + 0.11 * sin(M_PI * t);
		*tilt = (1 - t) * (1 - t);
	}
	*ahead *= pace;
	*up *= pace;
	*tilt *= pace;
}

static void pose_leg(struct posing *posing, double left, double phase, const double hip[3])
{
	const double ankle_height = 0.085;
	double ahead, up, tilt, knee[3];

	step_ankle(phase, posing->walker->pace, &ahead, &up, &tilt);
	{
		const double ankle[3] = {ahead, 0.085 * left, ankle_height + up};
		const double heel[3] = {ahead - 0.035, ankle[1], 0.045 + up * 1.2};
		const double toe[3] = {ahead + 0.15, ankle[1],
				       0.04 + fmax(up - 0.1 * tilt, 0) * 0.9};

		bend_limb(hip, ankle, 0.425, 0.405, 1, knee);
		pose_part(posing, CLOTH_LEGS, hip, knee, 0.078, 1);
		pose_part(posing, CLOTH_LEGS, knee, ankle, 0.055, 1);
		pose_part(posing, CLOTH_SHOES, heel, toe, 0.04, 1.15);
	}
}

static void pose_arm(struct posing *posing, double left, double phase, const double shoulder[3],
		     bool loaded)
{
	const double swing = loaded ? 0.05 : 0.42 * sin(2 * M_PI * phase) * posing->walker->pace;
	const double bent = 0.15 + (loaded ? 0 : 0.25 * posing->walker->pace) +
			    fmax(swing, 0) * 0.5;
	const double elbow[3] = {shoulder[0] + 0.29 * sin(swing), shoulder[1] + 0.035 * left,
				 shoulder[2] - 0.29 * cos(swing)};
	const double wrist[3] = {elbow[0] + 0.25 * sin(swing + bent), elbow[1],
				 elbow[2] - 0.25 * cos(swing + bent)};
	const double tips[3] = {wrist[0] + 0.1 * sin(swing + bent), wrist[1],
				wrist[2] - 0.1 * cos(swing + bent)};

	pose_part(posing, CLOTH_TOP, shoulder, elbow, 0.052, 1);
	pose_part(posing, CLOTH_TOP, elbow, wrist, 0.042, 1);
	pose_part(posing, CLOTH_SKIN, wrist, tips, 0.036, 0.8);
	if (loaded) {
		const double back[3] = {tips[0] - 0.13, tips[1], tips[2] - 0.17};
		const double front[3] = {tips[0] + 0.13, tips[1], tips[2] - 0.17};

		pose_part(posing, CLOTH_BAG, back, front, 0.14, 0.7);
	}
}

static void pose_person(struct posing *posing)
{
	const struct walker *walker = posing->walker;
	const double phase = walker->walked;
	const double sway = (1 - walker->pace) * 0.012 * sin(1.3 * walker->time_s);
	/* The body sinks a little while both feet are on the ground. */
	const double sink = 0.02 + 0.018 * walker->pace * (1 + cos(4 * M_PI * phase)) / 2 +
			    0.015 * walker->pace;
	const double hips[3] = {0, sway, 0.94 - sink}, waist[3] = {0, sway, 1.06 - sink};
	const double chest[3] = {0.01, 1.5 * sway, 1.36 - sink};
	const double neck[3] = {0.02, 1.6 * sway, 1.5 - sink},
		     jaw[3] = {0.035, 1.6 * sway, 1.56 - sink};
	const double brow[3] = {0.04, 1.6 * sway, 1.63 - sink};
	const double crown[3] = {0.012, 1.6 * sway, 1.655 - sink};

	for (int k = 0; k < 2; k++) {
		const double left = k ? -1 : 1;
		const double hip[3] = {0, hips[1] + 0.085 * left, hips[2] - 0.04};
		const double shoulder[3] = {0, chest[1] + 0.185 * left, chest[2] + 0.03};

		pose_leg(posing, left, phase + 0.5 * k, hip);
		pose_arm(posing, left, phase + 0.5 * k + 0.55, shoulder, k && walker->bag_in_hand);
	}
	pose_part(posing, CLOTH_LEGS, hips, waist, 0.11, 1.45);
	pose_part(posing, CLOTH_TOP, waist, chest, 0.115, 1.5);
	pose_part(posing, CLOTH_SKIN, chest, neck, 0.055, 1);
	pose_part(posing, CLOTH_SKIN, jaw, brow, 0.088, 0.88);
	pose_part(posing, CLOTH_HAIR, crown, crown, 0.1, 0.92);
}

static void pose_left_bag(struct posing *posing)
{
	struct walker_part *part = &posing->body->part[posing->body->count++];

	*part = (struct walker_part){
		.cloth = CLOTH_BAG,
		.from = {posing->walker->bag_place[0] - 0.13, posing->walker->bag_place[1], 0.14},
		.along = {0.26, 0, 0},
		.radius = 0.14,
		.widen = 1,
	};
}

/* Mirrors no part: the map is its own transpose. */
static void squeeze(const struct walker_body *body, const struct walker_part *part,
		    const double v[3], double out[3])
{
	const double less = (1 - 1 / part->widen) * vec_dot(v, body->side);

	for (int i = 0; i < 3; i++)
		out[i] = v[i] - less * body->side[i];
}

static void body_bound(struct walker_body *body)
{
	double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};

	for (int p = 0; p < body->count; p++) {
		const struct walker_part *part = &body->part[p];
		const double wide = part->radius * fmax(part->widen, 1);

		for (int i = 0; i < 3; i++) {
			const double to = part->from[i] + part->along[i];

			low[i] = fmin(low[i], fmin(part->from[i], to) - wide);
			high[i] = fmax(high[i], fmax(part->from[i], to) + wide);
		}
	}
	for (int i = 0; i < 3; i++) {
		body->low[i] = i < 2 ? (low[i] + high[i]) / 2 : low[i];
		body->up[i] = i < 2 ? 0 : high[i] - low[i];
	}
	body->reach = hypot(high[0] - low[0], high[1] - low[1]) / 2;
}

void walker_pose(const struct walker *walker, struct walker_body *body)
{
	struct posing posing = {walker, body,
				walker->height > 0 ? walker->height : walker_height(walker->style)};

	memset(body, 0, sizeof(*body));
	body->style = walker->style;
	body->cloth = walker->cloth;
	body->ahead[0] = cos(walker->heading_rad);
	body->ahead[1] = sin(walker->heading_rad);
	body->side[0] = -body->ahead[1];
	body->side[1] = body->ahead[0];
	if (!walker->absent)
		pose_person(&posing);
	if (walker->bag_left)
		pose_left_bag(&posing);
	for (int p = 0; p < body->count; p++) /* the line in squeezed space */
		squeeze(body, &body->part[p],
			(double[3]){body->part[p].along[0], body->part[p].along[1],
				    body->part[p].along[2]},
			body->part[p].along);
	body_bound(body);
}

/* Nearest distance above 0 of a sphere around a point, seen from `to` it; INFINITY: none. */
static double sphere_hit(const double to[3], const double dir[3], double radius)
{
	const double a = vec_dot(dir, dir), b = -vec_dot(to, dir);
	const double root = b * b - a * (vec_dot(to, to) - radius * radius);

	if (root < 0)
		return INFINITY;
	return -b - sqrt(root) > 0 ? (-b - sqrt(root)) / a : INFINITY;
}

/* A capsule in its squeezed space; from is relative to the ray's origin. *share: the place on the
 * line, 0..1, that is nearest to what is hit. */
static double capsule_hit(const double from[3], const double along[3], double radius,
			  const double dir[3], double *share)
{
	const double line2 = vec_dot(along, along), dir2 = vec_dot(dir, dir);
	const double slant = vec_dot(along, dir), start = -vec_dot(along, from);
	const double a = line2 * dir2 - slant * slant;
	double end[3], near, far;

	if (a > 1e-12) {
		const double b = -line2 * vec_dot(from, dir) - start * slant;
		const double c = line2 * (vec_dot(from, from) - radius * radius) - start * start;
		const double root = b * b - a * c;
		double t;

		if (root < 0)
			return INFINITY;
		t = (-b - sqrt(root)) / a;
		*share = (start + t * slant) / line2;
		if (*share > 0 && *share < 1)
			return t > 0 ? t : INFINITY;
	}
	for (int i = 0; i < 3; i++)
		end[i] = from[i] + along[i];
	near = sphere_hit(from, dir, radius);
	far = sphere_hit(end, dir, radius);
	*share = near <= far ? 0 : 1;
	return fmin(near, far);
}

static double weave(double a, double b, double period)
{
	return sin(2 * M_PI * a / period) * sin(2 * M_PI * b / period);
}

/* Colours of the clothes. along: m from the part's start; around: m about its line. */
static void cloth_albedo(const struct walker_body *body, enum walker_cloth cloth, double along,
			 double around, double albedo[3])
{
	const enum walker_style style = body->style;
	static const double colour[WALKER_STYLES][6][3] = {
		/* skin, hair, top, legs, shoes, bag */
		{{.52, .33, .24},
		 {.06, .04, .03},
		 {.50, .08, .07},
		 {.07, .10, .20},
		 {.30, .29, .27},
		 {0}},
		{{.28, .17, .11},
		 {.02, .02, .02},
		 {.05, .05, .06},
		 {.045, .045, .055},
		 {.02, .02, .02},
		 {0}},
		{{.60, .42, .33},
		 {.30, .18, .08},
		 {.16, .34, .52},
		 {.24, .20, .13},
		 {.08, .05, .03},
		 {0}},
		{{.58, .40, .30},
		 {.12, .07, .04},
		 {.75, .52, .06},
		 {.18, .30, .16},
		 {.55, .10, .10},
		 {0}},
		{{.55, .37, .28},
		 {.20, .12, .07},
		 {.68, .59, .45},
		 {.68, .59, .45},
		 {.68, .59, .45},
		 {0}},
		{{.55, .36, .26},
		 {.10, .07, .05},
		 {.20, .36, .20},
		 {.10, .09, .09},
		 {.05, .05, .05},
		 {.09, .12, .26}},
	};
	double tone = 1 + 0.05 * weave(along, around, 0.02);

	memcpy(albedo, (body->cloth ? body->cloth : colour[style])[cloth], sizeof(double[3]));
	if (style == WALKER_JUMPER && cloth == CLOTH_TOP && fmod(along + 1, 0.09) < 0.045) {
		albedo[0] = 0.66;
		albedo[1] = 0.63;
		albedo[2] = 0.56;
	} else if (style == WALKER_CHECKS && cloth == CLOTH_TOP) {
		tone *= (fmod(along + 1, 0.08) < 0.04 ? 1.25 : 0.75) *
			(fmod(around + 1, 0.08) < 0.04 ? 1.2 : 0.8);
	} else if (style == WALKER_JUMPER && cloth == CLOTH_LEGS) {
		tone *= 1 + 0.2 * weave(along, around, 0.05);
	} else if (style == WALKER_RUG && cloth >= CLOTH_TOP) {
		tone = 1;
	}
	for (int c = 0; c < 3; c++)
		albedo[c] *= tone;
}

/* Normal and colour of what a ray hits. */
static void hit_finish(const struct walker_body *body, const double origin[3], const double dir[3],
		       double share, struct walker_hit *hit)
{
	const struct walker_part *part = &body->part[hit->part];
	double off[3], squeezed[3], across;

	for (int i = 0; i < 3; i++)
		off[i] = origin[i] + hit->distance * dir[i] - part->from[i];
	squeeze(body, part, off, squeezed);
	for (int i = 0; i < 3; i++)
		squeezed[i] -= share * part->along[i];
	across = atan2(vec_dot(off, body->side), vec_dot(off, body->ahead)) * part->radius;
	squeeze(body, part, squeezed, hit->normal);
	vec_normalize(hit->normal);
	cloth_albedo(body, part->cloth, share * vec_length(part->along) + 0.3 * squeezed[2], across,
		     hit->albedo);
}

bool walker_hit(const struct walker_body *body, unsigned parts, const double origin[3],
		const double dir[3], struct walker_hit *hit)
{
	double best = INFINITY, best_share = 0, share = 0;

	for (int p = 0; p < body->count; p++) {
		const struct walker_part *part = &body->part[p];
		double from[3], way[3], distance;

		if (!(parts >> p & 1))
			continue;
		for (int i = 0; i < 3; i++)
			from[i] = part->from[i] - origin[i];
		squeeze(body, part, from, from);
		squeeze(body, part, dir, way);
		distance = capsule_hit(from, part->along, part->radius, way, &share);
		if (distance < best) {
			best = distance;
			best_share = share;
			hit->part = p;
		}
	}
	if (best == INFINITY)
		return false;
	hit->distance = best;
	hit_finish(body, origin, dir, best_share, hit);
	return true;
}

/* Where two lines are nearest: p + s d, s in 0..1 if bounded (else s >= 0), and q + v e, v in 0..1.
 * Returns the distance; *s as found. r = p - q. */
static double lines_apart(const double r[3], const double d[3], const double e[3], bool bounded,
			  double *s)
{
	const double a = vec_dot(d, d), b = vec_dot(d, e), c = vec_dot(d, r);
	const double ee = vec_dot(e, e), f = vec_dot(e, r), denominator = a * ee - b * b;
	double v, apart[3];

	*s = denominator > 1e-12 ? fmax((b * f - c * ee) / denominator, 0) : 0;
	if (bounded)
		*s = fmin(*s, 1);
	v = ee > 1e-12 ? (b * *s + f) / ee : 0;
	v = fmin(fmax(v, 0), 1);
	*s = fmax((b * v - c) / a, 0);
	if (bounded)
		*s = fmin(*s, 1);
	for (int i = 0; i < 3; i++)
		apart[i] = r[i] + *s * d[i] - v * e[i];
	return vec_length(apart);
}

unsigned walker_in_cone(const struct walker_body *body, const double origin[3], const double dir[3],
			double angle_rad)
{
	unsigned parts = 0;
	double to[3], s, apart;

	for (int i = 0; i < 3; i++)
		to[i] = origin[i] - body->low[i];
	apart = lines_apart(to, dir, body->up, false, &s);
	if (apart > body->reach + 1.1 * angle_rad * (s + 1))
		return 0;
	for (int p = 0; p < body->count; p++) {
		const struct walker_part *part = &body->part[p];
		double way[3];

		for (int i = 0; i < 3; i++)
			to[i] = origin[i] - part->from[i];
		squeeze(body, part, to, to);
		squeeze(body, part, dir, way);
		apart = lines_apart(to, way, part->along, false, &s);
		if (apart < part->radius + 1.2 * angle_rad * (s + 0.5) / fmin(part->widen, 1))
			parts |= 1u << p;
	}
	return parts;
}

/* Overlap of a beam of half-width w with a strip of half-width r at a distance, as a share of
 * it. */
static double strip_share(double w, double r, double apart)
{
	return fmax(fmin(w, apart + r) - fmax(-w, apart - r), 0) / (2 * w);
}

double walker_hides(const struct walker_body *body, const double point[3], const double lamp[3],
		    double radius)
{
	double to[3], beam[3], s, apart, most = 0, seen = 1;

	for (int i = 0; i < 3; i++) {
		beam[i] = lamp[i] - point[i];
		to[i] = point[i] - body->low[i];
	}
	apart = lines_apart(to, beam, body->up, true, &s);
	if (apart > body->reach + radius * fmin(s + 0.2, 1))
		return 0;
	for (int p = 0; p < body->count; p++) {
		const struct walker_part *part = &body->part[p];
		double way[3];

		for (int i = 0; i < 3; i++)
			to[i] = point[i] - part->from[i];
		squeeze(body, part, to, to);
		squeeze(body, part, beam, way);
		apart = lines_apart(to, way, part->along, true, &s);
		if (s > 0) {
			const double share = strip_share(fmax(radius * s, 1e-3), part->radius,
							 apart);

			most = fmax(most, share);
			seen *= 1 - share;
		}
	}
	return (most + 1 - seen) / 2;
}
