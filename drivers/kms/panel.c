/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <string.h>
#include <xf86drm.h>

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
