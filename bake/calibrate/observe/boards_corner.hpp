/* SPDX-License-Identifier: MIT */
/* Chessboard corners, where four squares meet, placed to a hundredth of a pixel. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_CORNER_HPP
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_CORNER_HPP

#include <opencv2/core.hpp>

namespace boards
{

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
