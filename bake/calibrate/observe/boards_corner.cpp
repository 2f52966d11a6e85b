/* SPDX-License-Identifier: MIT */
/*
 * Two steps: cornerSubPix, which converges from some pixels away, then the saddle point of a
 * quadric fitted to the blurred picture (Lucchese and Mitra 2002), which is two to five times as
 * exact: edges one pixel wide are too sharp for cornerSubPix's gradients. test_boards.c measures
 * both.
 */
#include "bake/calibrate/observe/boards_opencv.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

extern "C" {
#include "hal/colour/transfer.h"
}

namespace
{

constexpr int terms = 6; /* x^2, xy, y^2, x, y, 1 */
constexpr int rounds = 8;
constexpr double close_px = 1e-3;

using Quadric = cv::Vec<double, terms>;

/* Least-squares fit of a quadric around a point, weights falling with distance. False: singular. */
bool fit_quadric(const cv::Mat &soft, cv::Point2d at, int reach, Quadric &quadric)
{
	const int x = cvRound(at.x), y = cvRound(at.y);
	const double whole = (reach + 0.5) * (reach + 0.5);
	cv::Matx<double, terms, terms> normal = cv::Matx<double, terms, terms>::zeros();
	Quadric right = Quadric::all(0);

	for (int j = std::max(y - reach, 0); j <= std::min(y + reach, soft.rows - 1); j++)
		for (int i = std::max(x - reach, 0); i <= std::min(x + reach, soft.cols - 1); i++) {
			const double dx = i - at.x, dy = j - at.y;
			const double part = std::max(0.0, 1 - (dx * dx + dy * dy) / whole);
			const Quadric term(dx * dx, dx * dy, dy * dy, dx, dy, 1);

			normal += part * part * term * term.t();
			right += part * part * (double)soft.at<float>(j, i) * term;
		}
	return cv::solve(normal, right, quadric, cv::DECOMP_CHOLESKY);
}

/* Step from the quadric's origin to its stationary point. False: that is no saddle. */
bool saddle_of(const Quadric &q, cv::Point2d &step)
{
	const double det = 4 * q[0] * q[2] - q[1] * q[1];

	if (!(det < 0))
		return false;
	step.x = (q[1] * q[4] - 2 * q[2] * q[3]) / det;
	step.y = (q[1] * q[3] - 2 * q[0] * q[4]) / det;
	return true;
}

/* Table from code values to linear light: lenses and pixels average light, and averaged code values
 * would move an edge towards its dark side. */
cv::Mat light_table()
{
	cv::Mat table(1, 256, CV_32F);

	for (int code = 0; code < 256; code++)
		table.at<float>(code) = (float)transfer_decode(TRANSFER_SRGB, code / 255.0);
	return table;
}

} // namespace

boards::Corners::Corners(const cv::Mat &picture, double room)
    : grey(picture), window(std::clamp((int)(0.7 * room), 2, 11)),
      reach(std::clamp((int)(0.6 * room), 2, 10))
{
	cv::LUT(picture, light_table(), soft);
	cv::GaussianBlur(soft, soft, cv::Size(), std::clamp(room / 10, 0.7, 2.0));
}

bool boards::Corners::place(cv::Point2f &point) const
{
	std::vector<cv::Point2f> rough = {point};
	cv::Point2d at, step;

	if (point.x < 0 || point.y < 0 || point.x > (float)grey.cols - 1 ||
	    point.y > (float)grey.rows - 1)
		return false;
	cv::cornerSubPix(
		grey, rough, cv::Size(window, window), cv::Size(-1, -1),
		cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, close_px));
	if (cv::norm(rough[0] - point) > window)
		return false;
	point = rough[0];
	at = point;
	for (int i = 0; i < rounds; i++) {
		Quadric quadric;

		if (!fit_quadric(soft, at, reach, quadric) || !saddle_of(quadric, step))
			return false;
		at += step;
		if (!(cv::norm(at - cv::Point2d(point)) <= reach))
			return false;
		if (cv::norm(step) < close_px)
			break;
	}
	point = at;
	return true;
}
