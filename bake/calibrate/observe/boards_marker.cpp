/* SPDX-License-Identifier: MIT */
/* The bits of ArUco markers, for printing. */
#include <algorithm>

#include "bake/calibrate/observe/boards_aruco.hpp"

extern "C" {
#include "bake/calibrate/observe/boards_parts.h"
}

namespace
{

cv::Mat all_codes()
{
#if ARUCO_IN_OBJDETECT
	return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000).bytesList;
#else
	return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000)->bytesList;
#endif
}

} // namespace

extern "C" bool board_marker_bit(int marker, int column, int row)
{
	static const cv::Mat codes = all_codes();
	const int bit = row * BOARD_MARKER_BITS + column;
	const int byte = bit / 8;
	/* The last byte holds fewer bits, and has them at its lower end. */
	const int bits = std::min(8, BOARD_MARKER_BITS * BOARD_MARKER_BITS - 8 * byte);

	return codes.ptr(marker)[byte] >> (bits - 1 - bit % 8) & 1;
}
