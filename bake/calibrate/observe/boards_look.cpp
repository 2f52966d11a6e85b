/* SPDX-License-Identifier: MIT */
/* The border to OpenCV: none of its exceptions and messages passes it. */
#include <cerrno>
#include <exception>
#include <new>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include "bake/calibrate/observe/boards_opencv.hpp"

namespace
{

int say_nothing(int, const char *, const char *, const char *, int, void *)
{
	return 0;
}

void silence_opencv()
{
	cv::redirectError(say_nothing);
	cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

bool find_kind(const board &wanted, const cv::Mat &grey, boards::Points &points,
	       std::vector<bool> &seen, std::string &why)
{
	return wanted.kind == BOARD_CHESS ? boards::find_chess(wanted, grey, points, why)
					  : boards::find_charuco(wanted, grey, points, seen, why);
}

int look_for_board(const board &wanted, const image &picture, double (*px)[2], bool *seen,
		   fault *fault)
{
	const cv::Mat rgb(picture.height, picture.width, CV_8UC3, picture.u8);
	boards::Points points;
	std::vector<bool> which;
	std::string why;
	char name[BOARD_NAME_MAX];
	cv::Mat grey;

	cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
	if (!find_kind(wanted, grey, points, which, why)) {
		board_name(&wanted, name);
		return fault_say(fault, -ENOENT, "%s, expected %s", why.c_str(), name);
	}
	for (size_t k = 0; k < points.size(); k++) {
		seen[k] = which.empty() || which[k];
		px[k][0] = (double)points[k].x + 0.5;
		px[k][1] = (double)points[k].y + 0.5;
	}
	return 0;
}

} // namespace

extern "C" int board_look(const struct board *board, const struct image *picture, double (*px)[2],
			  bool *seen, struct fault *fault)
{
	try {
		silence_opencv();
		return look_for_board(*board, *picture, px, seen, fault);
	} catch (const std::bad_alloc &) {
		return -ENOMEM;
	} catch (const cv::Exception &error) {
		/* OpenCV's own checks refuse the picture: it holds no board. */
		return error.code == cv::Error::StsNoMem
			       ? -ENOMEM
			       : fault_say(fault, -ENOENT, "OpenCV cannot look for a board: %s",
					   error.err.c_str());
	} catch (const std::exception &error) {
		return fault_say(fault, -ENOENT, "OpenCV cannot look for a board: %s",
				 error.what());
	}
}
