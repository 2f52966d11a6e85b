/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <stddef.h>
#include <string.h>
#include <xf86drm.h>

/* Traits of a property: the card need not have it; its value is the id of a blob. */
enum { OPTIONAL = 1, BLOB = 2 };

/* A property: its object, its name, and where its id and value are kept. */
struct property_row {
	uint32_t kind; /* DRM_MODE_OBJECT_... */
	const char *name;
	size_t id, value; /* offsets in struct kms_properties and struct kms_state */
	unsigned traits;
};

#define ROW(kind, name, field, traits)                                                             \
	{                                                                                          \
		DRM_MODE_OBJECT_##kind, name, offsetof(struct kms_properties, field),              \
			offsetof(struct kms_state, field), traits                                  \
	}

static const struct property_row rows[] = {
	ROW(CONNECTOR, "CRTC_ID", connector_crtc, 0),
	ROW(CONNECTOR, "link-status", connector_link, OPTIONAL),
	ROW(CONNECTOR, "Broadcast RGB", connector_range, OPTIONAL),
	ROW(CRTC, "ACTIVE", crtc_active, 0),
	ROW(CRTC, "MODE_ID", crtc_mode, BLOB),
	ROW(CRTC, "DEGAMMA_LUT", crtc_degamma, OPTIONAL | BLOB),
	ROW(CRTC, "CTM", crtc_matrix, OPTIONAL | BLOB),
	ROW(CRTC, "GAMMA_LUT", crtc_gamma, OPTIONAL | BLOB),
	ROW(PLANE, "FB_ID", plane_fb, 0),
	ROW(PLANE, "CRTC_ID", plane_crtc, 0),
	ROW(PLANE, "SRC_X", plane_source[0], 0),
	ROW(PLANE, "SRC_Y", plane_source[1], 0),
	ROW(PLANE, "SRC_W", plane_source[2], 0),
	ROW(PLANE, "SRC_H", plane_source[3], 0),
	ROW(PLANE, "CRTC_X", plane_target[0], 0),
	ROW(PLANE, "CRTC_Y", plane_target[1], 0),
	ROW(PLANE, "CRTC_W", plane_target[2], 0),
	ROW(PLANE, "CRTC_H", plane_target[3], 0),
};

#define ROWS (sizeof(rows) / sizeof(rows[0]))

static uint32_t object_of(const struct kms_path *path, uint32_t kind)
{
	return kind == DRM_MODE_OBJECT_CONNECTOR ? path->connector
	       : kind == DRM_MODE_OBJECT_CRTC	 ? path->crtc
						 : path->plane;
}

static bool find_property(int card, const drmModeObjectProperties *list, const char *name,
			  uint32_t *id, uint64_t *value)
{
	bool found = false;

	for (uint32_t i = 0; i < list->count_props && !found; i++) {
		drmModePropertyRes *property = drmModeGetProperty(card, list->props[i]);

		found = property && !strcmp(property->name, name);
		if (found) {
			*id = list->props[i];
			*value = list->prop_values[i];
		}
		drmModeFreeProperty(property);
	}
	return found;
}

static int copy_blob(int card, uint64_t *blob)
{
	drmModePropertyBlobRes *old = *blob ? drmModeGetPropertyBlob(card, (uint32_t)*blob) : NULL;
	uint32_t copy = 0;
	int err = 0;

	if (old)
		err = drmModeCreatePropertyBlob(card, old->data, old->length, &copy);
	drmModeFreePropertyBlob(old);
	*blob = err ? 0 : copy;
	return err;
}

static void find_covers(const struct kms_path *path, struct kms_state *state)
{
	drmModePlaneRes *planes = drmModeGetPlaneResources(path->card);

	state->cover_count = 0;
	for (uint32_t i = 0; planes && i < planes->count_planes; i++) {
		drmModePlane *plane = drmModeGetPlane(path->card, planes->planes[i]);

		if (plane && plane->plane_id != path->plane && plane->crtc_id == path->crtc &&
		    state->cover_count < KMS_COVERS_MAX)
			state->covers[state->cover_count++] = (struct kms_cover){plane->plane_id,
										 plane->fb_id};
		drmModeFreePlane(plane);
	}
	drmModeFreePlaneResources(planes);
}

void kms_state_uncover(const struct kms_path *path, struct kms_state *state)
{
	find_covers(path, state);
	for (int i = 0; i < state->cover_count; i++)
		state->covers[i].fb = 0;
}

static int property_read(const struct kms_path *path, const struct property_row *row,
			 struct kms_properties *properties, struct kms_state *state,
			 struct fault *fault)
{
	uint32_t *id = (uint32_t *)((char *)properties + row->id);
	uint64_t *value = (uint64_t *)((char *)state + row->value);
	drmModeObjectProperties *list =
		drmModeObjectGetProperties(path->card, object_of(path, row->kind), row->kind);
	const bool found = list && find_property(path->card, list, row->name, id, value);
	int err;

	drmModeFreeObjectProperties(list);
	if (!found && !(row->traits & OPTIONAL))
		return fault_say(fault, -ENOTSUP, "kms display: %s: the card has no property %s",
				 path->connector_name, row->name);
	err = row->traits & BLOB ? copy_blob(path->card, value) : 0;
	return err ? fault_say(fault, err, "kms display: cannot keep the present %s: %s", row->name,
			       strerror(-err))
		   : 0;
}

int kms_state_read(const struct kms_path *path, struct kms_properties *properties,
		   struct kms_state *state, struct fault *fault)
{
	int err = 0;

	for (size_t i = 0; i < ROWS && !err; i++)
		err = property_read(path, &rows[i], properties, state, fault);
	/* Only GOOD can be set; BAD is the kernel's report of a failed link. */
	state->connector_link = DRM_MODE_LINK_STATUS_GOOD;
	find_covers(path, state);
	return err;
}

void kms_state_forget(int card, const struct kms_state *state)
{
	for (size_t i = 0; i < ROWS; i++) {
		const uint64_t value = *(const uint64_t *)((const char *)state + rows[i].value);

		if (rows[i].traits & BLOB && value)
			drmModeDestroyPropertyBlob(card, (uint32_t)value);
	}
}

static int request_add(drmModeAtomicReq *request, uint32_t object, uint32_t id, uint64_t value)
{
	const int added = drmModeAtomicAddProperty(request, object, id, value);

	return added < 0 ? added : 0;
}

int kms_state_commit(const struct kms_path *path, const struct kms_properties *properties,
		     const struct kms_state *state, uint32_t flags)
{
	drmModeAtomicReq *request = drmModeAtomicAlloc();
	int err = request ? 0 : -ENOMEM;

	/* After the first failure nothing is added or committed. */
	for (size_t i = 0; i < ROWS && !err; i++) {
		const uint32_t id = *(const uint32_t *)((const char *)properties + rows[i].id);
		const uint64_t value = *(const uint64_t *)((const char *)state + rows[i].value);
		if (id)
			err = request_add(request, object_of(path, rows[i].kind), id, value);
	}
	/* All planes share the ids of these two properties. */
	for (int i = 0; i < state->cover_count && !err; i++) {
		const struct kms_cover *cover = &state->covers[i];

		err = request_add(request, cover->plane, properties->plane_fb, cover->fb);
		if (!err)
			err = request_add(request, cover->plane, properties->plane_crtc,
					  cover->fb ? path->crtc : 0);
	}
	if (!err)
		err = drmModeAtomicCommit(path->card, request, flags, NULL);
	drmModeAtomicFree(request);
	return err;
}

enum { FLIP_SCREENS = 2, FLIP_PROPERTIES = 9 };

static void flip_fill(const struct kms_flip *flip, uint32_t *ids, uint64_t *values)
{
	ids[0] = flip->properties->plane_fb;
	values[0] = flip->state->plane_fb;
	for (int i = 0; i < 4; i++) {
		ids[1 + i] = flip->properties->plane_source[i];
		ids[5 + i] = flip->properties->plane_target[i];
		values[1 + i] = flip->state->plane_source[i];
		values[5 + i] = flip->state->plane_target[i];
	}
}

/* Fills in the ioctl itself: drmModeAtomicCommit() allocates. */
int kms_state_flip(const struct kms_flip *flips, int count, void *user)
{
	uint32_t objects[FLIP_SCREENS];
	uint32_t counts[FLIP_SCREENS] = {FLIP_PROPERTIES, FLIP_PROPERTIES};
	uint32_t ids[FLIP_SCREENS * FLIP_PROPERTIES];
	uint64_t values[FLIP_SCREENS * FLIP_PROPERTIES];
	struct drm_mode_atomic atomic = {
		.flags = DRM_MODE_PAGE_FLIP_EVENT | DRM_MODE_ATOMIC_NONBLOCK,
		.count_objs = (uint32_t)count,
		.objs_ptr = (uintptr_t)objects,
		.count_props_ptr = (uintptr_t)counts,
		.props_ptr = (uintptr_t)ids,
		.prop_values_ptr = (uintptr_t)values,
		.user_data = (uintptr_t)user,
	};

	for (int i = 0; i < count; i++) {
		objects[i] = flips[i].path->plane;
		flip_fill(&flips[i], ids + (size_t)i * FLIP_PROPERTIES,
			  values + (size_t)i * FLIP_PROPERTIES);
	}
	return drmIoctl(flips->path->card, DRM_IOCTL_MODE_ATOMIC, &atomic) ? -errno : 0;
}
