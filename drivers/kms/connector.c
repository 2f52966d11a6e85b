#include <errno.h>

#include "drivers/kms/kms.h"

/* Not with libdrm's drmModeGetConnector(), which allocates: this is asked while pictures flow. */
int kms_connector_read(int card, uint32_t id, bool probe, struct kms_connector *connector)
{
	struct drm_mode_get_connector get = {.connector_id = id};

	connector->id = id;
	/* To the kernel, no room for modes is the wish to probe. */
	if (probe && drmIoctl(card, DRM_IOCTL_MODE_GETCONNECTOR, &get))
		return -errno;
	get = (struct drm_mode_get_connector){
		.connector_id = id,
		.count_modes = KMS_MODES_MAX,
		.modes_ptr = (uintptr_t)connector->modes,
	};
	if (drmIoctl(card, DRM_IOCTL_MODE_GETCONNECTOR, &get))
		return -errno;
	connector->connection = get.connection;
	/* More than there is room for are not given at all. */
	if (get.count_modes > KMS_MODES_MAX)
		return -E2BIG;
	connector->count = (int)get.count_modes;
	return 0;
}
