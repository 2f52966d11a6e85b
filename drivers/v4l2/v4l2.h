/* SPDX-License-Identifier: MIT */
/* The parts of camera_v4l2.c. fields.c, formats.c and h264_unit.c touch no device. */
#ifndef INLAY_DRIVERS_V4L2_V4L2_H
#define INLAY_DRIVERS_V4L2_V4L2_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/device/camera.h"
#include "hal/frame/frame.h"
#include "hal/ini/ini.h"

/* Opens a V4L2 capture device and calls its ioctls. */

/* Calls ioctl() until it is not interrupted. 0 or -errno. */
int device_ioctl(int fd, unsigned long request, void *argument);

/* Returns the capabilities of this node, not of the whole device. */
unsigned device_caps(const struct v4l2_capability *capability);

/* Whether a node of these capabilities captures pictures and streams. */
bool device_captures(unsigned caps);

/* Whether the node is one of many in the pipeline of a media controller, or an image processor's.
 * It gives pictures only after another program has set the pipeline up, as libcamera does. */
bool device_is_part(const struct v4l2_capability *capability);

/* The name on a device's card, valid UTF-8. */
void device_name(const uint8_t card[32], char *name, size_t room);

/* Returns the V4L2_BUF_TYPE_* of a capturing node: single-planar if it has both kinds. */
unsigned device_buffer_type(const struct v4l2_capability *capability);

/* Opens path, non-blocking. Returns a descriptor that the caller closes, or -errno: -ENOTTY not a
 * V4L2 device, -ENODEV one that does not capture. capability may be NULL. */
int device_open(const char *path, struct v4l2_capability *capability, struct fault *fault);

/* Interprets V4L2's fields of interlaced video, and pairs single fields. Pure: touches no
 * device. */

/* The key v4l2.field: which arrangement of fields the device is asked for. */
enum v4l2_field_wish {
	V4L2_WISH_DRIVER,
	V4L2_WISH_NONE,
	V4L2_WISH_INTERLACED,
	V4L2_WISH_SEQUENTIAL,
	V4L2_WISH_ALTERNATE,
	V4L2_WISH_TOP,
	V4L2_WISH_BOTTOM,
	V4L2_WISH_COUNT
};

extern const char *const v4l2_field_wish_names[]; /* "driver", "none", ... NULL */

/* Returns the V4L2_FIELD_* to ask for. Sequential fields begin with the one that the standard sends
 * first. */
uint32_t v4l2_field_asked(enum v4l2_field_wish wish, v4l2_std_id standard);

struct v4l2_lines {
	enum frame_fields fields; /* of a whole frame: alternating fields become a pair */
	bool bottom_first;	  /* the bottom field is the earlier one */
	bool one_field;		  /* a buffer holds one field, half the picture's height */
};

/* Interprets the V4L2_FIELD_* of a format under a standard (0: not television). 525-line television
 * sends the bottom field first, everything else the top field. */
struct v4l2_lines v4l2_lines_of(uint32_t field, v4l2_std_id standard);

/* The same for the field of a buffer. It may be more specific than that of its format, but a buffer
 * cannot hold less than the format says. */
struct v4l2_lines v4l2_lines_of_buffer(const struct v4l2_lines *format, uint32_t field,
				       v4l2_std_id standard);

/* Returns "progressive", "interlaced, bottom field first", ... */
const char *v4l2_lines_text(const struct v4l2_lines *lines);

/*
 * Pairs fields that come one by one. Two successive fields with the same sequence number are a
 * frame. Some drivers number fields, although V4L2 asks for numbers of frames. A run of differing
 * numbers reveals such a driver; then a frame is the field that the standard sends first together
 * with the next one.
 */
struct v4l2_pairing {
	bool waiting, bottom;		   /* a first field waits; it is the bottom one */
	uint32_t sequence;		   /* its number */
	bool counts_frames, counts_fields; /* both false: not known yet */
	int run;			   /* successive fields with differing numbers */
};

enum v4l2_pair {
	V4L2_PAIR_FIRST,  /* the field waits for its partner */
	V4L2_PAIR_SECOND, /* the field completes the waiting one */
	V4L2_PAIR_ORPHAN, /* the waiting field stays alone; the new one waits in its place */
};

/* Says how the next field pairs up. bottom_first: what the standard sends. */
enum v4l2_pair v4l2_pairing_take(struct v4l2_pairing *pairing, uint32_t sequence, bool bottom,
				 bool bottom_first);

/* Translates V4L2's formats and colours to those of inlay. Pure: touches no device. */

struct v4l2_layout {
	uint32_t fourcc;
	enum pixel_format format;
	int memory_planes; /* separate buffers for one picture */
};

/* Returns the layout of a format. NULL: inlay does not decode it. */
const struct v4l2_layout *v4l2_layout_of(uint32_t fourcc);

/* The same, as the wanted format if its bytes can be read as that too. */
const struct v4l2_layout *v4l2_layout_as(uint32_t fourcc, enum pixel_format wanted);

/* A format that a device offers. */
struct v4l2_offer {
	uint32_t fourcc;
	bool size; /* it has the wanted size, or none is wanted */
	bool rate; /* it has the wanted rate at that size, or none is wanted */
};

/* Returns the index of the offer of the greatest camera_format_merit() among those of the wanted
 * format (PIXEL_NONE: of any); -1: none. */
int v4l2_choose(const struct v4l2_offer *offers, int count, enum pixel_format wanted);

/* Reads the matrix and range that the driver declares; its defaults are resolved as the kernel's
 * documentation says. Matrices that inlay lacks (SMPTE 240M, BT.2020) become BT.709, the
 * nearest. */
void v4l2_colours(const struct v4l2_pix_format *format, enum colour_matrix *matrix,
		  enum colour_range *range);

/* A format as the driver set it, single- or multi-planar alike. */
struct v4l2_picture {
	const struct v4l2_layout *layout;
	int width, height; /* of the whole picture */
	int rows;	   /* in a buffer: height, or half of it when a buffer holds one field */
	struct v4l2_lines lines;
	v4l2_std_id standard;
	size_t stride[FRAME_PLANES]; /* bytes, of the frame's planes; 0 for JPEG and H.264 */
	enum colour_matrix matrix;
	enum colour_range range;
};

/* Reads a format that the driver returned, under this television standard (0: none). If a single
 * field has the height that was asked for the whole picture (wanted_height; 0: none), the picture
 * counts as progressive: the device has squeezed it. 0; -ENOTSUP: inlay does not decode the format;
 * -EINVAL: no size, a stride (0: not told) too small for the width, or a height that cannot be
 * split into fields. */
int v4l2_picture_of(const struct v4l2_format *format, v4l2_std_id standard, int wanted_height,
		    struct v4l2_picture *picture, struct fault *fault);

struct v4l2_span {
	const uint8_t *data;
	size_t bytes; /* that hold data */
};

/* Points the frame's planes into a buffer's memory (one or two planes). False: the buffer holds
 * too few bytes. */
bool v4l2_fill_planes(const struct v4l2_picture *picture, const struct v4l2_span memory[2],
		      struct frame_plane planes[FRAME_PLANES]);

/* Returns the bits of a pixel on the bus; for JPEG and H.264 an estimate. 0: inlay does not decode
 * it. */
int v4l2_bits(uint32_t fourcc);

/* Writes the four characters of a format, like "YUYV"; unprintable ones become dots. */
void v4l2_fourcc_text(uint32_t fourcc, char text[5]);

/* Asks a V4L2 device which formats, sizes and rates it offers. */

/* Converts a frame interval to a rate in Hz; 0: the device does not know it. */
double v4l2_rate_of(const struct v4l2_fract *interval);

/* Whether a node offers depths, or (depth false) anything else. The nodes of a depth camera have
 * one name and one bus. A node that lists no formats may have pictures. */
bool v4l2_offers_kind(int fd, unsigned type, bool depth);

/* Whether the device offers a size or rate; 0 means any. A device that does not enumerate them may
 * have all. */
bool v4l2_offers_size(int fd, uint32_t fourcc, int width, int height);
bool v4l2_offers_rate(int fd, uint32_t fourcc, int width, int height, double rate_hz);

/* Replaces the size by the next smaller one of the same shape. False: there is none. */
bool v4l2_smaller_size(int fd, uint32_t fourcc, int *width, int *height);

/* Replaces the rate by the next lower one at this size. False: there is none. */
bool v4l2_slower_rate(int fd, uint32_t fourcc, int width, int height, double *rate_hz);

/* Sets up what a digitizer receives: its input, television standard or HDMI timings; and checks the
 * signal. */

/* The driver's own keys: [camera NAME] v4l2.*. */
struct v4l2_options {
	char input[INI_TEXT_MAX];    /* number or name; empty: the present one */
	char standard[INI_TEXT_MAX]; /* empty: as detected */
	int field;		     /* enum v4l2_field_wish */
};

struct v4l2_source {
	int input;	      /* -1: the device has no inputs */
	v4l2_std_id standard; /* 0: not television */
	bool tells;	      /* the device reports changes by events */
};

/* Selects the input, sets the television standard or HDMI timings as configured or as detected, and
 * subscribes to events about changes. 0; -EINVAL: no such input or standard; -ENOLINK: no signal;
 * -ENOLCK: the signal is not stable; -ERANGE: the device cannot receive this signal. */
int v4l2_setup_input(int fd, const struct v4l2_options *options, struct v4l2_source *source,
		     struct fault *fault);

/* Checks that there is a stable signal. 0; -ENOLINK, -ENOLCK with a fault. */
int v4l2_check_signal(int fd, const struct v4l2_source *source, struct fault *fault);

/* Reads pending events. True: one says that the source now sends another format. */
bool v4l2_source_changed(int fd);

/* Whether two names of standards or inputs are the same up to case and punctuation. */
bool v4l2_same_name(const char *a, const char *b);

/* Sets format, size, fields and rate of a V4L2 device, before buffers are requested. */

/* Chooses and sets format, size, fields and rate as near to the settings as the device can, and
 * reads back what the device really uses; *rate_hz becomes 0 if it does not tell. type is
 * V4L2_BUF_TYPE_*. 0 or -errno with a fault; after -ENOSPC *picture is what was asked for. */
int v4l2_setup_picture(int fd, unsigned type, const struct camera_settings *settings,
		       enum v4l2_field_wish wish, const struct v4l2_source *source,
		       struct v4l2_picture *picture, double *rate_hz, struct fault *fault);

/* Chooses what to ask for when the bus has no room: a smaller format, a smaller size or a lower
 * rate, in the order of camera_settings.give_up and no further than it allows. */

enum v4l2_sacrifice { V4L2_GIVE_FORMAT, V4L2_GIVE_SIZE, V4L2_GIVE_RATE, V4L2_GIVE_COUNT };

struct v4l2_fallback {
	enum v4l2_sacrifice order[V4L2_GIVE_COUNT];
	int count, next; /* order[next] is the sacrifice to make now */
};

/* Reads settings.give_up. 0; -EINVAL: a word other than "format", "size", "rate", or one twice. */
int v4l2_fallback_read(struct v4l2_fallback *fallback, const char *give_up, struct fault *fault);

/* Reduces the settings by one step, starting from the picture that the device had chosen. False: no
 * sacrifice is left. */
bool v4l2_fallback_step(struct v4l2_fallback *fallback, int fd, unsigned type,
			const struct v4l2_picture *picture, double rate_hz,
			struct camera_settings *settings);

/* Writes "640x480 MJPEG at 15 Hz"; a rate of 0 is left out. */
void v4l2_describe(const struct v4l2_picture *picture, double rate_hz, char *text, size_t room);

/* A device's controls by name: set from the configuration at each opening, listed for people. */

enum { V4L2_CONTROLS_MAX = 32, V4L2_CONTROL_NAME_MAX = 64 };

struct v4l2_setting {
	struct camera_control said;
	struct v4l2_query_ext_ctrl control; /* id 0: not looked up, or given up */
	int64_t wanted, taken;		    /* from the configuration; read back */
};

struct v4l2_settings {
	struct v4l2_setting list[V4L2_CONTROLS_MAX];
	int count;
};

/* Reads camera_settings.controls. 0; -EINVAL: malformed, or too many. */
int v4l2_controls_read(struct v4l2_settings *settings, const char *text, struct fault *fault);

/* Sets the controls in the order in which they are written, because a driver refuses a manual value
 * while its automatic is on. Reads each one back. A control that is refused or reads back as
 * another value is logged, once however often the camera is opened, and does not stop the rest.
 * path begins the messages. */
void v4l2_controls_apply(int fd, const char *path, struct v4l2_settings *settings);

/* Call it once the device streams: sets those controls again that starting has changed. */
void v4l2_controls_confirm(int fd, const char *path, struct v4l2_settings *settings);

/* Changes one control while the camera runs. 0; -EINVAL: unknown control or malformed value;
 * -ERANGE; other -errno of the device, with a fault. If the device rounds the number, *taken
 * becomes what it uses, and this is logged. */
int v4l2_control_change(int fd, const char *path, const char *name, const char *value,
			double *taken, struct fault *fault);

/* Converts a control's name to the form of the configuration (and of v4l2-ctl):
 * "White Balance, Automatic" becomes white_balance_automatic. */
void v4l2_control_name(const char *said, char name[V4L2_CONTROL_NAME_MAX]);

/* Replaces *control by the next one (id 0: the first) whose value is one number. False: no more. */
bool v4l2_next_control(int fd, struct v4l2_query_ext_ctrl *control);

/* Writes a menu's entry as text. False: the menu has no entry of this index. */
bool v4l2_menu_entry(int fd, const struct v4l2_query_ext_ctrl *control, int64_t index,
		     char text[V4L2_CONTROL_NAME_MAX]);

int v4l2_get_control(int fd, const struct v4l2_query_ext_ctrl *control, int64_t *value);

/* The buffers that a V4L2 device and the program exchange: memory mapped streaming. */

enum { V4L2_BUFFERS_MAX = 16, V4L2_PLANES_MAX = 2 };

struct v4l2_mapping {
	uint8_t *memory; /* NULL: not mapped */
	size_t length;
};

struct v4l2_buffers {
	int fd;
	unsigned type;	   /* V4L2_BUF_TYPE_VIDEO_CAPTURE or _MPLANE */
	int memory_planes; /* separate mappings for one buffer, 1 or 2 */
	int count;	   /* buffers */
	bool streaming;
	struct v4l2_mapping mappings[V4L2_BUFFERS_MAX][V4L2_PLANES_MAX];
};

bool v4l2_multiplanar(const struct v4l2_buffers *buffers);

/* Whether the device is free. fd and type are set; nothing is started. 0; -EBUSY: another program
 * has buffers of the device, so its settings must not be changed. */
int v4l2_buffers_try(const struct v4l2_buffers *buffers, struct fault *fault);

/* Requests and maps buffers, queues all of them and starts streaming. fd, type and memory_planes
 * are set. After a failure no buffer is left, so that the format can be set again. */
int v4l2_buffers_start(struct v4l2_buffers *buffers, int wanted, struct fault *fault);

/* Stops streaming and frees the buffers. Idempotent; accepts a zeroed struct. */
void v4l2_buffers_stop(struct v4l2_buffers *buffers);

/* Gives a buffer back to the device. 0 or -errno. */
int v4l2_buffers_queue(const struct v4l2_buffers *buffers, int index);

/* Takes the next filled buffer. planes must outlive buffer. 0; -EAGAIN: none yet; other -errno. */
int v4l2_buffers_take(const struct v4l2_buffers *buffers, struct v4l2_buffer *buffer,
		      struct v4l2_plane planes[VIDEO_MAX_PLANES]);

/*
 * Looks into an access unit of H.264 for what libavcodec does not tell: where its parameter sets
 * are, and whether one that it is decoded from is missing. Reference pictures are counted by
 * frame_num (H.264 7.4.3); libavcodec makes a missing one up. Pure.
 */

/* State of a stream; zeroed: nothing was seen yet. */
struct h264_count {
	unsigned bits;	    /* of frame_num; 0: not known */
	bool begun;	    /* reference is valid */
	unsigned reference; /* frame_num of the last reference picture */
};

struct h264_unit {
	bool picture;	/* it holds a part of a picture */
	bool gap;	/* a picture that this one may need is missing */
	bool sequence;	/* the parameter sets begin with that of the sequence */
	size_t sets_at; /* where they begin, with a start code */
	size_t sets_bytes;
};

/* Reads an access unit, with start codes; any bytes. */
struct h264_unit h264_unit_read(struct h264_count *count, const uint8_t *data, size_t bytes);

/*
 * Decodes the H.264 of a camera by FFmpeg's libavcodec, which is loaded when the first such camera
 * is opened: most machines have none, and it brings a hundred libraries.
 *
 * A picture is decoded from earlier ones, so the decoder has to see every access unit. After one
 * that is damaged or lost nothing comes out until a picture that needs no earlier one.
 */

struct h264_decoder;

/* Loads the library. 0; -ENOTSUP: built without the decoder, or the library is not installed. */
int h264_available(struct fault *fault);

/* 0; -ENOMEM; -ENOTSUP. */
int h264_create(struct h264_decoder **decoder, struct fault *fault);
void h264_destroy(struct h264_decoder *decoder); /* NULL is harmless */

/* Decodes one access unit, with start codes. Sets format, size, planes and, where the stream tells
 * them, matrix and range of *frame; the planes stay valid until the next picture is decoded. 0;
 * -EAGAIN: it holds no picture; -EBADMSG: it is damaged, or needs one that was; -ENOTSUP: no 4:2:0
 * of 8 bits; -ENOMEM. */
int h264_decode(struct h264_decoder *decoder, const uint8_t *data, size_t bytes,
		struct frame *frame, struct fault *fault);

/* Tells the decoder that an access unit is missing. */
void h264_skip(struct h264_decoder *decoder);

/* Finds the camera that a name in the configuration means. */

enum { V4L2_DEVICES_MAX = 256, V4L2_PORT_MAX = 32 };

/*
 * Opens the camera of this name: a path (it begins with /); the name of a link in /dev/v4l/by-id or
 * /dev/v4l/by-path; the driver's name for the card or the bus ("usb-0000:00:14.0-2"); a USB port
 * ("1-2"); empty: the first node that captures. All forms but a path stay valid when the kernel
 * renumbers nodes; the search is made at each call. If several cards have the name, the first is
 * opened and the others are logged. A depth camera has several nodes: of those that the name fits,
 * one that offers depths (depth) or pictures goes before one that does not. path receives the node.
 * Returns a descriptor or -errno, as device_open().
 */
int v4l2_find(const char *name, bool depth, char path[INI_PATH_MAX],
	      struct v4l2_capability *capability, struct fault *fault);

/* Extracts the port, "1-2.4", from the name of a USB interface, "1-2.4:1.0". False: not such a
 * name. */
bool v4l2_usb_port(const char *interface, char port[V4L2_PORT_MAX]);

/* Finds the USB port of /dev/videoN. False: the device is not on USB. */
bool v4l2_port_of_node(int number, char port[V4L2_PORT_MAX]);

/* Lists formats, inputs and controls of V4L2 cameras as lines for people. */

/* camera_ops.list of V4L2: calls found() for each camera and returns their number. */
int v4l2_list(void (*found)(void *context, const struct camera_listing *listing), void *context);

/* A V4L2 camera that streams. Makes pictures of its buffers: one buffer for each, or two if every
 * field comes in a buffer of its own. */

/* A captured picture: one buffer, or two that hold a field each. */
struct v4l2_taken {
	struct frame frame; /* format PIXEL_NONE: there is no picture */
	int buffers[2];	    /* -1: none */
};

struct v4l2_capture {
	int fd, events; /* events: an epoll of fd; -1: the device sends no events */
	char path[INI_PATH_MAX];
	struct v4l2_source source;
	struct v4l2_picture picture;
	struct v4l2_buffers buffers;
	struct v4l2_settings controls;
	struct v4l2_pairing pairing;
	struct v4l2_taken waiting; /* the first field of a pair */
	struct h264_decoder *h264; /* NULL: the device sends something else */
	bool h264_ended;	   /* no picture until the next key frame */
	bool said_short;	   /* that a frame was too short */
	struct v4l2_taken out;	   /* handed to the caller of grab() */
	struct frame_count count;
	int64_t signal_checked_ns;
	int64_t stamp_ns; /* the driver's last time stamp; 0: none that can be */
};

extern const struct v4l2_taken v4l2_nothing;

/* Takes one buffer from the driver. *t stays empty if the buffer is damaged or is the first field
 * of a pair. 0; -EAGAIN: no buffer yet; other -errno of taking or queueing. */
int v4l2_take(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *t);

/* Queues the buffers of *t again and empties it. 0, or the first error of queueing. */
int v4l2_give_back(struct v4l2_capture *v, struct v4l2_taken *t);

#endif
