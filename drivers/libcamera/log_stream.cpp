/* SPDX-License-Identifier: MIT */
/* libcamera may write from any of its threads until the process ends. */
#include "drivers/libcamera/driver.hpp"

#include <cstdlib>
#include <mutex>
#include <ostream>

extern "C" {
#include "drivers/libcamera/parts.h"
}

namespace libcamera_driver
{

/* libcamera writes each message whole, in one call. */
std::streamsize Messages::xsputn(const char *text, std::streamsize length)
{
	libcamera_message(text, (size_t)length);
	return length;
}

int Messages::overflow(int c)
{
	return c == EOF ? 0 : c;
}

void redirect_messages()
{
	static std::once_flag once;

	std::call_once(once, [] {
		/* Never destroyed: libcamera's threads and destructors may still write at exit. */
		static std::ostream *const stream = new std::ostream(new Messages);

		if (!getenv("LIBCAMERA_LOG_FILE"))
			lc::logSetStream(stream);
	});
}

} // namespace libcamera_driver
