/* SPDX-License-Identifier: MIT */
#include "bake/trace/world.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/random.h"

#define PACKET 16
#define GLASS_MAX 32 /* more surfaces of glass in a row let nothing through */
/* Rays start this far from the surface that they leave, as a share of the world's largest
 * coordinate: 34 units in the last place (2^-23). */
#define OFFSET_SCALE 4e-6f

struct instance {
	const struct mesh *mesh;
	const struct mesh_part *part;
	const struct material *material;
	enum surface_kind kind;
};

struct world {
	RTCDevice device;
	RTCScene scene[PRESENCE_COUNT];
	/* If there is glass, each scene is divided into glass and all else; without glass these are
	 * NULL. */
	RTCScene glass[PRESENCE_COUNT], solid[PRESENCE_COUNT];
	struct bounds bounds[PRESENCE_COUNT];
	struct instance *instances; /* indexed by geometry number, the same in all scenes */
	unsigned instance_count;
	struct inside inside; /* the objects */
	float size;	      /* largest coordinate of any mesh */
	bool ground, standins, tinted_panes;
	int objects; /* meshes */
	struct bsdf ground_bsdf;
	float extent2; /* squared radius of the ground, or infinity */
};

/*
 * The three queries to Embree, whose arguments changed in version 4.0. Both versions treat rays as
 * incoherent by default. Flagged coherent, queries take half as long again, as the directions of a
 * whole sky are not.
 */
#if RTC_VERSION_MAJOR >= 4
static void embree_intersect(RTCScene scene, struct RTCRayHit *r)
{
	rtcIntersect1(scene, r, NULL);
}

static void embree_occlude(RTCScene scene, struct RTCRay *r)
{
	rtcOccluded1(scene, r, NULL);
}

static void embree_occlude_packet(const int *valid, RTCScene scene, struct RTCRay16 *r)
{
	rtcOccluded16(valid, scene, r, NULL);
}
#else
static void embree_intersect(RTCScene scene, struct RTCRayHit *r)
{
	struct RTCIntersectContext context;

	rtcInitIntersectContext(&context);
	rtcIntersect1(scene, &context, r);
}

static void embree_occlude(RTCScene scene, struct RTCRay *r)
{
	struct RTCIntersectContext context;

	rtcInitIntersectContext(&context);
	rtcOccluded1(scene, &context, r);
}

static void embree_occlude_packet(const int *valid, RTCScene scene, struct RTCRay16 *r)
{
	struct RTCIntersectContext context;

	rtcInitIntersectContext(&context);
	rtcOccluded16(valid, scene, &context, r);
}
#endif

static const struct material plain = {
	.kind = MATERIAL_DIFFUSE,
	.colour = {{0.8f, 0.8f, 0.8f}},
	.ior = 1.5f,
};

static RTCScene scene_new(RTCDevice device)
{
	RTCScene scene = rtcNewScene(device);

	rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
	rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
	return scene;
}

int world_create(struct world **out, struct fault *fault)
{
	struct world *world = calloc(1, sizeof(*world));

	if (!world)
		return fault_say(fault, -ENOMEM, "out of memory for the scene");
	/* One thread builds the tree, so that the same meshes make the same tree. */
	world->device = rtcNewDevice("threads=1");
	if (!world->device) {
		free(world);
		return fault_say(fault, -ENODEV, "the ray tracer does not start (error %d)",
				 (int)rtcGetDeviceError(NULL));
	}
	for (int k = 0; k < PRESENCE_COUNT; k++) {
		world->scene[k] = scene_new(world->device);
		world->bounds[k].radius = -1;
	}
	*out = world;
	return 0;
}

/* One of the N rays of a filter's call, with its hit. Embree passes the members of RTCRay and
 * RTCHit one after the other, each as an array of N, and has accessors for C++ alone. */
struct filtered {
	float ray[8]; /* origin, tnear, direction, time */
	float u, v;
	unsigned triangle, geometry;
};

static struct filtered filtered_of(const struct RTCFilterFunctionNArguments *a, unsigned k)
{
	const float *ray = (const float *)(const void *)a->ray + k;
	const float *hit = (const float *)(const void *)a->hit + k;
	const unsigned *number = (const unsigned *)(const void *)a->hit + k;
	struct filtered f = {.u = hit[3 * a->N],
			     .v = hit[4 * a->N],
			     .triangle = number[5 * a->N],
			     .geometry = number[6 * a->N]};

	for (size_t member = 0; member < 8; member++)
		f.ray[member] = ray[member * a->N];
	f.ray[3] = f.ray[7] = 0;
	return f;
}

/* Returns a random number that is a function of ray and triangle, so that a ray traced again gets
 * the same. */
static float chance_of(const struct filtered *f)
{
	uint64_t pairs[4];

	memcpy(pairs, f->ray, sizeof(pairs));
	return random_unit(
		(uint32_t)(random_hash(random_hash(pairs[0], pairs[1], pairs[2]), pairs[3],
				       (uint64_t)f->geometry << 32 | f->triangle) >>
			   32));
}

static void find_point(const struct mesh_part *part, unsigned triangle, float u, float v,
		       struct material_point *point)
{
	const uint32_t *corner = part->index[triangle];
	const float weight[3] = {1 - u - v, u, v};
	const float(*uv[2])[2] = {(const float(*)[2])part->uv, (const float(*)[2])part->uv2};

	*point = (struct material_point){.colour = {{1, 1, 1}}, .alpha = 1};
	for (int set = 0; set < 2; set++)
		for (int k = 0; k < 3 && uv[set]; k++)
			for (int axis = 0; axis < 2; axis++)
				point->uv[set][axis] += weight[k] * uv[set][corner[k]][axis];
	if (!part->colour)
		return;
	point->colour = rgb_make(0, 0, 0);
	point->alpha = 0;
	for (int k = 0; k < 3; k++) {
		const float *c = part->colour[corner[k]];

		point->colour = rgb_add(point->colour,
					rgb_scale(rgb_make(c[0], c[1], c[2]), weight[k]));
		point->alpha += weight[k] * c[3];
	}
}

/* Lets rays pass where alpha has a hole, and by chance where it is partly transparent. */
static void miss_holes(const struct RTCFilterFunctionNArguments *a)
{
	const struct world *world = a->geometryUserPtr;

	for (unsigned k = 0; k < a->N; k++) {
		const struct filtered f = filtered_of(a, k);
		const struct instance *instance;
		struct material_point point;

		if (a->valid[k] != -1)
			continue;
		instance = &world->instances[f.geometry];
		find_point(instance->part, f.triangle, f.u, f.v, &point);
		if (chance_of(&f) >= material_coverage(instance->material, &point))
			a->valid[k] = 0;
	}
}

static int world_add_part(struct world *world, const struct mesh_part *part, struct fault *fault)
{
	RTCGeometry g = rtcNewGeometry(world->device, RTC_GEOMETRY_TYPE_TRIANGLE);
	const enum surface_kind kind = world->instances[world->instance_count].kind;

	if (!g)
		return fault_say(fault, -ENOMEM, "out of memory for the scene");
	rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, part->position,
				   0, sizeof(*part->position), (size_t)part->vertices);
	rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, part->index, 0,
				   sizeof(*part->index), (size_t)part->triangles);
	if (world->instances[world->instance_count].material->alpha_mode != ALPHA_OPAQUE) {
		rtcSetGeometryUserData(g, world);
		rtcSetGeometryIntersectFilterFunction(g, miss_holes);
		rtcSetGeometryOccludedFilterFunction(g, miss_holes);
	}
	rtcCommitGeometry(g);
	rtcAttachGeometryByID(world->scene[WITH_OBJECTS], g, world->instance_count);
	if (kind == SURFACE_STANDIN)
		rtcAttachGeometryByID(world->scene[WITHOUT_OBJECTS], g, world->instance_count);
	rtcReleaseGeometry(g);
	for (int i = 0; i < part->vertices; i++)
		for (int axis = 0; axis < 3; axis++)
			world->size = fmaxf(world->size, fabsf(part->position[i][axis]));
	world->instance_count++;
	return 0;
}

int world_add(struct world *world, const struct mesh *mesh, const struct material *material,
	      enum surface_kind kind, struct fault *fault)
{
	const size_t count = world->instance_count + (size_t)mesh->part_count;
	struct instance *grown = realloc(world->instances, (count + 1) * sizeof(*grown));

	if (!grown)
		return fault_say(fault, -ENOMEM, "out of memory for the scene");
	world->instances = grown;
	for (int k = 0; k < mesh->part_count; k++) {
		const struct mesh_part *part = &mesh->parts[k];
		struct instance *instance = &world->instances[world->instance_count];
		int err;

		instance->mesh = mesh;
		instance->part = part;
		instance->kind = kind;
		instance->material = material;
		if (!material)
			instance->material = part->material < mesh->material_count
						     ? &mesh->materials[part->material]
						     : &plain;
		err = world_add_part(world, part, fault);
		if (err)
			return err;
	}
	world->standins |= kind == SURFACE_STANDIN;
	world->objects += kind == SURFACE_OBJECT;
	return 0;
}

void world_ground(struct world *world, const struct material *material, double extent)
{
	world->ground = true;
	world->ground_bsdf = material_at(material, 0, 0);
	world->extent2 = extent > 0 ? (float)(extent * extent) : INFINITY;
}

static struct bounds bounds_of(RTCScene scene)
{
	struct RTCBounds box;
	struct bounds b;
	struct v3 half;

	rtcGetSceneBounds(scene, &box);
	half = v3_scale(v3_make(box.upper_x - box.lower_x, box.upper_y - box.lower_y,
				box.upper_z - box.lower_z),
			0.5f);
	b.centre = v3_add(v3_make(box.lower_x, box.lower_y, box.lower_z), half);
	b.radius = v3_length(half) * 1.0001f + 1e-6f;
	return b;
}

/* Sets up a ray of length `most`. */
static void aim_ray(struct RTCRayHit *r, struct v3 origin, struct v3 direction, float most)
{
	memset(r, 0, sizeof(*r));
	r->ray.org_x = origin.x;
	r->ray.org_y = origin.y;
	r->ray.org_z = origin.z;
	r->ray.dir_x = direction.x;
	r->ray.dir_y = direction.y;
	r->ray.dir_z = direction.z;
	r->ray.tfar = most;
	r->ray.mask = ~0u;
	r->hit.geomID = RTC_INVALID_GEOMETRY_ID;
	r->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

static bool world_chord(const void *context, struct v3 from, struct v3 direction, float *length)
{
	struct RTCRayHit r;

	aim_ray(&r, from, direction, INFINITY);
	embree_intersect(((const struct world *)context)->scene[WITH_OBJECTS], &r);
	*length = r.ray.tfar;
	return r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

/* Tells whether light may pass an object, as it has glass or holes: no ball inside of it blocks. */
static bool light_passes(const struct world *world, const struct mesh *mesh)
{
	for (unsigned k = 0; k < world->instance_count; k++)
		if (world->instances[k].mesh == mesh &&
		    (world->instances[k].material->kind == MATERIAL_GLASS ||
		     world->instances[k].material->alpha_mode != ALPHA_OPAQUE))
			return true;
	return false;
}

static void world_fill_inside(struct world *world)
{
	for (unsigned k = 0; k < world->instance_count; k++) {
		const struct instance *i = &world->instances[k];

		if (i->kind == SURFACE_OBJECT && i->part == i->mesh->parts &&
		    !light_passes(world, i->mesh))
			inside_add(&world->inside, i->mesh->parts, i->mesh->part_count,
				   INSIDE_MAX / world->objects, world_chord, world);
	}
}

static bool is_grey(struct rgb c)
{
	return c.c[0] == c.c[1] && c.c[1] == c.c[2];
}

static bool casts_coloured_shadow(const struct instance *instance)
{
	const struct material *material = instance->material;
	const struct bsdf bsdf = material_at(material, 0, 0);

	return bsdf_is_pane(&bsdf) &&
	       (material->texture || instance->part->colour || !is_grey(material->colour));
}

/* Divides each scene into glass and all else, if there is glass. */
static void world_part_glass(struct world *world)
{
	bool any = false;

	for (unsigned k = 0; k < world->instance_count; k++) {
		any |= world->instances[k].material->kind == MATERIAL_GLASS;
		world->tinted_panes |= casts_coloured_shadow(&world->instances[k]);
	}
	for (int p = 0; p < PRESENCE_COUNT && any; p++) {
		world->glass[p] = scene_new(world->device);
		world->solid[p] = scene_new(world->device);
		for (unsigned k = 0; k < world->instance_count; k++) {
			const struct instance *i = &world->instances[k];

			if (p == WITH_OBJECTS || i->kind == SURFACE_STANDIN)
				rtcAttachGeometryByID(i->material->kind == MATERIAL_GLASS
							      ? world->glass[p]
							      : world->solid[p],
						      rtcGetGeometry(world->scene[p], k), k);
		}
		rtcCommitScene(world->glass[p]);
		rtcCommitScene(world->solid[p]);
	}
}

int world_commit(struct world *world, struct fault *fault)
{
	enum RTCError err;

	world_part_glass(world);
	for (int k = 0; k < PRESENCE_COUNT; k++) {
		rtcCommitScene(world->scene[k]);
		if (k == WITH_OBJECTS ? world->instance_count > 0 : world->standins)
			world->bounds[k] = bounds_of(world->scene[k]);
	}
	err = rtcGetDeviceError(world->device);
	if (err != RTC_ERROR_NONE)
		return fault_say(fault, err == RTC_ERROR_OUT_OF_MEMORY ? -ENOMEM : -EIO,
				 "the ray tracer cannot build the scene (error %d)", (int)err);
	world_fill_inside(world);
	return 0;
}

bool world_has_ground(const struct world *world)
{
	return world->ground;
}

bool world_has_standins(const struct world *world)
{
	return world->standins;
}

bool world_has_tinted_panes(const struct world *world)
{
	return world->tinted_panes;
}

const struct bsdf *world_ground_bsdf(const struct world *world)
{
	return &world->ground_bsdf;
}

const struct inside *world_inside(const struct world *world)
{
	return &world->inside;
}

struct bounds world_bounds(const struct world *world, enum presence presence)
{
	return world->bounds[presence];
}

/* ---- one ray ---- */

/* Returns the distance to the ground, or infinity. A ray that leaves the underside of a mesh on the
 * ground starts a little below the ground; its distance is 0. */
static float ground_distance(const struct world *world, struct v3 origin, struct v3 direction)
{
	float t, x, y;

	if (!world->ground || direction.z >= 0 || origin.z < -2 * OFFSET_SCALE * world->size)
		return INFINITY;
	t = fmaxf(-origin.z / direction.z, 0);
	x = origin.x + t * direction.x;
	y = origin.y + t * direction.y;
	return x * x + y * y <= world->extent2 ? t : INFINITY;
}

static void ground_surface(const struct world *world, struct v3 origin, struct v3 direction,
			   float t, struct surface *s)
{
	*s = (struct surface){
		.kind = SURFACE_GROUND,
		.position = v3_mad(origin, t, direction),
		.normal = {0, 0, 1},
		.geometric = {0, 0, 1},
		.outer = true,
		.bsdf = world->ground_bsdf,
	};
	s->position.z = 0;
}

/* Finds the axes of a part's own tangents. */
static void tangent_axes(const struct mesh_part *part, const uint32_t corner[3],
			 const float weight[3], struct v3 normal, struct v3 *along_u,
			 struct v3 *along_v)
{
	*along_u = (struct v3){0, 0, 0};
	for (int k = 0; k < 3; k++) {
		const float *t = part->tangent[corner[k]];

		*along_u = v3_mad(*along_u, weight[k], v3_make(t[0], t[1], t[2]));
	}
	*along_v = v3_scale(v3_cross(normal, *along_u), part->tangent[corner[0]][3]);
}

/* Finds the axes of a texture on a triangle, which turn with the texture. Returns false if it has
 * none. */
static bool texture_axes(const struct mesh_part *part, const struct texture_use *use,
			 const uint32_t corner[3], struct v3 *along_u, struct v3 *along_v)
{
	const float(*uv)[2] = (const float(*)[2])(use->set ? part->uv2 : part->uv);
	const float *place = use->place;
	struct v3 edge[2];
	float d[2][2], area;

	if (!uv)
		return false;
	for (int k = 0; k < 2; k++) {
		const float *a = part->position[corner[0]], *b = part->position[corner[k + 1]];

		edge[k] = v3_make(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
		for (int axis = 0; axis < 2; axis++)
			d[k][axis] = place[3 * axis] * (uv[corner[k + 1]][0] - uv[corner[0]][0]) +
				     place[3 * axis + 1] *
					     (uv[corner[k + 1]][1] - uv[corner[0]][1]);
	}
	area = d[0][0] * d[1][1] - d[1][0] * d[0][1];
	*along_u = v3_scale(v3_mad(v3_scale(edge[0], d[1][1]), -d[0][1], edge[1]),
			    copysignf(1, area));
	*along_v = v3_scale(v3_mad(v3_scale(edge[1], d[0][0]), -d[1][0], edge[0]),
			    copysignf(1, area));
	return area != 0;
}

/* Returns the normal of a material with bumps, given that of the smoothed surface. */
static struct v3 bumpy_normal(const struct instance *instance, const uint32_t corner[3],
			      const float weight[3], const struct material_point *point,
			      struct v3 normal)
{
	const struct mesh_part *part = instance->part;
	const struct material *m = instance->material;
	struct v3 along_u, along_v;

	if (!m->bumps.texture)
		return normal;
	normal = v3_unit(normal);
	if (part->tangent)
		tangent_axes(part, corner, weight, normal, &along_u, &along_v);
	else if (!texture_axes(part, &m->bumps, corner, &along_u, &along_v))
		return normal;
	return material_bump(m, point, along_u, along_v, normal);
}

/* Computes the hit point from the triangle, not from the ray, so that its error does not grow with
 * distance. */
static void mesh_surface(const struct world *world, struct v3 direction, const struct RTCRayHit *r,
			 struct surface *s)
{
	const struct instance *instance = &world->instances[r->hit.geomID];
	const struct mesh_part *part = instance->part;
	const uint32_t *corner = part->index[r->hit.primID];
	const float weight[3] = {1 - r->hit.u - r->hit.v, r->hit.u, r->hit.v};
	struct v3 position = {0, 0, 0}, normal = {0, 0, 0};
	struct material_point point;

	for (int k = 0; k < 3; k++) {
		const float *p = part->position[corner[k]];

		position = v3_mad(position, weight[k], v3_make(p[0], p[1], p[2]));
		normal = v3_mad(normal, weight[k], part->normal[corner[k]]);
	}
	find_point(part, r->hit.primID, r->hit.u, r->hit.v, &point);
	normal = bumpy_normal(instance, corner, weight, &point, normal);
	s->kind = instance->kind;
	s->mesh = instance->mesh;
	s->position = position;
	s->geometric = v3_unit(v3_make(r->hit.Ng_x, r->hit.Ng_y, r->hit.Ng_z));
	s->outer = v3_dot(s->geometric, direction) < 0;
	if (!s->outer)
		s->geometric = v3_scale(s->geometric, -1);
	if (v3_dot(normal, s->geometric) < 0)
		normal = v3_scale(normal, -1);
	s->normal = v3_unit(normal);
	/* A smoothed normal that points away from the viewer would make the surface black. */
	if (v3_dot(s->normal, direction) >= -1e-4f || v3_dot(normal, normal) == 0)
		s->normal = s->geometric;
	s->offset = OFFSET_SCALE * world->size;
	s->bsdf = material_at_point(instance->material, &point);
}

bool world_nearest(const struct world *world, enum presence presence, struct v3 origin,
		   struct v3 direction, struct surface *surface)
{
	struct RTCRayHit r;
	const float ground = ground_distance(world, origin, direction);

	aim_ray(&r, origin, direction, ground);
	embree_intersect(world->scene[presence], &r);
	if (r.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
		mesh_surface(world, direction, &r, surface);
		return true;
	}
	if (ground < INFINITY) {
		ground_surface(world, origin, direction, ground, surface);
		return true;
	}
	return false;
}

static bool scene_blocks(RTCScene scene, struct v3 origin, struct v3 direction, float far)
{
	struct RTCRay r = {
		.org_x = origin.x,
		.org_y = origin.y,
		.org_z = origin.z,
		.dir_x = direction.x,
		.dir_y = direction.y,
		.dir_z = direction.z,
		.tfar = far,
		.mask = ~0u,
	};

	embree_occlude(scene, &r);
	return r.tfar < 0;
}

struct passage world_through_glass(const struct world *world, enum presence presence,
				   struct v3 origin, struct v3 direction, float far)
{
	struct passage p = {.open = true, .sky = direction, .passed = {{1, 1, 1}}};
	struct surface s;

	for (int k = 0; world_nearest(world, presence, origin, p.sky, &s); k++) {
		const float way = v3_length(v3_sub(s.position, origin));
		const struct glass_ways ways = bsdf_glass_ways(&s.bsdf, s.normal, s.outer,
							       v3_scale(p.sky, -1));

		if (way >= far)
			return p;
		far -= way;
		if (s.bsdf.kind != MATERIAL_GLASS || ways.reflectance >= 1 || k == GLASS_MAX)
			return (struct passage){.open = false};
		p.bent |= !bsdf_is_pane(&s.bsdf);
		p.passed = rgb_mul(rgb_scale(p.passed, 1 - ways.reflectance), s.bsdf.colour);
		p.mirrored += (1 - p.mirrored) * ways.reflectance;
		p.sky = ways.passed;
		origin = surface_leave(&s, p.sky);
	}
	return far < INFINITY || p.sky.z >= 0 ? p : (struct passage){.open = false};
}

struct passage world_passage(const struct world *world, enum presence presence, struct v3 origin,
			     struct v3 direction, float far)
{
	const bool glass = world->glass[presence];

	if (scene_blocks(glass ? world->solid[presence] : world->scene[presence], origin, direction,
			 far))
		return (struct passage){.open = false};
	if (!glass)
		return (struct passage){.open = true, .sky = direction, .passed = {{1, 1, 1}}};
	return world_through_glass(world, presence, origin, direction, far);
}

/* ---- many rays ---- */

/* Sets the result of those rays that meet the scene and were not blocked so far. */
static void occlude_batch(RTCScene scene, struct v3 origin, struct ray_batch *batch,
			  enum ray_result result)
{
	struct RTCRay16 r __attribute__((aligned(64)));
	int valid[PACKET] __attribute__((aligned(64)));

	memset(&r, 0, sizeof(r));
	for (int k = 0; k < PACKET; k++) {
		r.org_x[k] = origin.x;
		r.org_y[k] = origin.y;
		r.org_z[k] = origin.z;
		r.mask[k] = ~0u;
	}
	for (int first = 0; first < batch->count; first += PACKET) {
		const int n = batch->count - first < PACKET ? batch->count - first : PACKET;

		for (int k = 0; k < PACKET; k++) {
			valid[k] = k < n && !batch->blocked[first + k] ? -1 : 0;
			r.tfar[k] = INFINITY;
		}
		memcpy(r.dir_x, batch->x + first, (size_t)n * sizeof(float));
		memcpy(r.dir_y, batch->y + first, (size_t)n * sizeof(float));
		memcpy(r.dir_z, batch->z + first, (size_t)n * sizeof(float));
		embree_occlude_packet(valid, scene, &r);
		for (int k = 0; k < n; k++)
			if (r.tfar[k] < 0)
				batch->blocked[first + k] = (uint8_t)result;
	}
}

void world_occluded(const struct world *world, enum presence presence, struct v3 origin,
		    struct ray_batch *batch)
{
	memset(batch->blocked, 0, (size_t)batch->count);
	if (world->bounds[presence].radius < 0)
		return;
	if (!world->glass[presence]) {
		occlude_batch(world->scene[presence], origin, batch, RAY_BLOCKED);
		return;
	}
	occlude_batch(world->solid[presence], origin, batch, RAY_BLOCKED);
	occlude_batch(world->glass[presence], origin, batch, RAY_GLASS);
}

int ray_batch_create(struct ray_batch *batch)
{
	*batch = (struct ray_batch){
		.x = malloc(WORLD_RAYS_MAX * sizeof(float)),
		.y = malloc(WORLD_RAYS_MAX * sizeof(float)),
		.z = malloc(WORLD_RAYS_MAX * sizeof(float)),
		.blocked = malloc(WORLD_RAYS_MAX),
	};
	if (batch->x && batch->y && batch->z && batch->blocked)
		return 0;
	ray_batch_free(batch);
	return -ENOMEM;
}

void ray_batch_free(struct ray_batch *batch)
{
	free(batch->x);
	free(batch->y);
	free(batch->z);
	free(batch->blocked);
	*batch = (struct ray_batch){.count = 0};
}

void world_destroy(struct world *world)
{
	if (!world)
		return;
	for (int k = 0; k < PRESENCE_COUNT; k++) {
		rtcReleaseScene(world->scene[k]);
		if (world->glass[k])
			rtcReleaseScene(world->glass[k]);
		if (world->solid[k])
			rtcReleaseScene(world->solid[k]);
	}
	rtcReleaseDevice(world->device);
	free(world->instances);
	free(world);
}
