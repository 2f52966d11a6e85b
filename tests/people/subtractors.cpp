/* SPDX-License-Identifier: MIT */
#include "tests/people/subtractors.h"

#include <cstring>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>

const char *const subtractor_names[SUBTRACTORS] = {"MOG2", "KNN"};

struct subtractors {
	int width, height;
	cv::Ptr<cv::BackgroundSubtractor> method[SUBTRACTORS];
	cv::Mat mask;
};

struct subtractors *subtractors_create(int width, int height)
{
	auto *all = new (std::nothrow) subtractors;

	if (!all)
		return nullptr;
	all->width = width;
	all->height = height;
	all->method[0] = cv::createBackgroundSubtractorMOG2();
	all->method[1] = cv::createBackgroundSubtractorKNN();
	cv::setNumThreads(1);
	return all;
}

void subtractors_look(struct subtractors *all, const uint8_t *bgrx,
		      uint8_t *const mask[SUBTRACTORS])
{
	const cv::Mat frame(all->height, all->width, CV_8UC4, const_cast<uint8_t *>(bgrx));
	cv::Mat bgr;

	cv::cvtColor(frame, bgr, cv::COLOR_BGRA2BGR);
	for (int m = 0; m < SUBTRACTORS; m++) {
		all->method[m]->apply(bgr, all->mask);
		for (int i = 0; i < all->width * all->height; i++)
			mask[m][i] = all->mask.data[i] == 255 ? 255 : 0;
	}
}

void subtractors_destroy(struct subtractors *all)
{
	delete all;
}
