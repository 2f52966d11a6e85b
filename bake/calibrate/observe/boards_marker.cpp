/* SPDX-License-Identifier: MIT */
/* OpenCV's dictionaries of markers, and their bits for printing. */
#include <algorithm>

#include "bake/calibrate/observe/boards_opencv.hpp"

/* In the order of their names in boards_parts.h. */
const marker_set marker_sets[BOARD_DICTIONARIES] = {
	{"5x5", 5, 1000},	    {"4x4", 4, 1000},
	{"6x6", 6, 1000},	    {"7x7", 7, 1000},
	{"original", 5, 1024},	    {"apriltag_16h5", 4, 30},
	{"apriltag_25h9", 5, 35},   {"apriltag_36h10", 6, 2320},
	{"apriltag_36h11", 6, 587},
};

int boards::opencv_dictionary(int dictionary, int markers)
{
	static const int smallest[BOARD_ORIGINAL] = {cv::aruco::DICT_5X5_50, cv::aruco::DICT_4X4_50,
						     cv::aruco::DICT_6X6_50,
						     cv::aruco::DICT_7X7_50};
	static const int others[] = {cv::aruco::DICT_ARUCO_ORIGINAL, cv::aruco::DICT_APRILTAG_16h5,
				     cv::aruco::DICT_APRILTAG_25h9, cv::aruco::DICT_APRILTAG_36h10,
				     cv::aruco::DICT_APRILTAG_36h11};

	if (dictionary >= BOARD_ORIGINAL)
		return others[dictionary - BOARD_ORIGINAL];
	return smallest[dictionary] + (markers > 50) + (markers > 100) + (markers > 250);
}

namespace
{

cv::Mat all_codes(int dictionary)
{
	const int number = boards::opencv_dictionary(dictionary, marker_sets[dictionary].markers);

#if ARUCO_IN_OBJDETECT
	return cv::aruco::getPredefinedDictionary(number).bytesList;
#else
	return cv::aruco::getPredefinedDictionary(number)->bytesList;
#endif
}

} // namespace

extern "C" bool board_marker_bit(int dictionary, int marker, int column, int row)
{
	static cv::Mat codes[BOARD_DICTIONARIES];
	const int side = marker_sets[dictionary].bits;
	const int bit = row * side + column, byte = bit / 8;
	/* The last byte holds fewer bits, and has them at its lower end. */
	const int bits = std::min(8, side * side - 8 * byte);

	if (codes[dictionary].empty())
		codes[dictionary] = all_codes(dictionary);
	return codes[dictionary].ptr(marker)[byte] >> (bits - 1 - bit % 8) & 1;
}
