#include "drivers/libcamera/absence.h"

#include <errno.h>
#include <glob.h>
#include <unistd.h>

int libcamera_absence(struct fault *fault)
{
	glob_t media;
	int err = 0;

	if (glob("/dev/media*", 0, NULL, &media))
		return fault_say(fault, -ENODEV, "no camera: there is no /dev/media*");
	for (size_t i = 0; i < media.gl_pathc && !err; i++)
		if (access(media.gl_pathv[i], R_OK | W_OK) && errno == EACCES)
			err = fault_say(fault, -EACCES,
					"no permission for %s: the user must be in the group that "
					"owns it (video)",
					media.gl_pathv[i]);
	globfree(&media);
	if (err)
		return err;
	if (access("/run/udev/data", F_OK))
		return fault_say(fault, -ENODEV,
				 "no camera: libcamera finds them through udev, which is not "
				 "running");
	return fault_say(fault, -ENODEV,
			 "no camera: libcamera has no pipeline handler for what is plugged in, or "
			 "another program is setting it up");
}
