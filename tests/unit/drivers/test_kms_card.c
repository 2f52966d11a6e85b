/* SPDX-License-Identifier: MIT */
/*
 * The KMS display against a graphics card that this program plays: a FIFO is opened as the card,
 * and ioctl() and mmap() are answered here instead of by a kernel. tests/vm is about what a real
 * kernel answers; this is about cards that the simulated machine does not have: one that scales,
 * one that is busy, one whose flips never come, one whose screen changes its modes, one whose link
 * fails, one on which an earlier program left a cursor.
 */
#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/kms/kms.h"
#include "hal/base/clock.h"
#include "tests/support/captured_log.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

enum {
	CONNECTOR = 10,
	ENCODER,
	CRTC,
	PLANE,
	CURSOR,
	CONNECTOR_2,
	ENCODER_2,
	CRTC_2,
	PLANE_2,
	OBJECTS = PLANE_2 + 1 - CONNECTOR,
	FIRST_PROPERTY = 100,
	BUFFER_BYTES = 1 << 22
};

static const char *const properties[] = {
	"CRTC_ID",
	"ACTIVE",
	"MODE_ID",
	"FB_ID",
	"SRC_X",
	"SRC_Y",
	"SRC_W",
	"SRC_H",
	"CRTC_X",
	"CRTC_Y",
	"CRTC_W",
	"CRTC_H",
	"CTM",
	"DEGAMMA_LUT",
	"GAMMA_LUT",
	"link-status",
	"type",
	"Broadcast RGB",
	"panel orientation",
};

enum {
	PROPERTIES = sizeof(properties) / sizeof(properties[0]),
	LINK = PROPERTIES - 4,
	RANGE = PROPERTIES - 2,
	ORIENTATION
};

/* The values of the last two, in an order of the card's own. */
static const struct drm_mode_property_enum ranges[] = {
	{7, "Automatic"}, {3, "Full"}, {5, "Limited 16:235"}};
static const struct drm_mode_property_enum orientations[] = {
	{0, "Normal"}, {1, "Upside Down"}, {2, "Left Side Up"}, {3, "Right Side Up"}};

static struct {
	ino_t node;
	int memory;			   /* file behind the buffers */
	unsigned connection, connection_2; /* 0: there is no second connector */
	drmModeModeInfo mode_2;
	drmModeModeInfo modes[2];
	int mode_count;
	bool held, no_atomic, scales, silent, has_link, has_panel;
	/* Once it is off, the cursor's picture is freed: nobody else holds it. */
	bool cursor_is_gone;
	int busy;	    /* number of flips still to be refused */
	atomic_int commits; /* blocking commits so far */
	atomic_bool blocks; /* commits block while this is true */
	int trials, flips;  /* TEST_ONLY commits; accepted flips */
	int probes;	    /* probes of the connector */
	atomic_int buffers; /* existing buffers */
	atomic_int master;  /* descriptor of the master; 0: none */
	int created;
	int blobs;			      /* existing property blobs */
	uint64_t values[OBJECTS][PROPERTIES]; /* the properties of all objects, as last set */
	int64_t flip_ns;		      /* time in the flip event */
} card;

static int test_kms_card_refuse(int err)
{
	errno = err;
	return -1;
}

/* Fills an array if the caller gave room for it, and tells its length. */
static void answer(uint64_t to, uint32_t *count, const uint32_t *ids, uint32_t length)
{
	if (to && *count >= length)
		memcpy((void *)(uintptr_t)to, ids, length * sizeof(*ids));
	*count = length;
}

static uint64_t *property(uint64_t values[OBJECTS][PROPERTIES], uint32_t object, const char *name)
{
	for (int i = 0; i < PROPERTIES; i++)
		if (!strcmp(properties[i], name))
			return &values[object - CONNECTOR][i];
	fail_msg("no property %s", name);
	return NULL;
}

static uint64_t *value_of(uint32_t object, const char *name)
{
	return property(card.values, object, name);
}

/* Every object reports all properties, which does not matter here. */
static void answer_properties(uint32_t object, uint64_t ids, uint64_t values, uint32_t *count)
{
	if (ids && *count >= PROPERTIES)
		for (uint32_t i = 0; i < PROPERTIES; i++) {
			((uint32_t *)(uintptr_t)ids)[i] = FIRST_PROPERTY + i;
			((uint64_t *)(uintptr_t)values)[i] = card.values[object - CONNECTOR][i];
		}
	*count = PROPERTIES;
}

static int get_connector(struct drm_mode_get_connector *c)
{
	const bool other = c->connector_id == CONNECTOR_2;
	const unsigned connection = other ? card.connection_2 : card.connection;
	const uint32_t count = connection != DRM_MODE_CONNECTED && other ? 0
			       : other					 ? 1
				       : (uint32_t)card.mode_count;

	if (c->connector_id != CONNECTOR && !other)
		return test_kms_card_refuse(ENOENT);
	card.probes += !c->count_modes;
	if (c->modes_ptr && c->count_modes >= count)
		memcpy((void *)(uintptr_t)c->modes_ptr, other ? &card.mode_2 : card.modes,
		       count * sizeof(card.modes[0]));
	c->count_modes = count;
	answer(c->encoders_ptr, &c->count_encoders, (uint32_t[]){other ? ENCODER_2 : ENCODER}, 1);
	answer_properties(c->connector_id, c->props_ptr, c->prop_values_ptr, &c->count_props);
	c->connection = connection;
	c->connector_type = DRM_MODE_CONNECTOR_HDMIA;
	c->connector_type_id = other ? 2 : 1;
	c->encoder_id = 0;
	return 0;
}

static int get_resources(struct drm_mode_card_res *r)
{
	const uint32_t screens = card.connection_2 ? 2 : 1;

	answer(r->connector_id_ptr, &r->count_connectors, (uint32_t[]){CONNECTOR, CONNECTOR_2},
	       screens);
	answer(r->crtc_id_ptr, &r->count_crtcs, (uint32_t[]){CRTC, CRTC_2}, screens);
	answer(r->encoder_id_ptr, &r->count_encoders, (uint32_t[]){ENCODER, ENCODER_2}, screens);
	r->count_fbs = 0;
	return 0;
}

static int get_plane(struct drm_mode_get_plane *p)
{
	answer(p->format_type_ptr, &p->count_format_types, (uint32_t[]){DRM_FORMAT_XRGB8888}, 1);
	p->possible_crtcs = card.connection_2 && p->plane_id != CURSOR ? 3 : 1;
	p->crtc_id = (uint32_t)*value_of(p->plane_id, "CRTC_ID");
	p->fb_id = (uint32_t)*value_of(p->plane_id, "FB_ID");
	return 0;
}

static int get_properties(struct drm_mode_obj_get_properties *p)
{
	answer_properties(p->obj_id, p->props_ptr, p->prop_values_ptr, &p->count_props);
	return 0;
}

static int get_property(struct drm_mode_get_property *p)
{
	const uint32_t i = p->prop_id - FIRST_PROPERTY;

	const bool is_enum = i == RANGE || i == ORIENTATION;
	const struct drm_mode_property_enum *values = i == RANGE ? ranges : orientations;
	const uint32_t count = i == RANGE ? 3 : 4;

	if ((i == LINK && !card.has_link) || (is_enum && !card.has_panel)) {
		strcpy(p->name, "other");
		p->count_values = p->count_enum_blobs = 0;
		return 0;
	}
	strcpy(p->name, properties[i]);
	p->flags = is_enum ? DRM_MODE_PROP_ENUM : 0;
	p->count_values = 0;
	if (is_enum && p->enum_blob_ptr && p->count_enum_blobs >= count)
		memcpy((void *)(uintptr_t)p->enum_blob_ptr, values, count * sizeof(*values));
	p->count_enum_blobs = is_enum ? count : 0;
	return 0;
}

/* Reports a flip as the kernel does, whoever waits for it. */
static void report_flip(int fd, uint64_t user, uint32_t crtc)
{
	const struct drm_event_vblank event = {
		.base = {DRM_EVENT_FLIP_COMPLETE, sizeof(event)},
		.user_data = user,
		.tv_sec = (uint32_t)(card.flip_ns / NS_PER_S),
		.tv_usec = (uint32_t)(card.flip_ns % NS_PER_S / 1000),
		.crtc_id = crtc,
	};

	assert_int_equal(write(fd, &event, sizeof(event)), sizeof(event));
}

static bool is_scaled(uint64_t wanted[OBJECTS][PROPERTIES], uint32_t plane)
{
	return *property(wanted, plane, "SRC_W") >> 16 != *property(wanted, plane, "CRTC_W") ||
	       *property(wanted, plane, "SRC_H") >> 16 != *property(wanted, plane, "CRTC_H");
}

/* The CRTC that a plane of the commit is on. */
static uint32_t flipped_crtc(const struct drm_mode_atomic *a, uint32_t index)
{
	return (uint32_t)*value_of(((uint32_t *)(uintptr_t)a->objs_ptr)[index], "CRTC_ID");
}

static int commit(int fd, const struct drm_mode_atomic *a)
{
	const uint32_t *objects = (uint32_t *)(uintptr_t)a->objs_ptr;
	const uint32_t *counts = (uint32_t *)(uintptr_t)a->count_props_ptr;
	const uint32_t *ids = (uint32_t *)(uintptr_t)a->props_ptr;
	const uint64_t *values = (uint64_t *)(uintptr_t)a->prop_values_ptr;
	const bool trial = a->flags & DRM_MODE_ATOMIC_TEST_ONLY;
	uint64_t wanted[OBJECTS][PROPERTIES];

	memcpy(wanted, card.values, sizeof(wanted));
	for (uint32_t o = 0, at = 0; o < a->count_objs; o++)
		for (uint32_t i = 0; i < counts[o]; i++, at++)
			wanted[objects[o] - CONNECTOR][ids[at] - FIRST_PROPERTY] = values[at];
	if (!card.scales && (is_scaled(wanted, PLANE) || is_scaled(wanted, PLANE_2)))
		return test_kms_card_refuse(ERANGE);
	if (card.cursor_is_gone && *property(wanted, CURSOR, "FB_ID") &&
	    !*value_of(CURSOR, "FB_ID"))
		return test_kms_card_refuse(ENOENT);
	if (!(a->flags & DRM_MODE_ATOMIC_ALLOW_MODESET) &&
	    *property(wanted, CRTC, "ACTIVE") != *value_of(CRTC, "ACTIVE"))
		return test_kms_card_refuse(EINVAL);
	if (trial) {
		card.trials++;
		return 0;
	}
	if (!(a->flags & DRM_MODE_ATOMIC_NONBLOCK)) {
		card.commits++;
		while (card.blocks)
			poll(NULL, 0, 10);
	} else if (card.busy) {
		card.busy--;
		return test_kms_card_refuse(EBUSY);
	}
	memcpy(card.values, wanted, sizeof(wanted));
	if (a->flags & DRM_MODE_PAGE_FLIP_EVENT) {
		card.flips++;
		for (uint32_t o = 0; o < a->count_objs && !card.silent; o++)
			report_flip(fd, a->user_data, flipped_crtc(a, o));
	}
	return 0;
}

static int create_dumb(struct drm_mode_create_dumb *d)
{
	d->pitch = d->width * 4 + 64;
	d->size = (uint64_t)d->pitch * d->height;
	d->handle = (uint32_t)++card.created;
	card.buffers++;
	assert_true(d->size <= BUFFER_BYTES);
	return 0;
}

/* One descriptor of the card is master until it lets go: here the first that asks. */
static bool is_master(int fd)
{
	int none = 0;

	return !card.held &&
	       (atomic_compare_exchange_strong(&card.master, &none, fd) || none == fd);
}

static int play(int fd, unsigned long request, void *argument)
{
	switch (request) {
	case DRM_IOCTL_GET_CAP:
		((struct drm_get_cap *)argument)->value = 1;
		return 0;
	case DRM_IOCTL_SET_CLIENT_CAP:
		return card.no_atomic ? test_kms_card_refuse(EOPNOTSUPP) : 0;
	case DRM_IOCTL_AUTH_MAGIC: /* libdrm's way to ask whether it is master */
		return test_kms_card_refuse(is_master(fd) ? EINVAL : EACCES);
	case DRM_IOCTL_SET_MASTER:
		return is_master(fd) ? 0 : test_kms_card_refuse(EACCES);
	case DRM_IOCTL_DROP_MASTER:
		card.master = 0;
		return 0;
	case DRM_IOCTL_MODE_GETRESOURCES:
		return get_resources(argument);
	case DRM_IOCTL_MODE_GETCONNECTOR:
		return get_connector(argument);
	case DRM_IOCTL_MODE_GETENCODER:
		((struct drm_mode_get_encoder *)argument)->crtc_id = 0;
		((struct drm_mode_get_encoder *)argument)->possible_crtcs = card.connection_2 ? 3
											      : 1;
		return 0;
	case DRM_IOCTL_MODE_GETPLANERESOURCES: {
		struct drm_mode_get_plane_res *r = argument;

		answer(r->plane_id_ptr, &r->count_planes, (uint32_t[]){PLANE, CURSOR, PLANE_2},
		       card.connection_2 ? 3 : 2);
		return 0;
	}
	case DRM_IOCTL_MODE_GETPLANE:
		return get_plane(argument);
	case DRM_IOCTL_MODE_OBJ_GETPROPERTIES:
		return get_properties(argument);
	case DRM_IOCTL_MODE_GETPROPERTY:
		return get_property(argument);
	case DRM_IOCTL_MODE_CREATEPROPBLOB:
		((struct drm_mode_create_blob *)argument)->blob_id = (uint32_t)++card.created;
		card.blobs++;
		return 0;
	case DRM_IOCTL_MODE_DESTROYPROPBLOB:
		card.blobs--;
		return 0;
	case DRM_IOCTL_MODE_CREATE_DUMB:
		return create_dumb(argument);
	case DRM_IOCTL_MODE_MAP_DUMB: {
		struct drm_mode_map_dumb *m = argument;

		m->offset = (uint64_t)m->handle * BUFFER_BYTES;
		return 0;
	}
	case DRM_IOCTL_MODE_ADDFB2:
		((struct drm_mode_fb_cmd2 *)argument)->fb_id =
			1000 + ((struct drm_mode_fb_cmd2 *)argument)->handles[0];
		return 0;
	case DRM_IOCTL_MODE_DESTROY_DUMB:
		card.buffers--;
		return 0;
	case DRM_IOCTL_MODE_ATOMIC:
		return commit(fd, argument);
	default: /* calls that need no answer */
		return 0;
	}
}

static bool is_card(int fd)
{
	struct stat of;

	return card.node && !fstat(fd, &of) && of.st_ino == card.node && S_ISFIFO(of.st_mode);
}

int ioctl(int fd, unsigned long request, ...)
{
	va_list arguments;
	void *argument;

	va_start(arguments, request);
	argument = va_arg(arguments, void *);
	va_end(arguments);
	return is_card(fd) ? play(fd, request, argument)
			   : (int)syscall(SYS_ioctl, fd, request, argument);
}

/* The linker puts this in place of mmap() in this program (tests/module.mk). A function named
 * mmap() would also replace the one that a sanitizer uses. */
void *__real_mmap(void *address, size_t length, int protection, int flags, int fd, off_t offset);
void *__wrap_mmap(void *address, size_t length, int protection, int flags, int fd, off_t offset);

void *__wrap_mmap(void *address, size_t length, int protection, int flags, int fd, off_t offset)
{
	return __real_mmap(address, length, protection, flags, is_card(fd) ? card.memory : fd,
			   offset);
}

/* ---- a screen on it ---- */

static struct kms_options options;
static int rotate; /* enum picture_turn */
static struct display display;
static struct fault fault;

static int plug_in(void **state)
{
	struct stat of;

	(void)state;
	memset(&card, 0, sizeof(card));
	if (mkfifo(own_folder_path("card"), 0600) || stat(own_folder_path("card"), &of))
		return -1;
	card.node = of.st_ino;
	card.memory = memfd_create("buffers", MFD_CLOEXEC);
	card.connection = DRM_MODE_CONNECTED;
	card.mode_count = 2;
	kms_timing(1280, 720, 60, &card.modes[0]);
	kms_timing(640, 480, 60, &card.modes[1]);
	*value_of(PLANE, "type") = DRM_PLANE_TYPE_PRIMARY;
	*value_of(PLANE_2, "type") = DRM_PLANE_TYPE_PRIMARY;
	*value_of(CURSOR, "type") = DRM_PLANE_TYPE_CURSOR;
	card.flip_ns = 5 * NS_PER_S + 7000;
	options = (struct kms_options){.buffers = 2};
	return ftruncate(card.memory, 64L * BUFFER_BYTES);
}

static int open_it(void)
{
	struct display_settings settings = {.turn = rotate};

	strcpy(settings.device, own_folder_path("card"));
	return display_open(&display, &display_kms, &settings, &options, &fault);
}

/* A display that stalled is freed later by itself, and cannot be opened before. */
static int open_after_a_stall(void)
{
	const int64_t until_ns = clock_now_ns() + 60 * NS_PER_S;
	int err;

	while ((err = open_it()) == -ETIMEDOUT && clock_now_ns() < until_ns)
		poll(NULL, 0, 10);
	return err;
}

static int take_out(void **state)
{
	(void)state;
	card.blocks = false;
	display_close(&display, NULL);
	open_after_a_stall();
	display_close(&display, NULL);
	close(card.memory);
	card.node = 0;
	return unlink(own_folder_path("card"));
}

static void open_fine(void)
{
	if (open_it())
		fail_msg("%s", fault.text);
}

/* First event of dispatch() within a time; 0: none. */
static int wait_for(struct display_event *event, int64_t within_ns)
{
	const int64_t until_ns = clock_now_ns() + within_ns;
	struct pollfd ready = {.fd = display_descriptor(&display), .events = POLLIN};
	int err = 0;

	*event = (struct display_event){0};
	while (!err && event->kind == DISPLAY_NOTHING && clock_now_ns() < until_ns) {
		poll(&ready, 1, 20);
		err = display_dispatch(&display, event, &fault);
	}
	return err;
}

static void submit(int64_t token, int width, int height)
{
	struct display_buffer buffer;

	assert_int_equal(display_acquire(&display, &buffer), 0);
	assert_int_equal(buffer.width, width);
	assert_int_equal(buffer.height, height);
	memset(buffer.pixels, 77, buffer.stride * (size_t)height);
	if (display_submit(&display, &buffer, token, &fault))
		fail_msg("%s", fault.text);
}

static void assert_shown(int64_t token)
{
	struct display_event event;

	assert_int_equal(wait_for(&event, 60 * NS_PER_S), 0);
	assert_int_equal(event.kind, DISPLAY_SHOWN);
	assert_int_equal(event.token, token);
	assert_int_equal(event.time_ns, card.flip_ns);
}

static void assert_plane(int source_width, int source_height, struct kms_box box)
{
	assert_int_equal(*value_of(PLANE, "SRC_W"), (uint64_t)source_width << 16);
	assert_int_equal(*value_of(PLANE, "SRC_H"), (uint64_t)source_height << 16);
	assert_int_equal(*value_of(PLANE, "CRTC_X"), box.x);
	assert_int_equal(*value_of(PLANE, "CRTC_Y"), box.y);
	assert_int_equal(*value_of(PLANE, "CRTC_W"), box.width);
	assert_int_equal(*value_of(PLANE, "CRTC_H"), box.height);
}

TEST_BETWEEN("frames are shown at the flips time", plug_in, take_out)
{
	for (int buffers = 2; buffers <= 3; buffers++) {
		options.buffers = buffers;
		open_fine();
		assert_int_equal(display.width, 1280);
		for (int i = 1; i <= 20; i++) {
			card.flip_ns += 16667000;
			submit(i, 1280, 720);
			assert_shown(i);
		}
		assert_int_equal(display.shown, 20);
		assert_int_equal(display_close(&display, &fault), 0);
		assert_int_equal(card.buffers, 0);
	}
}

TEST_BETWEEN("busy flips are tried again", plug_in, take_out)
{
	struct display_buffer buffer;

	options.buffers = 3;
	open_fine();
	card.busy = 5;
	submit(1, 1280, 720);
	assert_int_equal(card.flips, 0);
	/* it is the next to be shown: nothing may overtake it */
	assert_int_equal(display_acquire(&display, &buffer), -EAGAIN);
	assert_shown(1);
	assert_int_equal(card.busy, 0);
	submit(2, 1280, 720);
	assert_shown(2);
}

TEST_BETWEEN("busy for ever is a stall", plug_in, take_out)
{
	struct display_event event;
	const int64_t start_ns = clock_now_ns();

	open_fine();
	card.busy = 1 << 30;
	submit(1, 1280, 720);
	assert_int_equal(wait_for(&event, 60 * NS_PER_S), -ETIMEDOUT);
	assert_int_equal(display.situation, DISPLAY_STALLED);
	assert_true(clock_now_ns() - start_ns >= NS_PER_S);
}

/* The kernel lets nobody go while it waits for a flip; the program must not wait with it. */
TEST_BETWEEN("lost flips are a stall", plug_in, take_out)
{
	struct display_event event;

	open_fine();
	submit(1, 1280, 720);
	assert_shown(1);
	card.silent = true;
	submit(2, 1280, 720);
	assert_int_equal(wait_for(&event, 60 * NS_PER_S), -ETIMEDOUT);
	assert_int_equal(display.situation, DISPLAY_STALLED);
	assert_true(display_may_return(display.situation));
	card.blocks = true;
	assert_int_equal(display_close(&display, &fault), 0);
	/* until then it stays a stall, however often it is tried: nobody else holds the screen */
	for (int i = 0; i < 3; i++) {
		assert_int_equal(open_it(), -ETIMEDOUT);
		assert_int_equal(display.situation, DISPLAY_STALLED);
		assert_non_null(strstr(fault.text, "still waits"));
	}
	/* it is freed all the same, later */
	card.blocks = false;
	card.silent = false;
	assert_int_equal(open_after_a_stall(), 0);
	assert_int_equal(card.buffers, options.buffers);
	assert_true(card.commits >= 3);
	submit(3, 1280, 720);
	assert_shown(3);
}

TEST_BETWEEN("a card that scales scales", plug_in, take_out)
{
	int trials;

	card.scales = true;
	open_fine();
	submit(1, 1280, 720);
	assert_shown(1);
	trials = card.trials;
	assert_int_equal(display_fit(&display, 640, 480, 1), 0);
	assert_int_equal(card.trials, trials + 1);
	/* the trial has changed nothing */
	assert_plane(1280, 720, (struct kms_box){0, 0, 1280, 720});
	submit(2, 640, 480);
	assert_shown(2);
	assert_plane(640, 480, (struct kms_box){160, 0, 960, 720});
	/* pixels that are not square, and back; the card is asked once */
	for (int i = 0; i < 3; i++) {
		assert_int_equal(display_fit(&display, 720, 486, 540.0 / 486), 0);
		submit(3, 720, 486);
		assert_shown(3);
		assert_plane(720, 486, (struct kms_box){160, 0, 960, 720});
		assert_int_equal(display_fit(&display, 640, 480, 1), 0);
	}
	assert_int_equal(card.trials, trials + 2);
	/* A picture of the screen's own size needs no scaling; a larger one has no room. */
	assert_int_equal(display_fit(&display, 1280, 720, 1), 0);
	submit(4, 1280, 720);
	assert_shown(4);
	assert_plane(1280, 720, (struct kms_box){0, 0, 1280, 720});
	assert_int_equal(display_fit(&display, 1920, 1080, 1), -ENOTSUP);
	submit(5, 1280, 720);
	assert_shown(5);
	assert_int_equal(card.trials, trials + 2);
	display_close(&display, NULL);
	options.scaling = KMS_SCALING_NEVER;
	open_fine();
	assert_int_equal(display_fit(&display, 640, 480, 1), -ENOTSUP);
	submit(1, 1280, 720);
	assert_shown(1);
}

TEST_BETWEEN("a card that does not scale is believed", plug_in, take_out)
{
	int commits;

	open_fine();
	commits = card.commits;
	for (int i = 1; i < 4; i++) {
		assert_int_equal(display_fit(&display, 640, 480, 1), -ENOTSUP);
		submit(i, 1280, 720);
		assert_shown(i);
		assert_plane(1280, 720, (struct kms_box){0, 0, 1280, 720});
	}
	assert_int_equal(card.commits, commits);
}

TEST_BETWEEN("a changed screen is noticed", plug_in, take_out)
{
	struct display_event event;

	open_fine();
	/* another name and one mode more: the choice stays the same */
	card.probes = 0;
	strcpy(card.modes[0].name, "other");
	card.mode_count = 1;
	assert_int_equal(wait_for(&event, 5 * NS_PER_S / 2), 0);
	assert_int_equal(card.probes, 0);
	kms_timing(1024, 768, 60, &card.modes[0]);
	assert_int_equal(wait_for(&event, 60 * NS_PER_S), -ESTALE);
	assert_true(display_may_return(display.situation));
	display_close(&display, NULL);
	open_fine();
	assert_int_equal(display.width, 1024);
	card.connection = DRM_MODE_DISCONNECTED;
	card.mode_count = 0;
	assert_int_equal(wait_for(&event, 60 * NS_PER_S), -ENOLINK);
	assert_int_equal(display.situation, DISPLAY_NO_SCREEN);
	display_close(&display, NULL);
	assert_int_equal(open_it(), -ENOLINK);
	assert_int_equal(display.situation, DISPLAY_NO_SCREEN);
}

/* A screen whose link failed stays black until its mode is set and the link is requested again. */
TEST_BETWEEN("a failed link is set up again", plug_in, take_out)
{
	struct display_event event;

	card.has_link = true;
	*value_of(CONNECTOR,
		  "link-status") = DRM_MODE_LINK_STATUS_BAD; /* left by an earlier program */
	open_fine();
	assert_int_equal(*value_of(CONNECTOR, "link-status"), DRM_MODE_LINK_STATUS_GOOD);
	submit(1, 1280, 720);
	assert_shown(1);
	assert_int_equal(wait_for(&event, 5 * NS_PER_S / 2), 0);
	*value_of(CONNECTOR, "link-status") = DRM_MODE_LINK_STATUS_BAD;
	assert_int_equal(wait_for(&event, 60 * NS_PER_S), -ESTALE);
	assert_non_null(strstr(fault.text, "link"));
	assert_true(display_may_return(display.situation));
	display_close(&display, NULL);
	assert_int_equal(*value_of(CONNECTOR, "link-status"),
			 DRM_MODE_LINK_STATUS_GOOD); /* left for the next program */
	*value_of(CONNECTOR, "link-status") = DRM_MODE_LINK_STATUS_BAD;
	open_fine();
	assert_int_equal(*value_of(CONNECTOR, "link-status"), DRM_MODE_LINK_STATUS_GOOD);
	submit(2, 1280, 720);
	assert_shown(2);
}

/* An earlier program may have left more on the screen than a picture. */
TEST_BETWEEN("what was left is put away and back", plug_in, take_out)
{
	static const char *const colours[] = {"CTM", "DEGAMMA_LUT", "GAMMA_LUT"};

	for (int gone = 0; gone < 2; gone++) {
		card.cursor_is_gone = gone;
		*value_of(PLANE, "FB_ID") = 500;
		*value_of(CURSOR, "FB_ID") = 501;
		*value_of(CURSOR, "CRTC_ID") = CRTC;
		*value_of(CURSOR, "CRTC_X") = 320;
		for (int i = 0; i < 3; i++)
			*value_of(CRTC, colours[i]) = 502;
		open_fine();
		assert_int_equal(*value_of(CURSOR, "FB_ID"), 0);
		assert_int_equal(*value_of(CURSOR, "CRTC_ID"), 0);
		for (int i = 0; i < 3; i++)
			assert_int_equal(*value_of(CRTC, colours[i]), 0);
		submit(1, 1280, 720);
		assert_shown(1);
		assert_int_equal(display_close(&display, &fault), 0);
		assert_int_equal(*value_of(PLANE, "FB_ID"), 500);
		assert_int_equal(*value_of(CURSOR, "FB_ID"), gone ? 0 : 501);
		assert_int_equal(*value_of(CURSOR, "CRTC_ID"), gone ? 0 : CRTC);
		assert_int_equal(*value_of(CURSOR, "CRTC_X"), 320);
		/* a copy, because the original may be gone by then */
		for (int i = 0; i < 3; i++) {
			assert_int_not_equal(*value_of(CRTC, colours[i]), 0);
			assert_int_not_equal(*value_of(CRTC, colours[i]), 502);
		}
		assert_int_equal(card.blobs, 0);
	}
}

/* By ACTIVE, with everything else kept, and with no trace of the picture that was shown. */
TEST_BETWEEN("a screen is switched off and on", plug_in, take_out)
{
	struct display_buffer buffer;
	struct display_event event;

	open_fine();
	submit(1, 1280, 720);
	assert_shown(1);
	submit(2, 1280, 720); /* on its way */
	assert_int_equal(display_acquire(&display, &buffer), -EAGAIN);
	assert_int_equal(display_power(&display, false, &fault), 0);
	assert_true(display.off);
	assert_int_equal(*value_of(CRTC, "ACTIVE"), 0);
	assert_int_equal(*value_of(CONNECTOR, "CRTC_ID"), CRTC);
	assert_int_equal(display_acquire(&display, &buffer), -EAGAIN);
	/* A screen that is off may say that it is not there. */
	card.connection = DRM_MODE_DISCONNECTED;
	assert_int_equal(wait_for(&event, 2500 * NS_PER_MS), 0);
	assert_int_equal(event.kind, DISPLAY_NOTHING);
	card.connection = DRM_MODE_CONNECTED;
	/* It cannot be asked now whether it scales, and no answer is kept. */
	card.scales = true;
	assert_int_equal(display_fit(&display, 640, 360, 1), -ENOTSUP);
	assert_int_equal(display_power(&display, false, &fault), 0);
	assert_int_equal(display_power(&display, true, &fault), 0);
	assert_int_equal(display_fit(&display, 640, 360, 1), 0);
	assert_int_equal(display_fit(&display, 1280, 720, 1), 0);
	assert_false(display.off);
	assert_int_equal(*value_of(CRTC, "ACTIVE"), 1);
	assert_int_equal(display_acquire(&display, &buffer), 0);
	for (size_t i = 0; i < buffer.stride * 720; i++)
		assert_int_equal(buffer.pixels[i], 0);
	submit(3, 1280, 720);
	assert_shown(3);
	/* What is gone when it is switched on is said, for the caller to open it again. */
	assert_int_equal(display_power(&display, false, &fault), 0);
	card.connection = DRM_MODE_DISCONNECTED;
	assert_int_equal(display_power(&display, true, &fault), -ENOLINK);
	assert_int_equal(display.situation, DISPLAY_NO_SCREEN);
	assert_int_equal(display_close(&display, &fault), 0);
	assert_int_equal(card.buffers, 0);
}

TEST_BETWEEN("the range is chosen and restored", plug_in, take_out)
{
	static const uint64_t values[] = {
		[KMS_RANGE_AUTO] = 7, [KMS_RANGE_FULL] = 3, [KMS_RANGE_LIMITED] = 5};
	struct captured_log log;
	char text[1000] = "";
	FILE *said;

	card.has_panel = true;
	for (int range = KMS_RANGE_AUTO; range <= KMS_RANGE_LIMITED; range++) {
		*value_of(CONNECTOR, "Broadcast RGB") = 5;
		options.range = range;
		open_fine();
		assert_int_equal(*value_of(CONNECTOR, "Broadcast RGB"), values[range]);
		assert_int_equal(display_close(&display, &fault), 0);
		assert_int_equal(*value_of(CONNECTOR, "Broadcast RGB"), 5);
	}
	/* A card that has no choice is no fault, but is said where one was asked for. */
	card.has_panel = false;
	log = captured_log_begin();
	for (int range = KMS_RANGE_AUTO; range <= KMS_RANGE_LIMITED; range += KMS_RANGE_LIMITED) {
		options.range = range;
		open_fine();
		assert_int_equal(*value_of(CONNECTOR, "Broadcast RGB"), 5);
		assert_int_equal(display_close(&display, &fault), 0);
	}
	said = captured_log_end(&log);
	assert_true(fread(text, 1, sizeof(text) - 1, said) > 0);
	fclose(said);
	assert_non_null(
		strstr(text, "HDMI-A-1: the card cannot choose the range \"Limited 16:235\""));
	assert_null(strstr(text, "Automatic"));
}

/* A picture that is white in its upper left corner: where that comes to lie in the card's
 * buffer. */
TEST_BETWEEN("panels that are turned turn the picture", plug_in, take_out)
{
	static const struct {
		int orientation, rotate, x, y;
	} cases[] = {
		{0, PICTURE_UPRIGHT, 0, 0},   {1, PICTURE_UPRIGHT, 1279, 719},
		{2, PICTURE_UPRIGHT, 0, 719}, {3, PICTURE_UPRIGHT, 1279, 0},
		{1, PICTURE_TURN_180, 0, 0},  {3, PICTURE_TURN_90, 1279, 719},
		{2, PICTURE_TURN_90, 0, 0},
	};

	card.has_panel = true;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct display_buffer buffer;
		const uint32_t *shown;
		bool sideways;

		*value_of(CONNECTOR, "panel orientation") = (uint64_t)cases[i].orientation;
		rotate = cases[i].rotate;
		open_fine();
		assert_int_equal(display_acquire(&display, &buffer), 0);
		sideways = picture_turn_is_sideways((enum picture_turn)display.settings.turn);
		assert_int_equal(buffer.width, sideways ? 720 : 1280);
		assert_int_equal(buffer.height, sideways ? 1280 : 720);
		memset(buffer.pixels, 0, buffer.stride * (size_t)buffer.height);
		memset(buffer.pixels, 255, 4);
		assert_int_equal(display_submit(&display, &buffer, 1, &fault), 0);
		shown = (const uint32_t *)(const void *)(display.whole.pixels +
							 (size_t)cases[i].y * display.whole.stride);
		if ((shown[cases[i].x] & 0xffffff) != 0xffffff)
			fail_msg("case %zu: the corner is elsewhere", i);
		assert_shown(1);
		assert_int_equal(display_close(&display, &fault), 0);
	}
	rotate = PICTURE_UPRIGHT;
}

TEST_BETWEEN("what cannot be opened", plug_in, take_out)
{
	card.held = true;
	assert_int_equal(open_it(), -EBUSY);
	assert_int_equal(display.situation, DISPLAY_BUSY);
	card.held = false;
	card.no_atomic = true;
	assert_int_equal(open_it(), -ENOTSUP);
	assert_int_equal(display.situation, DISPLAY_BROKEN);
	assert_non_null(strstr(fault.text, "atomic"));
	card.no_atomic = false;
	strcpy(options.mode, "huge");
	assert_int_equal(open_it(), -EINVAL);
	assert_int_equal(display.situation, DISPLAY_NO_MODE);
	assert_false(display_may_return(display.situation));
	options.mode[0] = 0;
	strcpy(options.connector, "HDMI-A-7");
	assert_int_equal(open_it(), -ENODEV);
	assert_non_null(strstr(fault.text, "HDMI-A-7"));
	options.connector[0] = 0;
	card.connection = DRM_MODE_UNKNOWNCONNECTION;
	open_fine(); /* there may be a screen */
	display_close(&display, NULL);
	card.mode_count = 0;
	/* probing a screen takes time: once is enough, even without a result */
	card.probes = 0;
	assert_int_equal(open_it(), -ENOLINK);
	assert_int_equal(card.probes, 1);
	options.force = true;
	card.connection = DRM_MODE_DISCONNECTED;
	open_fine();
	assert_int_equal(card.probes, 2);
	assert_int_equal(display.width, 1024);
	display_close(&display, NULL);
	assert_int_equal(card.buffers, 0);
}

/* ---- two screens ---- */

static void second_plug(int width, int height)
{
	card.connection_2 = DRM_MODE_CONNECTED;
	kms_timing(width, height, 60, &card.mode_2);
	strcpy(options.connector, "HDMI-A-1");
	strcpy(options.second, "HDMI-A-2");
}

static void assert_second(bool on, struct kms_box box)
{
	assert_int_equal(*value_of(CRTC_2, "ACTIVE"), on);
	assert_int_equal(*value_of(CONNECTOR_2, "CRTC_ID"), on ? CRTC_2 : 0);
	assert_int_equal(*value_of(PLANE_2, "CRTC_ID"), on ? CRTC_2 : 0);
	if (!on)
		return;
	assert_int_equal(*value_of(PLANE_2, "FB_ID"), *value_of(PLANE, "FB_ID"));
	assert_int_equal(*value_of(PLANE_2, "SRC_W"), (uint64_t)display.width << 16);
	assert_int_equal(*value_of(PLANE_2, "SRC_H"), (uint64_t)display.height << 16);
	assert_int_equal((int64_t)*value_of(PLANE_2, "CRTC_X"), box.x);
	assert_int_equal((int64_t)*value_of(PLANE_2, "CRTC_Y"), box.y);
	assert_int_equal(*value_of(PLANE_2, "CRTC_W"), box.width);
	assert_int_equal(*value_of(PLANE_2, "CRTC_H"), box.height);
}

static const struct kms_box nowhere;

static void frames_are_shown(int from, int to)
{
	for (int i = from; i < to; i++) {
		card.flip_ns += 16667000;
		submit(i, display.width, display.height);
		assert_shown(i);
	}
}

TEST_BETWEEN("two screens show one picture", plug_in, take_out)
{
	static const struct {
		int width, height;
		bool scales, shown;
		struct kms_box box;
	} cases[] = {
		{1280, 720, false, true, {0, 0, 1280, 720}},
		{1920, 1200, true, true, {0, 60, 1920, 1080}},
		{1024, 768, true, true, {0, 96, 1024, 576}},
		{1920, 1200, false, true, {320, 240, 1280, 720}},
		{1024, 768, false, false, {0}},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		second_plug(cases[i].width, cases[i].height);
		card.scales = cases[i].scales;
		card.flips = 0;
		open_fine();
		frames_are_shown(1, 6);
		assert_int_equal(card.flips, 5);
		assert_second(cases[i].shown, cases[i].box);
		assert_int_equal(display_fit(&display, 640, 480, 1), -ENOTSUP);
		assert_int_equal(display_close(&display, &fault), 0);
		assert_second(false, nowhere);
		assert_int_equal(card.blobs, 0);
		assert_int_equal(card.buffers, 0);
	}
}

/* Frames go on until the display has seen that a screen was plugged in or pulled out. */
static void frames_go_on(uint32_t connector, bool lit)
{
	const int64_t until_ns = clock_now_ns() + 60 * NS_PER_S;
	int token = 100;

	while ((*value_of(connector, "CRTC_ID") != 0) != lit) {
		assert_true(clock_now_ns() < until_ns);
		frames_are_shown(token, token + 1);
		token++;
		poll(NULL, 0, 50);
	}
}

TEST_BETWEEN("the second comes and goes", plug_in, take_out)
{
	const struct kms_box whole = {0, 0, 1280, 720};

	second_plug(1280, 720);
	card.connection_2 = DRM_MODE_DISCONNECTED;
	open_fine();
	frames_are_shown(1, 4);
	assert_second(false, nowhere);
	card.connection_2 = DRM_MODE_CONNECTED;
	frames_go_on(CONNECTOR_2, true);
	frames_are_shown(4, 8);
	assert_second(true, whole);
	card.connection_2 = DRM_MODE_DISCONNECTED;
	frames_go_on(CONNECTOR_2, false);
	assert_second(false, nowhere);
	assert_int_equal(*value_of(CRTC, "ACTIVE"), 1);
	assert_int_equal(display.situation, DISPLAY_FINE);
	display_close(&display, NULL);
	assert_int_equal(card.blobs, 0);
}

/* The first one unplugged ends the display, as ever; opened again, it shows on the other one. */
TEST_BETWEEN("each of the two is enough", plug_in, take_out)
{
	struct display_event event;

	second_plug(1280, 720);
	open_fine();
	frames_are_shown(1, 4);
	card.connection = DRM_MODE_DISCONNECTED;
	assert_int_equal(wait_for(&event, 60 * NS_PER_S), -ENOLINK);
	display_close(&display, NULL);
	open_fine();
	frames_are_shown(1, 4);
	assert_int_equal(*value_of(CONNECTOR, "CRTC_ID"), 0);
	assert_true(*value_of(CONNECTOR_2, "CRTC_ID") == CRTC ||
		    *value_of(CONNECTOR_2, "CRTC_ID") == CRTC_2);
	card.connection = DRM_MODE_CONNECTED;
	frames_go_on(CONNECTOR, true);
	frames_are_shown(4, 8);
	assert_int_equal(*value_of(PLANE, "FB_ID"), *value_of(PLANE_2, "FB_ID"));
	display_close(&display, NULL);
	card.connection = card.connection_2 = DRM_MODE_DISCONNECTED;
	assert_int_equal(open_it(), -ENOLINK);
	assert_non_null(strstr(fault.text, "HDMI-A-1 or HDMI-A-2"));
}

TEST_BETWEEN("both are switched off and on", plug_in, take_out)
{
	second_plug(1280, 720);
	open_fine();
	frames_are_shown(1, 4);
	assert_int_equal(display_power(&display, false, &fault), 0);
	assert_int_equal(*value_of(CRTC, "ACTIVE"), 0);
	assert_second(false, nowhere);
	assert_int_equal(display_power(&display, true, &fault), 0);
	frames_are_shown(4, 8);
	assert_int_equal(*value_of(CRTC, "ACTIVE"), 1);
	assert_second(true, (struct kms_box){0, 0, 1280, 720});
	display_close(&display, NULL);
	assert_int_equal(card.blobs, 0);
}

TEST_GROUP(own_folder_make, own_folder_remove);
