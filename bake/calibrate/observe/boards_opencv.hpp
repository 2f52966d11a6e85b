/* SPDX-License-Identifier: MIT */
/* The finders, one for each kind of board. OpenCV's exceptions pass through; board_look() catches
 * them. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_OPENCV_HPP
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_OPENCV_HPP

#include <string>
#include <vector>

#include <opencv2/core.hpp>

extern "C" {
#include "bake/calibrate/observe/boards_parts.h"
}

namespace boards
{

/* In OpenCV's pixels: the first one's centre is at 0. */
using Points = std::vector<cv::Point2f>;

/* Each returns whether it found the board. points: all of them, in the order of board_point();
 * seen: which of them were found (empty: all); why: what was found instead. */
bool find_chess(const board &wanted, const cv::Mat &grey, Points &points, std::string &why);
bool find_charuco(const board &wanted, const cv::Mat &grey, Points &points, std::vector<bool> &seen,
		  std::string &why);

/* A marker of a ChArUco board. */
struct Marker {
	int column, row; /* position of its square */
	Points corner;	 /* from its upper left, clockwise */
};

/* The corners of a marker in the board's axes, mm. */
Points marker_flat(const board &wanted, const Marker &marker);

/* Finds the markers of a board. Empty: why there are none. */
std::vector<Marker> find_markers(const board &wanted, const cv::Mat &grey, std::string &why);

/* OpenCV's number of the smallest dictionary with so many markers: fewer are told apart more
 * safely. */
int opencv_dictionary(int dictionary, int markers);

} // namespace boards

#endif
