/* SPDX-License-Identifier: MIT */
/* The dictionaries of markers, their bits for printing, and the markers of a ChArUco board in a picture. */
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include <opencv2/core/version.hpp>

/* ArUco moved from contrib to objdetect with 4.7. */
#define ARUCO_IN_OBJDETECT (CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407)
#if ARUCO_IN_OBJDETECT
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

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

namespace
{

using boards::Marker;

void detect_markers(const cv::Mat &grey, int dictionary, std::vector<boards::Points> &corners,
		    std::vector<int> &numbers)
{
#if ARUCO_IN_OBJDETECT
	const cv::aruco::ArucoDetector detector(cv::aruco::getPredefinedDictionary(dictionary));

	detector.detectMarkers(grey, corners, numbers);
#else
	cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(dictionary), corners,
				 numbers);
#endif
}

std::vector<Marker> markers_on(const board &wanted, const std::vector<boards::Points> &corners,
			       const std::vector<int> &numbers)
{
	std::vector<Marker> markers;

	for (int r = 0; r < wanted.rows; r++)
		for (int c = 0; c < wanted.columns; c++) {
			const int number = board_marker_at(&wanted, c, r);
			const auto at = std::find(numbers.begin(), numbers.end(), number);

			if (number >= 0 && at != numbers.end())
				markers.push_back({c, r, corners[(size_t)(at - numbers.begin())]});
		}
	return markers;
}

} // namespace

/* The corners of a marker in the board's axes, mm. */
boards::Points boards::marker_flat(const board &wanted, const Marker &marker)
{
	const float x = (float)((marker.column - 0.5) * wanted.step_mm);
	const float y = (float)((marker.row - 0.5) * wanted.step_mm);
	const float half = (float)wanted.marker_mm / 2;

	return {{x - half, y - half},
		{x + half, y - half},
		{x + half, y + half},
		{x - half, y + half}};
}

namespace
{

/*
 * Counts the pairs of markers at a corner whose places agree with the board, less twice those that
 * do not: one marker's own homography says where the other should be, to half a square. A board of
 * other numbers, or with its squares exchanged, has its neighbours two squares from there.
 */
int agreement(const board &wanted, const std::vector<Marker> &markers)
{
	int sum = 0;

	for (const Marker &one : markers)
		for (const Marker &other : markers) {
			boards::Points middle = {{0, 0}}, expected;
			cv::Point2f seen(0, 0);

			if (std::abs(one.column - other.column) != 1 ||
			    std::abs(one.row - other.row) != 1)
				continue;
			const boards::Points flat = boards::marker_flat(wanted, one);
			const cv::Mat plane = cv::getPerspectiveTransform(flat, one.corner);
			const double scale = wanted.step_mm / wanted.marker_mm *
					     cv::norm(one.corner[0] - one.corner[2]);

			for (const cv::Point2f &corner : boards::marker_flat(wanted, other))
				middle[0] += corner / 4;
			for (const cv::Point2f &corner : other.corner)
				seen += corner / 4;
			cv::perspectiveTransform(middle, expected, plane);
			/* scale is the diagonal of a square, which is 1.4 of its sides */
			sum += cv::norm(expected[0] - seen) < scale / 2.8 ? 1 : -2;
		}
	return sum;
}

} // namespace

std::vector<Marker> boards::find_markers(const board &wanted, const cv::Mat &grey, std::string &why)
{
	const std::string name = marker_sets[wanted.dictionary].name;
	std::vector<boards::Points> corners;
	std::vector<int> numbers;

	detect_markers(grey, opencv_dictionary(wanted.dictionary, board_markers(&wanted)), corners,
		       numbers);

	const std::vector<Marker> markers = markers_on(wanted, corners, numbers);

	if (!markers.empty() && agreement(wanted, markers) >= 0)
		return markers;
	why = numbers.empty()
		      ? "no marker of " + name + " is to be seen"
		      : std::to_string(numbers.size()) + " markers of " + name +
				" are to be seen, but not beside each other where the board has them";
	why += ", which names its own if they are not 5x5 (:6x6) or its upper left square is white (:legacy)";
	return {};
}
