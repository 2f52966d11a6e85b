/* SPDX-License-Identifier: MIT */
/* Which of the machine's cameras is meant. */
#ifndef INLAY_DRIVERS_V4L2_FIND_H
#define INLAY_DRIVERS_V4L2_FIND_H

#include <linux/videodev2.h>
#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

enum { V4L2_DEVICES_MAX = 256, V4L2_PORT_MAX = 32 };

/*
 * Opens the camera called name: a path (it begins with /); a link's name in /dev/v4l/by-id or
 * /dev/v4l/by-path; what the driver calls the card or the bus ("usb-0000:00:14.0-2"); a USB port
 * ("1-2"); empty: the first that captures. All but a path stay when numbers move. path gets its
 * node. Looked for anew at each call. Several cards of one name: the first, and a message says
 * which the others are. A descriptor or -errno, as device_open().
 */
int v4l2_find(const char *name, char path[INI_PATH_MAX], struct v4l2_capability *capability,
	      struct fault *fault);

/* "1-2.4", the port, from "1-2.4:1.0", the name of a USB device's interface. */
bool v4l2_usb_port(const char *interface, char port[V4L2_PORT_MAX]);

/* The port that /dev/videoN hangs on; false: not on USB. */
bool v4l2_port_of_node(int number, char port[V4L2_PORT_MAX]);

#endif
