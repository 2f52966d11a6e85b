/* SPDX-License-Identifier: MIT */
/* The stream that libcamera writes its log to; what becomes of a message is messages.h's. */
#ifndef INLAY_DRIVERS_LIBCAMERA_LOG_STREAM_HPP
#define INLAY_DRIVERS_LIBCAMERA_LOG_STREAM_HPP

#include <ios>
#include <streambuf>

namespace libcamera_driver
{

/* A stream's buffer that hands on each message. */
class Messages : public std::streambuf
{
      protected:
	std::streamsize xsputn(const char *text, std::streamsize length) override;
	int overflow(int c) override;
};

/* libcamera's own log becomes ours, unless LIBCAMERA_LOG_FILE leads it elsewhere. Later calls do
 * nothing. */
void redirect_messages();

} // namespace libcamera_driver

#endif
