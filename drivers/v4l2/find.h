/* SPDX-License-Identifier: MIT */
/* Finds the camera that a name in the configuration means. */
#ifndef INLAY_DRIVERS_V4L2_FIND_H
#define INLAY_DRIVERS_V4L2_FIND_H

#include <linux/videodev2.h>
#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

enum { V4L2_DEVICES_MAX = 256, V4L2_PORT_MAX = 32 };

/*
 * Opens the camera of this name: a path (it begins with /); the name of a link in /dev/v4l/by-id or
 * /dev/v4l/by-path; the driver's name for the card or the bus ("usb-0000:00:14.0-2"); a USB port
 * ("1-2"); empty: the first node that captures. All forms but a path stay valid when the kernel
 * renumbers nodes; the search is made at each call. If several cards have the name, the first is
 * opened and the others are logged. A depth camera has several nodes: of those that the name fits,
 * one that offers depths (depth) or pictures goes before one that does not. path receives the node.
 * Returns a descriptor or -errno, as device_open().
 */
int v4l2_find(const char *name, bool depth, char path[INI_PATH_MAX],
	      struct v4l2_capability *capability, struct fault *fault);

/* Extracts the port, "1-2.4", from the name of a USB interface, "1-2.4:1.0". False: not such a
 * name. */
bool v4l2_usb_port(const char *interface, char port[V4L2_PORT_MAX]);

/* Finds the USB port of /dev/videoN. False: the device is not on USB. */
bool v4l2_port_of_node(int number, char port[V4L2_PORT_MAX]);

#endif
