/* SPDX-License-Identifier: MIT */
/* The finders, one for each kind of board. OpenCV's exceptions pass through; board_look() catches
 * them. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_OPENCV_HPP
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_OPENCV_HPP

#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/version.hpp>

/* ArUco moved from contrib to objdetect with 4.7. */
#define ARUCO_IN_OBJDETECT (CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407)
#if ARUCO_IN_OBJDETECT
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

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

/* OpenCV's number of the smallest dictionary with so many markers: fewer are told apart more
 * safely. */
int opencv_dictionary(int dictionary, int markers);

/* Chessboard corners, where four squares meet, placed to a hundredth of a pixel. */
class Corners
{
      public:
	/* room: distance from each corner within which only its four squares lie, px. */
	Corners(const cv::Mat &grey, double room);

	/* Moves a point onto the corner next to it. False: there is no corner within the room; the
	 * point may then have moved to where cornerSubPix put it. */
	bool place(cv::Point2f &point) const;

      private:
	cv::Mat grey, soft;
	int window, reach;
};

} // namespace boards

#endif
