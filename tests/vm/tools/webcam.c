/* SPDX-License-Identifier: MIT */
/*
 * Loaded before a program, it has libcamera treat every device as it does a webcam: it takes notice
 * when the media node goes away. vimc would not show what comes of that. What it calls is in
 * libcamera's library but in none of its installed headers, so it stands here by its name there.
 */
#include <dlfcn.h>
#include <stdio.h>

#define ACQUIRE                                                                                    \
	"_ZN9libcamera15PipelineHandler18acquireMediaDevice"                                       \
	"EPNS_16DeviceEnumeratorERKNS_11DeviceMatchE"
#define HOTPLUG "_ZN9libcamera15PipelineHandler18hotplugMediaDeviceEPNS_11MediaDeviceE"

/* Every pipeline handler gets its media devices from here; NULL: there is none that fits. */
void *acquire_media_device(void *handler, void *enumerator, const void *match) __asm__(ACQUIRE);

void *acquire_media_device(void *handler, void *enumerator, const void *match)
{
	void *(*acquire)(void *, void *, const void *);
	void (*hotplug)(void *, void *);
	void *media;

	*(void **)&acquire = dlsym(RTLD_NEXT, ACQUIRE);
	*(void **)&hotplug = dlsym(RTLD_NEXT, HOTPLUG);
	media = acquire(handler, enumerator, match);
	if (media) {
		hotplug(handler, media);
		fputs("webcam: a device is treated as one\n", stderr);
	}
	return media;
}
