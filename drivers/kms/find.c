#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/kms/kms.h"

#define CARDS 16

static int open_card(const char *path)
{
	const int card = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);

	return card < 0 ? -errno : card;
}

static void name_connector(const drmModeConnector *connector, char *name, size_t room)
{
	const char *type = drmModeGetConnectorTypeName(connector->connector_type);

	snprintf(name, room, "%s-%u", type ? type : "Unknown", connector->connector_type_id);
}

/* Another connector's CRTC is not taken away from it. */
static bool crtc_is_free(int card, const drmModeRes *resources, uint32_t crtc, uint32_t connector)
{
	bool busy = false;

	for (int i = 0; i < resources->count_connectors && !busy; i++) {
		drmModeConnector *other;
		drmModeEncoder *encoder;

		if (resources->connectors[i] == connector)
			continue;
		other = drmModeGetConnectorCurrent(card, resources->connectors[i]);
		encoder = other && other->encoder_id ? drmModeGetEncoder(card, other->encoder_id)
						     : NULL;
		busy = encoder && encoder->crtc_id == crtc;
		drmModeFreeEncoder(encoder);
		drmModeFreeConnector(other);
	}
	return !busy;
}

static bool is_primary(int card, uint32_t plane)
{
	drmModeObjectProperties *list = drmModeObjectGetProperties(card, plane,
								   DRM_MODE_OBJECT_PLANE);
	bool primary = false;

	for (uint32_t i = 0; list && i < list->count_props && !primary; i++) {
		drmModePropertyRes *property = drmModeGetProperty(card, list->props[i]);

		primary = property && !strcmp(property->name, "type") &&
			  list->prop_values[i] == DRM_PLANE_TYPE_PRIMARY;
		drmModeFreeProperty(property);
	}
	drmModeFreeObjectProperties(list);
	return primary;
}

/* A primary plane of this CRTC that takes XRGB8888; 0: none. */
static uint32_t find_plane(int card, int crtc_index)
{
	drmModePlaneRes *planes = drmModeGetPlaneResources(card);
	uint32_t found = 0;

	for (uint32_t i = 0; planes && i < planes->count_planes && !found; i++) {
		drmModePlane *plane = drmModeGetPlane(card, planes->planes[i]);
		bool takes = false;

		for (uint32_t k = 0; plane && k < plane->count_formats; k++)
			takes |= plane->formats[k] == DRM_FORMAT_XRGB8888;
		if (takes && plane->possible_crtcs & 1U << crtc_index &&
		    is_primary(card, plane->plane_id))
			found = plane->plane_id;
		drmModeFreePlane(plane);
	}
	drmModeFreePlaneResources(planes);
	return found;
}

/* The CRTC that drives the connector now, if any: 0. */
static uint32_t present_crtc(int card, const drmModeConnector *connector)
{
	drmModeEncoder *encoder = connector->encoder_id
					  ? drmModeGetEncoder(card, connector->encoder_id)
					  : NULL;
	const uint32_t crtc = encoder ? encoder->crtc_id : 0;

	drmModeFreeEncoder(encoder);
	return crtc;
}

static uint32_t possible_crtcs(int card, const drmModeConnector *connector)
{
	uint32_t mask = 0;

	for (int i = 0; i < connector->count_encoders; i++) {
		drmModeEncoder *encoder = drmModeGetEncoder(card, connector->encoders[i]);

		mask |= encoder ? encoder->possible_crtcs : 0;
		drmModeFreeEncoder(encoder);
	}
	return mask;
}

static bool find_crtc(const drmModeRes *resources, const drmModeConnector *connector,
		      struct kms_path *path)
{
	const uint32_t present = present_crtc(path->card, connector);
	const uint32_t possible = possible_crtcs(path->card, connector);

	/* First round: what is set up already; second round: anything free. */
	for (int round = 0; round < 2; round++)
		for (int i = 0; i < resources->count_crtcs; i++) {
			const uint32_t crtc = resources->crtcs[i];

			if ((round == 0) != (crtc == present) || !(possible & 1U << i) ||
			    !crtc_is_free(path->card, resources, crtc, connector->connector_id))
				continue;
			path->plane = find_plane(path->card, i);
			path->crtc = crtc;
			if (path->plane)
				return true;
		}
	return false;
}

static int say_no_mode(const struct display_settings *settings, const drmModeConnector *connector,
		       const struct kms_path *path, struct fault *fault)
{
	char sizes[256] = "", asked[32];
	size_t used = 0;

	for (int i = 0; i < connector->count_modes && used < sizeof(sizes) - 24; i++) {
		const drmModeModeInfo *mode = &connector->modes[i];

		if (i && mode->hdisplay == mode[-1].hdisplay && mode->vdisplay == mode[-1].vdisplay)
			continue;
		used += (size_t)snprintf(sizes + used, sizeof(sizes) - used, "%s%ux%u",
					 used ? ", " : "", mode->hdisplay, mode->vdisplay);
	}
	if (!connector->count_modes)
		return fault_say(fault, -EINVAL, "kms display: %s offers no modes",
				 path->connector_name);
	snprintf(asked, sizeof(asked), settings->width ? "%dx" : "any x ", settings->width);
	used = strlen(asked);
	snprintf(asked + used, sizeof(asked) - used, settings->height ? "%d" : "any",
		 settings->height);
	return fault_say(fault, -EINVAL,
			 "kms display: %s has no progressive mode of %s, expected one of %s",
			 path->connector_name, asked, sizes);
}

static int use_connector(const struct display_settings *settings, const drmModeRes *resources,
			 const drmModeConnector *connector, struct kms_path *path,
			 struct fault *fault)
{
	const int mode = kms_mode_choose(connector->modes, connector->count_modes, settings->width,
					 settings->height, settings->rate_hz);

	if (mode < 0)
		return say_no_mode(settings, connector, path, fault);
	path->connector = connector->connector_id;
	path->mode = connector->modes[mode];
	if (!find_crtc(resources, connector, path))
		return fault_say(fault, -ENOTSUP,
				 "kms display: no free CRTC and primary plane of %s takes XRGB8888",
				 path->connector_name);
	return 0;
}

/* The wanted connector of an open card, or its first with a screen. -ENODEV: there is none. */
static int search_card(const struct display_settings *settings, const char *wanted,
		       const char *device, struct kms_path *path, struct fault *fault)
{
	drmModeRes *resources = drmModeGetResources(path->card);
	int err = -ENODEV;

	if (!resources)
		return fault_say(fault, -ENODEV, "kms display: %s drives no screens", device);
	fault_say(fault, err,
		  *wanted ? "kms display: %s has no connector %s (inlay devices lists them)"
			  : "kms display: no screen is connected to %s%s",
		  device, wanted);
	for (int i = 0; i < resources->count_connectors && err == -ENODEV; i++) {
		drmModeConnector *connector = drmModeGetConnector(path->card,
								  resources->connectors[i]);

		if (!connector)
			continue;
		name_connector(connector, path->connector_name, sizeof(path->connector_name));
		/* Asked for by name, it is used even where the cable says nothing. */
		if (*wanted ? !strcmp(wanted, path->connector_name)
			    : connector->connection == DRM_MODE_CONNECTED)
			err = use_connector(settings, resources, connector, path, fault);
		drmModeFreeConnector(connector);
	}
	drmModeFreeResources(resources);
	return err;
}

static int try_card(const struct display_settings *settings, const char *wanted, const char *device,
		    struct kms_path *path, struct fault *fault)
{
	uint64_t dumb = 0;
	int err;

	snprintf(path->device, sizeof(path->device), "%.63s", device);
	path->card = open_card(device);
	if (path->card < 0) {
		err = path->card;
		return fault_say(fault, err, "kms display: cannot open %s: %s%s", device,
				 strerror(-err),
				 err == -EACCES ? " (is the user in the group \"video\"?)" : "");
	}
	if (drmGetCap(path->card, DRM_CAP_DUMB_BUFFER, &dumb) || !dumb)
		err = fault_say(fault, -ENOTSUP,
				"kms display: %s is not a graphics card with simple (dumb) "
				"framebuffers",
				device);
	else if (drmSetClientCap(path->card, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1) ||
		 drmSetClientCap(path->card, DRM_CLIENT_CAP_ATOMIC, 1))
		err = fault_say(fault, -ENOTSUP,
				"kms display: the driver of %s has no atomic modesetting", device);
	else
		err = search_card(settings, wanted, device, path, fault);
	if (err) {
		close(path->card);
		path->card = -1;
	}
	return err;
}

int kms_find(const struct display_settings *settings, const char *connector, struct kms_path *path,
	     struct fault *fault)
{
	int err = fault_say(fault, -ENODEV,
			    "kms display: no graphics card found, expected one as /dev/dri/card0 "
			    "(is its driver loaded?)");

	if (settings->device[0]) {
		err = try_card(settings, connector, settings->device, path, fault);
		return err ? err : path->card;
	}
	/* A card without a screen is passed over; the first other trouble is kept, to be told. */
	for (int i = 0; i < CARDS; i++) {
		struct fault trouble = {0};
		char device[32];
		int trial;

		snprintf(device, sizeof(device), "/dev/dri/card%d", i);
		trial = try_card(settings, connector, device, path, &trouble);
		if (!trial)
			return path->card;
		if (trial != -ENOENT && err == -ENODEV)
			err = fault_say(fault, trial, "%s", trouble.text);
	}
	return err;
}

/* ---- list ---- */

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
	name_connector(connector, name, sizeof(name));
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
	const int room = resources ? list_room(card, resources) : 0;
	int err = 0;

	snprintf(listing->name, sizeof(listing->name), "%s", version ? version->name : "unknown");
	listing->lines = calloc((size_t)room + 1, sizeof(*listing->lines));
	if (!listing->lines)
		err = -ENOMEM;
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

/* A card that is there but not for this user is listed too, with what to do about it. */
static void list_forbidden(struct display_listing *listing,
			   void (*found)(void *context, const struct display_listing *listing),
			   void *context)
{
	char line[1][160] = {"cannot be opened (is the user in the group \"video\"?)"};

	snprintf(listing->name, sizeof(listing->name), "no permission");
	listing->lines = line;
	listing->line_count = 1;
	found(context, listing);
}

int kms_list(void (*found)(void *context, const struct display_listing *listing), void *context)
{
	int count = 0;

	for (int i = 0; i < CARDS; i++) {
		struct display_listing listing = {0};
		int card, listed;

		snprintf(listing.device, sizeof(listing.device), "/dev/dri/card%d", i);
		card = open_card(listing.device);
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
