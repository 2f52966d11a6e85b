/* SPDX-License-Identifier: MIT */
/* The stream that libcamera writes its log to. messages.h handles each message. */
#ifndef INLAY_DRIVERS_LIBCAMERA_LOG_STREAM_HPP
#define INLAY_DRIVERS_LIBCAMERA_LOG_STREAM_HPP

#include <ios>
#include <streambuf>

namespace libcamera_driver
{

/* A stream buffer that passes each message to libcamera_message(). */
class Messages : public std::streambuf
{
      protected:
	std::streamsize xsputn(const char *text, std::streamsize length) override;
	int overflow(int c) override;
};

/* Sends libcamera's log to inlay's, unless LIBCAMERA_LOG_FILE is set. Later calls do nothing. */
void redirect_messages();

} // namespace libcamera_driver

#endif
