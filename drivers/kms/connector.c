/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>
#include <xf86drm.h>

#include "drivers/kms/kms.h"

#define PROPERTIES_MAX 64 /* the kernel's own limit for an object */

static bool has_failed(const struct kms_connector *connector, const uint32_t *ids,
		       const uint64_t *values, uint32_t count)
{
	for (uint32_t i = 0; i < count && i < PROPERTIES_MAX && connector->link_property; i++)
		if (ids[i] == connector->link_property)
			return values[i] == DRM_MODE_LINK_STATUS_BAD;
	return false;
}

/* Uses ioctl() rather than libdrm's drmModeGetConnector(), which allocates: this runs while
 * pictures flow. */
int kms_connector_read(int card, uint32_t id, bool probe, struct kms_connector *connector)
{
	struct drm_mode_get_connector get = {.connector_id = id};
	uint32_t ids[PROPERTIES_MAX];
	uint64_t values[PROPERTIES_MAX];

	connector->id = id;
	/* The kernel probes the screen if a request has no room for modes. */
	if (probe && drmIoctl(card, DRM_IOCTL_MODE_GETCONNECTOR, &get))
		return -errno;
	get = (struct drm_mode_get_connector){
		.connector_id = id,
		.count_modes = KMS_MODES_MAX,
		.modes_ptr = (uintptr_t)connector->modes,
		.count_props = PROPERTIES_MAX,
		.props_ptr = (uintptr_t)ids,
		.prop_values_ptr = (uintptr_t)values,
	};
	if (drmIoctl(card, DRM_IOCTL_MODE_GETCONNECTOR, &get))
		return -errno;
	connector->connection = get.connection;
	connector->link_failed = has_failed(connector, ids, values, get.count_props);
	/* If there are more modes than room, the kernel fills in none. */
	if (get.count_modes > KMS_MODES_MAX)
		return -E2BIG;
	connector->count = (int)get.count_modes;
	return 0;
}

/* A panel whose right side is up is turned clockwise when it is looked at upright, and so has to be
 * the picture. */
static const struct {
	const char *name;
	enum picture_turn turn;
} orientations[] = {
	{"Upside Down", PICTURE_TURN_180},
	{"Left Side Up", PICTURE_TURN_270},
	{"Right Side Up", PICTURE_TURN_90},
};

static enum picture_turn turn_of(const drmModePropertyRes *property, uint64_t value)
{
	for (int i = 0; i < property->count_enums; i++)
		for (size_t k = 0; k < sizeof(orientations) / sizeof(*orientations); k++)
			if (property->enums[i].value == value &&
			    !strcmp(property->enums[i].name, orientations[k].name))
				return orientations[k].turn;
	return PICTURE_UPRIGHT;
}

enum picture_turn kms_panel_turn(const struct kms_path *path)
{
	drmModeObjectProperties *list = drmModeObjectGetProperties(path->card, path->connector,
								   DRM_MODE_OBJECT_CONNECTOR);
	enum picture_turn turn = PICTURE_UPRIGHT;

	for (uint32_t i = 0; list && i < list->count_props; i++) {
		drmModePropertyRes *property = drmModeGetProperty(path->card, list->props[i]);

		if (property && !strcmp(property->name, "panel orientation"))
			turn = turn_of(property, list->prop_values[i]);
		drmModeFreeProperty(property);
	}
	drmModeFreeObjectProperties(list);
	return turn;
}

int kms_panel_value(int card, uint32_t id, const char *name, uint64_t *value)
{
	drmModePropertyRes *property = drmModeGetProperty(card, id);
	int err = -ENOENT;

	for (int i = 0; property && i < property->count_enums; i++)
		if (!strcmp(property->enums[i].name, name)) {
			*value = property->enums[i].value;
			err = 0;
		}
	drmModeFreeProperty(property);
	return err;
}

const char *kms_range_name(enum kms_range range)
{
	static const char *const names[] = {
		[KMS_RANGE_AUTO] = "Automatic",
		[KMS_RANGE_FULL] = "Full",
		[KMS_RANGE_LIMITED] = "Limited 16:235",
	};

	return names[range];
}
