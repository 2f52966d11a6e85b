/* SPDX-License-Identifier: MIT */
#include "app/kiosk/reload.h"

#include <string.h>

#include "hal/base/log.h"

#define NEXT_START 0

/* The first row that fits a key counts. key NULL: every key of the section, also drivers' keys. */
static const struct {
	const char *section, *key;
	unsigned effects;
} policy[] = {
	{"basis", "file", RELOAD_DRAWING}, /* the file itself: kiosk_reload.c */
	{"basis", "pose", RELOAD_POSE | RELOAD_DRAWING},
	{"poses", NULL, RELOAD_POSES | RELOAD_DRAWING},
	/* Views are fitted to the cameras when they open. */
	{"fisheye", "camera", NEXT_START},
	{"fisheye", "x", NEXT_START},
	{"fisheye", "y", NEXT_START},
	{"fisheye", "width", NEXT_START},
	{"fisheye", "height", NEXT_START},
	{"fisheye", "hflip", NEXT_START},
	{"fisheye", "vflip", NEXT_START},
	{"fisheye", "squash", NEXT_START},
	{"fisheye", "exposures", NEXT_START},
	{"fisheye", "exposure_control", NEXT_START},
	{"fisheye", "exposure_delay", NEXT_START},
	{"fisheye", "position", RELOAD_PIPELINE | RELOAD_DRAWING},
	{"fisheye", NULL, RELOAD_LIGHT | RELOAD_DRAWING},
	{"lamp", NULL, RELOAD_PIPELINE | RELOAD_DRAWING},
	{"background", "transfer", RELOAD_PIPELINE | RELOAD_DRAWING},
	{"background", "light", RELOAD_PIPELINE | RELOAD_DRAWING},
	{"background", "ground_patch", RELOAD_PIPELINE | RELOAD_DRAWING},
	{"background", "ground_reflectance", RELOAD_PIPELINE | RELOAD_DRAWING},
	{"depth", "unit", RELOAD_DRAWING},
	{"lights", "threshold", RELOAD_THRESHOLD | RELOAD_DRAWING},
	{"lights", "threshold_mode", RELOAD_PIPELINE | RELOAD_DRAWING},
	{"lights", "follow", RELOAD_PIPELINE},
	{"lights", NULL, RELOAD_DRAWING},
	/* The basis is opened with the layers that its mode needs. */
	{"composite", "mode", NEXT_START},
	{"composite", NULL, RELOAD_PIPELINE | RELOAD_DRAWING},
	{"people", NULL, RELOAD_PIPELINE | RELOAD_DRAWING},
	{"screen", "show", RELOAD_VIEW | RELOAD_DRAWING},
	{"screen", "split", RELOAD_SPLIT | RELOAD_DRAWING},
	{"screen", "information", RELOAD_INFORMATION | RELOAD_DRAWING},
	{"screen", "scale", RELOAD_DRAWING},
	{"screen", "trouble", RELOAD_DRAWING},
	{"screen", "blank_after", RELOAD_DRAWING},
	{"screen", "hours", RELOAD_HOURS},
	{"screen", "hours_off", RELOAD_HOURS},
	{"screen", "cec", RELOAD_HOURS},
	{"buttons", NULL, RELOAD_BUTTONS},
	{"control", NULL, RELOAD_CONTROL},
	{"state", NULL, RELOAD_STATE},
	{"metrics", NULL, RELOAD_DRAWING}, /* written anew in a few seconds */
};

static unsigned effects_of(const struct config_change *change)
{
	for (size_t i = 0; i < sizeof(policy) / sizeof(*policy); i++) {
		if (!strcmp(policy[i].section, change->section) &&
		    (!policy[i].key || !strcmp(policy[i].key, change->key)))
			return policy[i].effects;
	}
	return NEXT_START;
}

static bool note_effect(void *context, const struct config_change *change)
{
	unsigned effects = effects_of(change);

	*(unsigned *)context |= effects;
	if (!effects)
		log_warning("[%s%s%s]%s%s: takes effect at the next start", change->section,
			    change->instance ? " " : "", change->instance ? change->instance : "",
			    *change->key ? " " : "", change->key);
	return false;
}

unsigned reload_compare(struct config *config, const struct config *fresh)
{
	unsigned effects = 0;

	config_update(config, fresh, note_effect, &effects);
	return effects;
}

static bool is_changeable(void *context, const struct config_change *change)
{
	(void)context;
	return effects_of(change) != NEXT_START;
}

static bool is_kept(void *context, const struct config_change *change)
{
	return !is_changeable(context, change);
}

void reload_keep(struct config *fresh, const struct config *config)
{
	config_update(fresh, config, is_kept, NULL);
}

void reload_adopt(struct config *config, const struct config *fresh)
{
	config_update(config, fresh, is_changeable, NULL);
}
