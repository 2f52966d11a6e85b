/* SPDX-License-Identifier: MIT */
/* New devices, and removals that come too late, are kept from libcamera while it runs. */
#ifndef INLAY_DRIVERS_LIBCAMERA_HOTPLUG_H
#define INLAY_DRIVERS_LIBCAMERA_HOTPLUG_H

/*
 * How many new devices have been kept from it. A manager finds all that are there when it begins,
 * and is not told of later ones: libcamera (0.0.3, devMap_ of DeviceEnumeratorUdev) keeps pointers
 * to what it has freed of each device that was there, and follows them when one of its nodes is
 * told again before its media node: when it is plugged in again, or udev is behind. Where udev's
 * messages were lost, that counts as one of them.
 */
unsigned libcamera_hotplug_kept(void);

#endif
