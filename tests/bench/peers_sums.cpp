// SPDX-License-Identifier: MIT
#include "tests/bench/peers_sums.h"

#include <opencv2/core.hpp>

void peers_scale_add(const float *picture, double scale, float *sum, int values)
{
	const cv::Mat from(1, values, CV_32F, const_cast<float *>(picture));
	cv::Mat to(1, values, CV_32F, sum);

	cv::scaleAdd(from, scale, to, to);
}

void peers_one_thread()
{
	cv::setNumThreads(1);
}
