/* SPDX-License-Identifier: MIT */
/* Places where four squares meet, to a hundredth of a pixel. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_CORNER_HPP
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_CORNER_HPP

#include <opencv2/core.hpp>

namespace boards
{

class Corners
{
      public:
	/* room: how far around each corner nothing but its four squares lies, px. */
	Corners(const cv::Mat &grey, double room);

	/* Moves a point onto the corner next to it. False: there is none, or none within the room;
	 * the point is then where the four edges next to it would meet. */
	bool place(cv::Point2f &point) const;

      private:
	cv::Mat grey, soft;
	int window, reach;
};

} // namespace boards

#endif
