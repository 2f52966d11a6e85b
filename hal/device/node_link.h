/* SPDX-License-Identifier: MIT */
/* Names of devices that last: udev's links to nodes, whose own numbers change from start to
 * start. */
#ifndef INLAY_HAL_DEVICE_NODE_LINK_H
#define INLAY_HAL_DEVICE_NODE_LINK_H

#include <stdbool.h>
#include <stddef.h>

/* Finds the link in a folder like "/dev/v4l/by-id" that leads to a node; of several the first by
 * name. False, and an empty link: there is none. */
bool node_link(const char *folder, const char *node, char *link, size_t room);

#endif
