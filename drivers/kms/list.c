/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include <xf86drm.h>

#include "hal/device/node_link.h"

static int list_room(int card, const drmModeRes *resources)
{
	int lines = 0;

	for (int i = 0; i < resources->count_connectors; i++) {
		drmModeConnector *connector = drmModeGetConnector(card, resources->connectors[i]);

		lines += connector ? 1 + connector->count_modes : 0;
		drmModeFreeConnector(connector);
	}
	return lines;
}

static void list_connector(const drmModeConnector *connector, struct display_listing *listing,
			   int room)
{
	static const char *const states[] = {"", "connected", "disconnected", "unknown"};
	char name[32];

	if (listing->line_count >= room)
		return;
	kms_connector_name(connector, name, sizeof(name));
	snprintf(listing->lines[listing->line_count++], sizeof(listing->lines[0]), "%s: %s", name,
		 states[connector->connection & 3]);
	for (int i = 0; i < connector->count_modes && listing->line_count < room; i++) {
		const drmModeModeInfo *mode = &connector->modes[i];

		snprintf(listing->lines[listing->line_count++], sizeof(listing->lines[0]),
			 "  %ux%u%s %.2f Hz%s", mode->hdisplay, mode->vdisplay,
			 mode->flags & DRM_MODE_FLAG_INTERLACE ? "i" : "", kms_mode_rate(mode),
			 mode->type & DRM_MODE_TYPE_PREFERRED ? " (preferred)" : "");
	}
}

static int list_card(int card, struct display_listing *listing,
		     void (*found)(void *context, const struct display_listing *listing),
		     void *context)
{
	drmModeRes *resources = drmModeGetResources(card);
	drmVersion *version = drmGetVersion(card);
	const int room = 1 + (resources ? list_room(card, resources) : 0);
	char link[128]; /* a line with "link " before it */
	int err = 0;

	snprintf(listing->name, sizeof(listing->name), "%s", version ? version->name : "unknown");
	listing->lines = calloc((size_t)room, sizeof(*listing->lines));
	if (!listing->lines)
		err = -ENOMEM;
	else if (node_link("/dev/dri/by-path", listing->device, link, sizeof(link)))
		snprintf(listing->lines[listing->line_count++], sizeof(listing->lines[0]),
			 "link %s", link);
	for (int i = 0; resources && i < resources->count_connectors && !err; i++) {
		drmModeConnector *connector = drmModeGetConnector(card, resources->connectors[i]);

		if (connector)
			list_connector(connector, listing, room);
		drmModeFreeConnector(connector);
	}
	if (resources && !err)
		found(context, listing);
	free(listing->lines);
	drmFreeVersion(version);
	drmModeFreeResources(resources);
	return err ? err : resources != NULL;
}

/* Lists a card that this user may not open, with advice. */
static void list_forbidden(struct display_listing *listing,
			   void (*found)(void *context, const struct display_listing *listing),
			   void *context)
{
	char line[1][160], remedy[96];

	kms_card_remedy(listing->device, remedy, sizeof(remedy));
	snprintf(line[0], sizeof(line[0]), "cannot be opened%s", remedy);

	snprintf(listing->name, sizeof(listing->name), "no permission");
	listing->lines = line;
	listing->line_count = 1;
	found(context, listing);
}

int kms_list(void (*found)(void *context, const struct display_listing *listing), void *context)
{
	int count = 0;

	for (int i = 0; i < KMS_CARDS; i++) {
		struct display_listing listing = {0};
		int card, listed;

		snprintf(listing.device, sizeof(listing.device), "/dev/dri/card%d", i);
		card = kms_card_open(listing.device);
		if (card == -EACCES) {
			list_forbidden(&listing, found, context);
			count++;
		}
		if (card < 0)
			continue;
		listed = list_card(card, &listing, found, context);
		close(card);
		if (listed < 0)
			return listed;
		count += listed;
	}
	return count;
}
