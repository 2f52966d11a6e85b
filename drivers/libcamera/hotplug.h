/* SPDX-License-Identifier: MIT */
/* Keeps news of devices from a running libcamera where the news would crash it. */
#ifndef INLAY_DRIVERS_LIBCAMERA_HOTPLUG_H
#define INLAY_DRIVERS_LIBCAMERA_HOTPLUG_H

/*
 * Returns how many new devices have been kept from libcamera. A manager finds all devices when it
 * starts and is not told of later ones: libcamera (0.0.3, devMap_ of DeviceEnumeratorUdev) keeps
 * pointers to freed memory for each device that it has seen. It follows them when udev reports a
 * video node of that device before its media node, as happens after plugging in again or when udev
 * is late. Lost messages of udev count as one new device.
 */
unsigned libcamera_hotplug_kept(void);

#endif
