/* SPDX-License-Identifier: MIT */
/* The parts of camera_libcamera.cpp that know libcamera. They report failures by exceptions. */
#ifndef INLAY_DRIVERS_LIBCAMERA_DRIVER_HPP
#define INLAY_DRIVERS_LIBCAMERA_DRIVER_HPP

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <ios>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <sys/types.h>
#include <vector>

#include <libcamera/libcamera.h>

extern "C" {
#include "drivers/libcamera/parts.h"
#include "hal/device/camera.h"
#include "hal/frame/frame.h"
}

/* Tests the version of libcamera. */
#define LIBCAMERA_AT_LEAST(major, minor)                                                           \
	(LIBCAMERA_VERSION_MAJOR > (major) ||                                                      \
	 (LIBCAMERA_VERSION_MAJOR == (major) && LIBCAMERA_VERSION_MINOR >= (minor)))

namespace libcamera_driver
{

namespace lc = libcamera;

/* The exception of this driver. It carries the errno and the situation that the screen shows. */

class Failure : public std::runtime_error
{
      public:
	/* Uses the situation that code usually means. */
	Failure(int code, const std::string &text) : Failure(code, text, camera_situation_of(code))
	{
	}

	Failure(int code, const std::string &text, camera_situation what)
	    : std::runtime_error(text), err(code), situation(what)
	{
	}

	const int err; /* negative errno */
	const camera_situation situation;
};

/* Makes a Failure from an error of libcamera and what was tried. */
inline Failure refusal(int err, const std::string &tried)
{
	return {err, err == -ENOSPC ? "the bus has no room for its pictures: ask for a smaller "
				      "size or a lower rate"
				    : tried + ": " + strerror(-err)};
}

/* Chooses a camera's format and size, and describes the pictures that result. */

struct Layout {
	lc::PixelFormat theirs; /* libcamera's */
	pixel_format ours;	/* inlay's */
};

/* Translates a format of libcamera's. PIXEL_NONE: inlay does not decode it. */
pixel_format format_of(const lc::PixelFormat &theirs);

/* Whether the range holds more than one size. */
bool is_range(const lc::SizeRange &range);

/* Returns the formats to try, best first; only `wanted`, unless that is PIXEL_NONE. For a camera
 * that does not enumerate formats these are all that inlay decodes. */
std::vector<Layout> candidates(const lc::StreamFormats &formats, int wanted, lc::Size size);

/* Returns libcamera's proposal for a viewfinder, one stream. NULL: the camera offers none. */
std::unique_ptr<lc::CameraConfiguration> proposal(lc::Camera &device);

/* Configures the camera with the first candidate that it accepts, and returns the configuration.
 * libcamera may change the size, but not the format. Throws Failure. */
std::unique_ptr<lc::CameraConfiguration> configure(lc::Camera &device,
						   const camera_settings &settings);

/* Returns a frame with what all frames of a stream share: format, size, colours. */
frame blank_frame(const lc::StreamConfiguration &stream, const camera_settings &settings);

/* Converts controls between libcamera's types and those of controls.h. */

/* Returns the controls that a camera has; they point into known. */
std::vector<libcamera_control> controls_of(const lc::ControlInfoMap &known);

/* Returns the names of a control's values, where this version of libcamera knows them. */
std::map<int32_t, std::string> words_of(const lc::ControlId &id);

libcamera_value numbers_of(const lc::ControlValue &value);

/* Puts the wishes that are due into the controls of the next request. Returns which they are. */
libcamera_load put_wishes(libcamera_wishes &wishes, lc::ControlList &controls);

/* Fetches what the camera used for a control: get() of libcamera_wishes_compare(). metadata is a
 * lc::ControlList. */
bool used_value(const void *metadata, const void *theirs, libcamera_value *value) noexcept;

/* Lists the formats and controls of cameras as lines for people. */

/* camera_ops.list of libcamera. Returns the number of cameras. Throws Failure if no manager
 * starts. */
int list(void (*found)(void *context, const camera_listing *listing), void *context);

/* The stream that libcamera writes its log to. messages.h handles each message. */

/* A stream buffer that passes each message to libcamera_message(). */
class Messages : public std::streambuf
{
      protected:
	std::streamsize xsputn(const char *text, std::streamsize length) override;
	int overflow(int c) override;
};

/* Sends libcamera's log to inlay's, unless LIBCAMERA_LOG_FILE is set. Later calls do nothing. */
void redirect_messages();

/* libcamera's camera manager: which cameras there are, and which one the settings mean. */

struct Library;

/* A share in libcamera's manager. A process may have only one at a time; it lives as long as there
 * are shares. It knows only the devices that were there when it started: to find another one, all
 * owners of shares must give them up. */
class Manager
{
      public:
	Manager();
	~Manager();
	Manager(const Manager &) = delete;
	Manager &operator=(const Manager &) = delete;

	std::vector<std::shared_ptr<lc::Camera>> cameras() const;

	/* Finds the camera that camera_settings.device means. Throws Failure: none, or several. */
	std::shared_ptr<lc::Camera> find(const char *wanted) const;

	/* True: give the share up, because a camera is wanted that may have come since the
	 * start. */
	bool is_outdated() const;

	/* Makes the manager forget a lost camera, so that it may return under its name: libcamera
	 * aborts if two cameras have one name. */
	void forget(const std::shared_ptr<lc::Camera> &camera) const;

	/* Whether a device number (st_rdev) belongs to this camera. */
	bool made_of(const std::shared_ptr<lc::Camera> &camera, dev_t number) const;

      private:
	void want_others() const;

	std::shared_ptr<Library> library;
};

/* Returns the camera's model; empty: not known. */
std::string model_of(const lc::Camera &device);

/* A camera's buffers, each with its request and the picture mapped in it. */

struct Slot {
	std::unique_ptr<lc::Request> request; /* its cookie is the slot's index */
	const lc::FrameBuffer *buffer;
	libcamera_picture picture;
	libcamera_load load; /* the controls that the request carries */
};

class Slots
{
      public:
	Slots() = default;
	~Slots();
	Slots(const Slots &) = delete;
	Slots &operator=(const Slots &) = delete;

	/* Allocates the buffers of a configured camera. blank: what all frames share. Throws
	 * Failure. */
	void make(const std::shared_ptr<lc::Camera> &device, const lc::StreamConfiguration &stream,
		  const frame &blank);

	/* Both are idempotent. */
	void unmap(); /* the memory only */
	void clear(); /* everything; call it before the camera is released */

	size_t count() const;
	Slot &operator[](size_t index);

	/* Reads the frame of a slot whose request is completed. False: cancelled, damaged, or not a
	 * whole picture. */
	bool read(const Slot &slot, frame *frame) const;

      private:
	void map(Slot &slot, const lc::StreamConfiguration &stream) const;

	std::unique_ptr<lc::FrameBufferAllocator> allocator;
	std::deque<Slot> slots;
	frame blank = {};
};

/* A camera while it is open: requests circulate, and the newest frame is handed out. */

/* The functions open() to control() are the ops of camera_ops; all but descriptor() may throw. The
 * destructor cleans up however far open() came. */
class Session
{
      public:
	Session();
	~Session();
	Session(const Session &) = delete;
	Session &operator=(const Session &) = delete;

	void open(camera *camera);
	int descriptor() const;
	int grab(camera *camera, frame *frame);
	void release(size_t index); /* frame.buffer */
	int control(const char *name, const char *value, fault *fault);

	/* Deletes the session, unless the camera is lost in a way that libcamera cannot clean up
	 * after: then it is kept for ever, but gives up its share in the manager. */
	static void end(std::unique_ptr<Session> session);

	std::string id; /* the camera's; empty until it is found */

      private:
	void take(camera *camera);
	void watch();
	void start();
	void queue(Slot &slot);
	void requeue(Slot &slot);
	void accept(Slot &slot, camera *camera, frame *newest);
	Failure why_over() const;
	void read_metadata(camera *camera, const lc::ControlList &metadata);
	bool can_be_deleted();

	std::optional<Manager> manager = std::make_optional<Manager>(); /* destroyed last */
	libcamera_events events;
	std::shared_ptr<lc::Camera> device;
	bool acquired = false;
	std::unique_ptr<lc::CameraConfiguration> configuration;
	Slots slots;
	std::vector<libcamera_control> controls;
	libcamera_wishes wishes = {};
	int trouble = 0; /* -errno of a request that libcamera refused; 0: none */
	frame_count count = {};
};

} // namespace libcamera_driver

#endif
