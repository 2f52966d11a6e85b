#include "hal/camera_situation.h"

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
	case ENOLINK: /* nothing is plugged into the input */
	case ENOLCK:  /* something is, but it is not stable */
		return CAMERA_NO_SIGNAL;
	default:
		return CAMERA_BROKEN;
	}
}
