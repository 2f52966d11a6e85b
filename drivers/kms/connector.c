/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <xf86drm.h>

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
