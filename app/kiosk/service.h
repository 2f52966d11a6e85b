/* SPDX-License-Identifier: MIT */
/*
 * What the service manager is told, by sd_notify(3): the kiosk is ready, reloads, stops, is alive.
 * Outside of systemd, and in a build without libsystemd, nothing happens.
 *
 * The watchdog is fed by pictures that reached the screen, so that the service manager starts a
 * kiosk again whose loop blocks, whose compositor does not return or whose page flips never come.
 * The kiosk redraws at least every second and a half, so a camera without frames does not starve
 * the watchdog. Where there is no screen to show on (none connected, held by another program, the
 * console switched away) waiting is right and feeds it, too.
 */
#ifndef INLAY_APP_KIOSK_SERVICE_H
#define INLAY_APP_KIOSK_SERVICE_H

#include <stdbool.h>
#include <stdint.h>

struct service {
	int64_t watchdog_ns; /* it ends the kiosk after this time without food; 0: there is none */
	int64_t fed_ns;
	bool ready;
	char status[256];
};

/* Reads the watchdog's interval from the environment. */
void service_start(struct service *service);

void service_ready(struct service *service);			/* tells it at the first call */
void service_status(struct service *service, const char *text); /* tells it when it differs */
/* Feeds the watchdog: a picture is on the screen, or there is no screen. Tells it at most four
 * times an interval. */
void service_alive(struct service *service, int64_t now_ns);
/* Before and after the configuration is read again. Told only after service_ready(). */
void service_reloading(struct service *service, int64_t now_ns);
void service_reloaded(struct service *service);
void service_stopping(struct service *service);

#endif
