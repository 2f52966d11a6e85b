/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xf86drm.h>

int kms_card_open(const char *path)
{
	const int card = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);

	return card < 0 ? -errno : card;
}

void kms_connector_name(const drmModeConnector *connector, char *name, size_t room)
{
	const char *type = drmModeGetConnectorTypeName(connector->connector_type);

	snprintf(name, room, "%s-%u", type ? type : "Unknown", connector->connector_type_id);
}

/* Whether no other connector uses the CRTC. */
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

/* Returns a primary plane of this CRTC that accepts XRGB8888; 0: none. */
static uint32_t find_plane(int card, int crtc_index, uint32_t taken)
{
	drmModePlaneRes *planes = drmModeGetPlaneResources(card);
	uint32_t found = 0;

	for (uint32_t i = 0; planes && i < planes->count_planes && !found; i++) {
		drmModePlane *plane = drmModeGetPlane(card, planes->planes[i]);
		bool takes = false;

		for (uint32_t k = 0; plane && k < plane->count_formats; k++)
			takes |= plane->formats[k] == DRM_FORMAT_XRGB8888;
		if (takes && plane->plane_id != taken && plane->possible_crtcs & 1U << crtc_index &&
		    is_primary(card, plane->plane_id))
			found = plane->plane_id;
		drmModeFreePlane(plane);
	}
	drmModeFreePlaneResources(planes);
	return found;
}

/* Returns the CRTC that drives the connector now; 0: none. */
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

	/* First round: the CRTC that drives the connector already. Second: any free one. */
	for (int round = 0; round < 2; round++)
		for (int i = 0; i < resources->count_crtcs; i++) {
			const uint32_t crtc = resources->crtcs[i];

			if ((round == 0) != (crtc == present) || !(possible & 1U << i) ||
			    crtc == path->taken_crtc ||
			    !crtc_is_free(path->card, resources, crtc, connector->connector_id))
				continue;
			path->plane = find_plane(path->card, i, path->taken_plane);
			path->crtc = crtc;
			if (path->plane)
				return true;
		}
	return false;
}

static int say_no_mode(const struct display_settings *settings, const struct kms_options *options,
		       const drmModeConnector *connector, const struct kms_path *path,
		       struct fault *fault)
{
	char sizes[256] = "", asked[32];
	size_t used = 0;

	if (options->mode[0])
		return fault_say(
			fault, -EINVAL,
			"kms.mode: is \"%s\", expected a size and rate as in 1920x1080@60, or a modeline (clock and eight numbers, as cvt prints it)",
			options->mode);
	for (int i = 0; i < connector->count_modes && used < sizeof(sizes) - 24; i++) {
		const drmModeModeInfo *mode = &connector->modes[i];

		if (i && mode->hdisplay == mode[-1].hdisplay && mode->vdisplay == mode[-1].vdisplay)
			continue;
		used += (size_t)snprintf(sizes + used, sizeof(sizes) - used, "%s%ux%u",
					 used ? ", " : "", mode->hdisplay, mode->vdisplay);
	}
	if (!connector->count_modes)
		return fault_say(
			fault, -EINVAL,
			"kms display: %s has a screen that offers no modes; kms.mode can say one",
			path->connector_name);
	snprintf(asked, sizeof(asked), settings->width ? "%dx" : "any x ", settings->width);
	used = strlen(asked);
	snprintf(asked + used, sizeof(asked) - used, settings->height ? "%d" : "any",
		 settings->height);
	return fault_say(
		fault, -EINVAL,
		"kms display: %s has no progressive mode of %s, expected one of %s (or kms.mode)",
		path->connector_name, asked, sizes);
}

static int use_connector(const struct display_settings *settings, const struct kms_options *options,
			 const drmModeRes *resources, const drmModeConnector *connector,
			 struct kms_path *path, struct fault *fault)
{
	const int err = kms_mode_pick(settings, options, connector->connection, connector->modes,
				      connector->count_modes, &path->mode, &path->computed);

	if (err)
		return say_no_mode(settings, options, connector, path, fault);
	if (!find_crtc(resources, connector, path))
		return fault_say(fault, -ENOTSUP,
				 "kms display: no free CRTC and primary plane of %s takes XRGB8888",
				 path->connector_name);
	return 0;
}

static int say_no_screen(const char *wanted, bool named, const char *device, struct fault *fault)
{
	if (!*wanted)
		return fault_say(fault, -ENOLINK, "kms display: no screen is connected to %s",
				 device);
	if (!named)
		return fault_say(fault, -ENODEV,
				 "kms display: %s has no connector %s (inlay devices lists them)",
				 device, wanted);
	return fault_say(fault, -ENOLINK, "kms display: no screen is connected to %s of %s", wanted,
			 device);
}

/* Only the search for the best rank, which comes first, has the kernel ask the screen itself: that
 * takes tens of milliseconds. The later searches use what the kernel then knows. */
static drmModeConnector *ask_connector(int card, uint32_t connector, int rank)
{
	return rank == KMS_RANK_BEST ? drmModeGetConnector(card, connector)
				     : drmModeGetConnectorCurrent(card, connector);
}

/* Searches an open card for the wanted connector, or else for the first connector, of this rank. */
static int search_card(const struct display_settings *settings, const struct kms_options *options,
		       int rank, struct kms_path *path, struct fault *fault)
{
	drmModeRes *resources = drmModeGetResources(path->card);
	const char *wanted = options->connector;
	bool named = false;
	int err = -ENOLINK;

	if (!resources)
		return fault_say(fault, -ENODEV, "kms display: %s drives no screens", path->device);
	for (int i = 0; i < resources->count_connectors && err == -ENOLINK; i++) {
		drmModeConnector *connector = ask_connector(path->card, resources->connectors[i],
							    rank);

		if (!connector)
			continue;
		kms_connector_name(connector, path->connector_name, sizeof(path->connector_name));
		if (connector->connector_id != path->taken_connector &&
		    (!*wanted || !strcmp(wanted, path->connector_name))) {
			named = *wanted;
			path->connector = connector->connector_id;
			if (kms_mode_rank(connector->connection, connector->count_modes, options) ==
			    rank)
				err = use_connector(settings, options, resources, connector, path,
						    fault);
		}
		drmModeFreeConnector(connector);
	}
	drmModeFreeResources(resources);
	return err == -ENOLINK ? say_no_screen(wanted, named, path->device, fault) : err;
}

void kms_card_remedy(const char *device, char *text, size_t room)
{
	struct stat node;
	const struct group *group = stat(device, &node) ? NULL : getgrgid(node.st_gid);

	snprintf(text, room, " (is the user in the group \"%s\"?)",
		 group ? group->gr_name : "video");
}

static int try_card(const struct display_settings *settings, const struct kms_options *options,
		    const char *device, int rank, struct kms_path *path, struct fault *fault)
{
	uint64_t dumb = 0;
	int err;

	snprintf(path->device, sizeof(path->device), "%.63s", device);
	path->card = kms_card_open(device);
	if (path->card < 0) {
		char remedy[96] = "";

		err = path->card;
		if (err == -EACCES)
			kms_card_remedy(device, remedy, sizeof(remedy));
		return fault_say(fault, err, "kms display: cannot open %s: %s%s", device,
				 strerror(-err), remedy);
	}
	if (drmGetCap(path->card, DRM_CAP_DUMB_BUFFER, &dumb) || !dumb)
		err = fault_say(
			fault, -ENOTSUP,
			"kms display: %s is not a graphics card with simple (dumb) framebuffers",
			device);
	else if (drmSetClientCap(path->card, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1) ||
		 drmSetClientCap(path->card, DRM_CLIENT_CAP_ATOMIC, 1))
		err = fault_say(
			fault, -ENOTSUP,
			"kms display: the driver of %s is of the old kind without atomic modesetting, which is needed",
			device);
	else
		err = search_card(settings, options, rank, path, fault);
	if (err) {
		close(path->card);
		path->card = -1;
	}
	return err;
}

/* Orders the faults of several cards. The one of the greatest weight is reported: on that card the
 * search came furthest. */
static int fault_weight(int err)
{
	switch (err) {
	case 0:
	case -ENOENT:
		return 0;
	case -ENODEV:
		return 1;
	case -ENOTSUP:
		return 2;
	case -ENOLINK:
		return 3;
	default:
		return 4;
	}
}

/* Searches all cards, or the one that the settings name, for a connector of this rank. */
static int find_ranked(const struct display_settings *settings, const struct kms_options *options,
		       int rank, struct kms_path *path, struct fault *fault)
{
	int err = 0;

	if (settings->device[0])
		return try_card(settings, options, settings->device, rank, path, fault);
	for (int i = 0; i < KMS_CARDS; i++) {
		struct fault trouble = {0};
		char device[32];
		int trial;

		snprintf(device, sizeof(device), "/dev/dri/card%d", i);
		trial = try_card(settings, options, device, rank, path, &trouble);
		if (!trial)
			return 0;
		if (fault_weight(trial) > fault_weight(err))
			err = fault_say(fault, trial, "%s", trouble.text);
	}
	return err ? err
		   : fault_say(
			     fault, -ENODEV,
			     "kms display: no graphics card found, expected one as /dev/dri/card0 (is its driver loaded?)");
}

int kms_find_second(const struct kms_options *options, const struct kms_path *first,
		    struct kms_path *path, struct fault *fault)
{
	struct display_settings same = {.width = first->mode.hdisplay,
					.height = first->mode.vdisplay,
					.rate_hz = kms_mode_rate(&first->mode)};
	const struct display_settings any = {.rate_hz = same.rate_hz};
	struct kms_options other = {0};
	int err;

	/* Whichever of the two is there when the display is opened is the first. */
	snprintf(other.connector, sizeof(other.connector), "%s",
		 strcmp(first->connector_name, options->second) ? options->second
								: options->connector);
	*path = (struct kms_path){.card = first->card,
				  .taken_connector = first->connector,
				  .taken_crtc = first->crtc,
				  .taken_plane = first->plane};
	memcpy(path->device, first->device, sizeof(path->device));
	err = search_card(&same, &other, KMS_RANK_BEST, path, fault);
	return err == -EINVAL ? search_card(&any, &other, KMS_RANK_BEST, path, fault) : err;
}

static int find_one(const struct display_settings *settings, const struct kms_options *options,
		    struct kms_path *path, struct fault *fault)
{
	const int least = options->force ? 1 : 2;
	int err = -ENOLINK;

	for (int rank = KMS_RANK_BEST; rank >= least && err == -ENOLINK; rank--)
		err = find_ranked(settings, options, rank, path, fault);
	return err ? err : path->card;
}

int kms_find(const struct display_settings *settings, const struct kms_options *options,
	     struct kms_path *path, struct fault *fault)
{
	struct kms_options second = *options;
	int err = find_one(settings, options, path, fault);

	if (err != -ENOLINK || !options->second[0])
		return err;
	memcpy(second.connector, options->second, sizeof(second.connector));
	err = find_one(settings, &second, path, fault);
	return err == -ENOLINK
		       ? fault_say(fault, err, "kms display: no screen is connected to %s or %s",
				   options->connector[0] ? options->connector : "another connector",
				   options->second)
		       : err;
}
