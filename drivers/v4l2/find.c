/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/log.h"
#include "hal/device/camera.h"

bool v4l2_usb_port(const char *interface, char port[V4L2_PORT_MAX])
{
	const size_t length = strcspn(interface, ":");

	if (!isdigit((unsigned char)interface[0]) || interface[length] != ':' ||
	    length >= V4L2_PORT_MAX || strspn(interface, "0123456789-.") != length ||
	    !memchr(interface, '-', length))
		return false;
	memcpy(port, interface, length);
	port[length] = '\0';
	return true;
}

bool v4l2_port_of_node(int number, char port[V4L2_PORT_MAX])
{
	char link[64], target[PATH_MAX];
	const char *last;
	ssize_t length;

	snprintf(link, sizeof(link), "/sys/class/video4linux/video%d/device", number);
	length = readlink(link, target, sizeof(target) - 1);
	if (length < 0)
		return false;
	target[length] = '\0';
	last = strrchr(target, '/');
	return v4l2_usb_port(last ? last + 1 : target, port);
}

static bool find_link(const char *name, char path[INI_PATH_MAX])
{
	static const char *const folders[] = {"/dev/v4l/by-id", "/dev/v4l/by-path"};

	for (int i = 0; i < 2 && name[0] && !strchr(name, '/'); i++) {
		snprintf(path, INI_PATH_MAX, "%s/%s", folders[i], name);
		if (access(path, F_OK) == 0)
			return true;
	}
	return false;
}

static bool device_is_called(const struct v4l2_capability *capability, int number, const char *name)
{
	char port[V4L2_PORT_MAX], card[4 * sizeof(capability->card)];

	if (name[0] == '\0')
		return !device_is_part(capability);
	device_name(capability->card, card, sizeof(card));
	return strcmp((const char *)capability->bus_info, name) == 0 || strcmp(card, name) == 0 ||
	       (v4l2_port_of_node(number, port) && strcmp(port, name) == 0);
}

static int not_found(const char *name, struct fault *fault)
{
	if (name[0])
		return fault_say(
			fault, -ENODEV,
			"no camera \"%s\": expected /dev/videoN, a link in /dev/v4l, or a name, bus or USB port that `inlay devices` prints",
			name);
	return fault_say(fault, -ENODEV, "no camera found: expected a capturing /dev/video*");
}

/* A search over all nodes. */
struct camera_search {
	const char *name;
	bool depth;	      /* depths are wanted, or pictures */
	int fd;		      /* the first that matches, best one that has them; or -errno */
	bool suits;	      /* it has them */
	char others[512];     /* further matches, for the log */
	struct fault refusal; /* why a node could not be opened */
};

static void note_other(struct camera_search *s, const char *path, const char *bus)
{
	const size_t used = strlen(s->others);

	snprintf(s->others + used, sizeof(s->others) - used, "%s%s (%s)", used ? ", " : "", path,
		 bus);
}

/* Looks at one node. A device may have several nodes, for still pictures for example: a second
 * match on the same bus is not another camera. */
static void search_visit(struct camera_search *s, int number, char path[INI_PATH_MAX],
			 struct v4l2_capability *capability)
{
	struct v4l2_capability here;
	char node[32];
	struct fault why = {""};
	bool suits;
	int fd;

	snprintf(node, sizeof(node), "/dev/video%d", number);
	fd = device_open(node, &here, &why);
	if (fd < 0 && s->fd == -ENODEV && camera_situation_of(fd) == CAMERA_NO_PERMISSION) {
		/* This explains more than "not found" would. */
		s->fd = fd;
		s->refusal = why;
	}
	if (fd < 0)
		return;
	suits = v4l2_offers_kind(fd, device_buffer_type(&here), s->depth);
	if (!device_is_called(&here, number, s->name)) {
		close(fd);
	} else if (s->fd < 0 || (suits && !s->suits)) {
		if (s->fd >= 0)
			close(s->fd);
		s->fd = fd;
		s->suits = suits;
		*capability = here;
		snprintf(path, INI_PATH_MAX, "%s", node);
	} else {
		if (strcmp((char *)here.bus_info, (char *)capability->bus_info) != 0)
			note_other(s, node, (const char *)here.bus_info);
		close(fd);
	}
}

int v4l2_find(const char *name, bool depth, char path[INI_PATH_MAX],
	      struct v4l2_capability *capability, struct fault *fault)
{
	struct camera_search search = {.name = name, .depth = depth, .fd = -ENODEV};

	if (name[0] == '/') {
		snprintf(path, INI_PATH_MAX, "%s", name);
		return device_open(path, capability, fault);
	}
	if (find_link(name, path))
		return device_open(path, capability, fault);
	path[0] = '\0';
	for (int i = 0; i < V4L2_DEVICES_MAX && (!search.suits || name[0]); i++)
		search_visit(&search, i, path, capability);
	if (search.fd < 0 && search.refusal.text[0])
		return fault_say(fault, search.fd, "%s", search.refusal.text);
	if (search.fd < 0)
		return not_found(name, fault);
	if (search.others[0])
		log_info_paced(
			"%s: \"%s\" is also the name of %s; to choose one, write its bus as device",
			path, name, search.others);
	return search.fd;
}
