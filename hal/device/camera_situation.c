/* SPDX-License-Identifier: MIT */
#include "hal/device/camera_situation.h"

#include <errno.h>

enum camera_situation camera_situation_of(int err)
{
	switch (-err) {
	case ENOENT:
	case ENODEV:
	case ENXIO:
		return CAMERA_NO_DEVICE;
	case EACCES:
	case EPERM:
		return CAMERA_NO_PERMISSION;
	case EBUSY:
		return CAMERA_BUSY;
	case ENOSPC: /* the bus has no bandwidth left */
		return CAMERA_NO_BANDWIDTH;
	case ENOLINK: /* no source is plugged into the input */
	case ENOLCK:  /* the source's signal is not stable */
	case ERANGE:  /* the input cannot receive the signal, for example while its source starts */
		return CAMERA_NO_SIGNAL;
	default:
		return CAMERA_BROKEN;
	}
}

bool camera_is_hopeless(enum camera_situation situation, int err)
{
	/* A camera of another kind may be plugged in; but a simulated one is what the configuration
	 * makes it. */
	if (situation == CAMERA_UNSUPPORTED_FORMAT)
		return err == -EINVAL;
	if (situation != CAMERA_BROKEN)
		return false;
	switch (-err) {
	case ENOTTY: /* not a camera */
	case EINVAL: /* no such input, standard or size */
	case ENOTSUP:
	case EISDIR: /* from here on: files that a simulated camera plays */
	case EBADMSG:
	case EFBIG:
	case EDOM:
		return true;
	default:
		return false;
	}
}
