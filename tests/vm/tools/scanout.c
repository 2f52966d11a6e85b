/* SPDX-License-Identifier: MIT */
/*
 * What a screen really shows, read back from the kernel.
 *
 *     scanout list                 a line for each connected connector: CARD DRIVER NAME MODE
 *     scanout picture CARD OUT.png the framebuffer that the first lit CRTC scans out, as a picture;
 *                                  prints its id, size and what drives it
 *     scanout checksum CARD        vkms only: the checksum of that framebuffer computed here, and
 *                                  the one that the device computed of a frame that it put out
 *     scanout leave CARD           shows black with a white cursor on it, lets another program
 *                                  drive the screen, says "left", and waits to be ended
 *
 * Needs root. All but leave need not be the screen's master: they work while another program drives
 * the screen.
 */
#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include "hal/image/image.h"

#define CARDS_MAX 8

struct scanout {
	int fd, card;
	uint32_t crtc_index, framebuffer;
	int width, height, mode_width, mode_height;
	uint32_t pitch, handle;
	uint8_t *pixels;
	size_t bytes;
};

static int die(const char *what)
{
	fprintf(stderr, "scanout: %s: %s\n", what, strerror(errno));
	exit(1);
}

static int open_card(int card)
{
	char path[64];
	snprintf(path, sizeof(path), "/dev/dri/card%d", card);
	int fd = open(path, O_RDWR | O_CLOEXEC);
	/* The first program that opens a card becomes its master; this one must not keep another
	 * out. */
	if (fd >= 0 && drmIsMaster(fd))
		drmDropMaster(fd);
	return fd;
}

static void list_card(int card)
{
	int fd = open_card(card);
	if (fd < 0)
		return;
	drmVersion *version = drmGetVersion(fd);
	drmModeRes *resources = drmModeGetResources(fd);
	for (int i = 0; resources && i < resources->count_connectors; i++) {
		drmModeConnector *c = drmModeGetConnector(fd, resources->connectors[i]);
		if (c && c->connection == DRM_MODE_CONNECTED && c->count_modes)
			printf("%d %s %s-%u %dx%d\n", card, version ? version->name : "?",
			       drmModeGetConnectorTypeName(c->connector_type), c->connector_type_id,
			       c->modes[0].hdisplay, c->modes[0].vdisplay);
		drmModeFreeConnector(c);
	}
	drmModeFreeResources(resources);
	drmFreeVersion(version);
	close(fd);
}

/* Finds the first CRTC that shows a framebuffer and maps it. */
static struct scanout map_scanout(int card)
{
	struct scanout s = {.fd = open_card(card), .card = card};
	if (s.fd < 0)
		die("cannot open the card");
	drmModeRes *resources = drmModeGetResources(s.fd);
	if (!resources)
		die("not a screen");
	for (int i = 0; i < resources->count_crtcs && !s.framebuffer; i++) {
		drmModeCrtc *crtc = drmModeGetCrtc(s.fd, resources->crtcs[i]);
		if (crtc && crtc->mode_valid && crtc->buffer_id) {
			s.crtc_index = (uint32_t)i;
			s.framebuffer = crtc->buffer_id;
			s.mode_width = crtc->mode.hdisplay;
			s.mode_height = crtc->mode.vdisplay;
		}
		drmModeFreeCrtc(crtc);
	}
	drmModeFreeResources(resources);
	errno = ENODATA;
	if (!s.framebuffer)
		die("no lit CRTC");

	drmModeFB2 *fb = drmModeGetFB2(s.fd, s.framebuffer);
	if (!fb)
		die("cannot ask for the framebuffer");
	errno = EINVAL;
	if (fb->pixel_format != 0x34325258 && fb->pixel_format != 0x34325241) /* XR24, AR24 */
		die("not 32 bits a pixel");
	s.width = (int)fb->width;
	s.height = (int)fb->height;
	s.pitch = fb->pitches[0];
	s.handle = fb->handles[0];
	drmModeFreeFB2(fb);

	struct drm_mode_map_dumb map = {.handle = s.handle};
	if (drmIoctl(s.fd, DRM_IOCTL_MODE_MAP_DUMB, &map))
		die("cannot map the framebuffer");
	s.bytes = (size_t)s.pitch * (size_t)s.height;
	s.pixels = mmap(NULL, s.bytes, PROT_READ, MAP_SHARED, s.fd, (off_t)map.offset);
	if (s.pixels == MAP_FAILED)
		die("cannot map the framebuffer");
	return s;
}

static void unmap_scanout(struct scanout *s)
{
	struct drm_gem_close gone = {.handle = s->handle};
	munmap(s->pixels, s->bytes);
	drmIoctl(s->fd, DRM_IOCTL_GEM_CLOSE, &gone);
	close(s->fd);
}

static void write_picture(const struct scanout *s, const char *path)
{
	struct fault fault = {""};
	struct image image;
	if (image_create_u8(&image, s->mode_width, s->mode_height))
		die("no memory");
	for (int y = 0; y < s->mode_height; y++)
		for (int x = 0; x < s->mode_width; x++) {
			const uint8_t *from = s->pixels + (size_t)y * s->pitch + 4 * (size_t)x;
			uint8_t *to = image.u8 + ((size_t)y * s->mode_width + x) * 3;
			to[0] = from[2];
			to[1] = from[1];
			to[2] = from[0];
		}
	if (image_write(path, &image, &fault)) {
		fprintf(stderr, "scanout: %s\n", fault.text);
		exit(1);
	}
	image_free(&image);
}

/* CRC-32 (reflected, polynomial 0xEDB88320), start 0, not inverted: the kernel's crc32_le. */
static uint32_t crc32_add(uint32_t crc, const uint8_t *data, size_t bytes)
{
	for (size_t i = 0; i < bytes; i++) {
		crc ^= data[i];
		for (int bit = 0; bit < 8; bit++)
			crc = (crc >> 1) ^ (0xEDB88320u & -(crc & 1));
	}
	return crc;
}

/* vkms composes in 16 bits a channel (code * 257), in the order A, R, G, B, little-endian. */
static uint32_t expected_checksum(const struct scanout *s)
{
	uint32_t crc = 0;
	for (int y = 0; y < s->mode_height; y++)
		for (int x = 0; x < s->mode_width; x++) {
			const uint8_t *p = s->pixels + (size_t)y * s->pitch + 4 * (size_t)x;
			const uint8_t wide[8] = {255, 255, p[2], p[2], p[1], p[1], p[0], p[0]};
			crc = crc32_add(crc, wide, sizeof(wide));
		}
	return crc;
}

static uint32_t device_checksum(const struct scanout *s)
{
	char path[128], line[64] = "";
	snprintf(path, sizeof(path), "/sys/kernel/debug/dri/%d/crtc-%u/crc/control", s->card,
		 s->crtc_index);
	FILE *control = fopen(path, "w");
	if (!control || fputs("auto", control) < 0 || fclose(control))
		die(path);
	snprintf(path, sizeof(path), "/sys/kernel/debug/dri/%d/crtc-%u/crc/data", s->card,
		 s->crtc_index);
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		die(path);
	unsigned frame, crc;
	/* the first checksum may be of the frame that was being composed */
	for (int i = 0; i < 2; i++)
		if (read(fd, line, sizeof(line) - 1) <= 0)
			die("no checksum came");
	close(fd);
	errno = EBADMSG;
	if (sscanf(line, "%x %x", &frame, &crc) != 2)
		die(line);
	return crc;
}

/* Creates a framebuffer whose bytes are all the same. */
static uint32_t make_framebuffer(int fd, uint32_t width, uint32_t height, uint32_t format, int fill)
{
	struct drm_mode_create_dumb create = {.width = width, .height = height, .bpp = 32};
	struct drm_mode_map_dumb map = {0};
	uint32_t framebuffer = 0;

	if (drmIoctl(fd, DRM_IOCTL_MODE_CREATE_DUMB, &create))
		die("cannot make a buffer");
	map.handle = create.handle;
	if (drmIoctl(fd, DRM_IOCTL_MODE_MAP_DUMB, &map))
		die("cannot map a buffer");
	void *pixels = mmap(NULL, create.size, PROT_WRITE, MAP_SHARED, fd, (off_t)map.offset);
	if (pixels == MAP_FAILED)
		die("cannot map a buffer");
	memset(pixels, fill, create.size);
	if (drmModeAddFB2(fd, width, height, format, (uint32_t[4]){create.handle},
			  (uint32_t[4]){create.pitch}, (uint32_t[4]){0}, &framebuffer, 0))
		die("cannot make a framebuffer");
	return framebuffer;
}

/* Uses the last plane, which is the cursor's where there is one: 64 pixels square. */
static void put_cursor(int fd, uint32_t crtc)
{
	const uint32_t framebuffer = make_framebuffer(fd, 64, 64, DRM_FORMAT_ARGB8888, 255);
	drmModePlaneRes *planes = drmModeGetPlaneResources(fd);

	if (!planes || planes->count_planes < 2 ||
	    drmModeSetPlane(fd, planes->planes[planes->count_planes - 1], crtc, framebuffer, 0, 300,
			    200, 64, 64, 0, 0, 64 << 16, 64 << 16))
		die("cannot put a cursor");
	drmModeFreePlaneResources(planes);
}

static int leave(int card)
{
	char path[64];

	snprintf(path, sizeof(path), "/dev/dri/card%d", card);
	int fd = open(path, O_RDWR | O_CLOEXEC);
	drmModeRes *resources = fd < 0 ? NULL : drmModeGetResources(fd);
	drmModeConnector *c = resources ? drmModeGetConnector(fd, resources->connectors[0]) : NULL;

	if (!c || !c->count_modes || drmSetClientCap(fd, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1))
		die("not a screen");
	if (drmModeSetCrtc(fd, resources->crtcs[0],
			   make_framebuffer(fd, c->modes[0].hdisplay, c->modes[0].vdisplay,
					    DRM_FORMAT_XRGB8888, 0),
			   0, 0, &c->connector_id, 1, &c->modes[0]))
		die("cannot set the mode");
	put_cursor(fd, resources->crtcs[0]);
	if (drmDropMaster(fd))
		die("cannot let go");
	puts("left");
	fflush(stdout);
	pause();
	return 0;
}

int main(int argc, char **argv)
{
	if (argc == 2 && !strcmp(argv[1], "list")) {
		for (int card = 0; card < CARDS_MAX; card++)
			list_card(card);
		return 0;
	}
	if (argc == 4 && !strcmp(argv[1], "picture")) {
		struct scanout s = map_scanout(atoi(argv[2]));
		write_picture(&s, argv[3]);
		printf("framebuffer %u size %dx%d mode %dx%d\n", s.framebuffer, s.width, s.height,
		       s.mode_width, s.mode_height);
		unmap_scanout(&s);
		return 0;
	}
	if (argc == 3 && !strcmp(argv[1], "checksum")) {
		struct scanout s = map_scanout(atoi(argv[2]));
		const uint32_t device = device_checksum(&s);
		const uint32_t expected = expected_checksum(&s);
		printf("expected %08x device %08x\n", expected, device);
		unmap_scanout(&s);
		return expected == device ? 0 : 1;
	}
	if (argc == 3 && !strcmp(argv[1], "leave"))
		return leave(atoi(argv[2]));
	fprintf(stderr,
		"usage: scanout list | picture CARD OUT.png | checksum CARD | leave CARD\n");
	return 2;
}
