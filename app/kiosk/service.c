/* SPDX-License-Identifier: MIT */
#include "app/kiosk/service.h"

#include <stdio.h>
#include <string.h>

#if WITH_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

#include "hal/base/clock.h"

/* A failure makes no difference to the kiosk. */
static void service_tell(const char *text)
{
#if WITH_SYSTEMD
	(void)sd_notify(0, text);
#else
	(void)text;
#endif
}

void service_start(struct service *service)
{
	*service = (struct service){.watchdog_ns = 0};
#if WITH_SYSTEMD
	uint64_t us;

	if (sd_watchdog_enabled(0, &us) > 0)
		service->watchdog_ns = (int64_t)us * (NS_PER_MS / 1000);
#endif
}

void service_ready(struct service *service)
{
	if (!service->ready)
		service_tell("READY=1");
	service->ready = true;
}

void service_status(struct service *service, const char *text)
{
	char line[sizeof(service->status) + 8];

	if (!strncmp(service->status, text, sizeof(service->status) - 1))
		return;
	snprintf(service->status, sizeof(service->status), "%s", text);
	snprintf(line, sizeof(line), "STATUS=%s", service->status);
	service_tell(line);
}

void service_alive(struct service *service, int64_t now_ns)
{
	if (!service->watchdog_ns || now_ns - service->fed_ns < service->watchdog_ns / 4)
		return;
	service->fed_ns = now_ns;
	service_tell("WATCHDOG=1");
}

void service_reloading(struct service *service, int64_t now_ns)
{
	char line[64];

	if (!service->ready)
		return; /* it is still starting */
	snprintf(line, sizeof(line), "RELOADING=1\nMONOTONIC_USEC=%lld",
		 (long long)(now_ns / (NS_PER_MS / 1000)));
	service_tell(line);
}

void service_reloaded(struct service *service)
{
	if (service->ready)
		service_tell("READY=1");
}

void service_stopping(struct service *service)
{
	(void)service;
	service_tell("STOPPING=1");
}
