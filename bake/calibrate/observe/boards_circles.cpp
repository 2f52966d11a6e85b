/* SPDX-License-Identifier: MIT */
/* Asymmetric grids of circles. */
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

#include "bake/calibrate/observe/boards_opencv.hpp"

namespace
{

/* Largest distance of a circle from its prediction by a homography, in steps: lenses bend. */
constexpr double bend = 0.3;

/* The blob detector's default limits are fixed numbers of pixels; these follow the picture's
 * size. */
cv::Ptr<cv::FeatureDetector> blob_detector(const cv::Mat &grey)
{
	cv::SimpleBlobDetector::Params limits;

	limits.minArea = 12;
	/* OpenCV 4.10 refuses an empty range, which a tiny picture would give */
	limits.maxArea = std::max(limits.minArea, (float)grey.total() / 100);
	limits.minDistBetweenBlobs = 4;
	limits.minThreshold = 20;
	limits.maxThreshold = 230;
	return cv::SimpleBlobDetector::create(limits);
}

boards::Points board_flat(const board &wanted)
{
	boards::Points points;

	for (int k = 0; k < board_points(&wanted); k++) {
		double mm[2];

		board_place(&wanted, k, mm);
		points.emplace_back((float)mm[0], (float)mm[1]);
	}
	return points;
}

/* Returns the same circles, counted from another corner. */
boards::Points circles_recounted(const board &wanted, const boards::Points &points, bool flip_x,
				 bool flip_y)
{
	boards::Points to;

	for (int r = 0; r < wanted.rows; r++)
		for (int c = 0; c < wanted.columns; c++) {
			const int x = flip_x ? wanted.columns - 1 - c : c;
			const int y = flip_y ? wanted.rows - 1 - r : r;

			to.push_back(points[(size_t)(y * wanted.columns + x)]);
		}
	return to;
}

/* Whether the points fit the board, seen from the front. place: the board's points; step_mm: the
 * board's step. */
bool fits_board(const boards::Points &place, const boards::Points &points, float step_mm)
{
	const cv::Mat plane = cv::findHomography(place, points);
	boards::Points expected;

	if (plane.empty() || cv::determinant(plane) <= 0)
		return false;
	cv::perspectiveTransform(place, expected, plane);
	for (size_t k = 0; k < points.size(); k++) {
		boards::Points next = {place[k] + cv::Point2f(step_mm, 0)}, moved;

		cv::perspectiveTransform(next, moved, plane);
		if (cv::norm(points[k] - expected[k]) > bend * cv::norm(moved[0] - expected[k]))
			return false;
	}
	return true;
}

/*
 * Refines a centre. The blob detector averages its centres over many thresholds, some of which see
 * noise or a neighbour too: up to 2 px off. The centroid of the darkness of one connected circle is
 * not.
 */
cv::Point2f circle_centroid(const cv::Mat &grey, const cv::Point2f &at, float apart)
{
	const int half = (int)std::ceil(apart);
	const cv::Point corner((int)std::floor(at.x) - half, (int)std::floor(at.y) - half);
	const cv::Rect inside = cv::Rect(corner, cv::Size(2 * half + 1, 2 * half + 1)) &
				cv::Rect({}, grey.size());
	const cv::Mat patch = grey(inside);
	const cv::Point middle((int)at.x - inside.x, (int)at.y - inside.y);
	double ink, paper;
	cv::Mat dark, named, mask;

	if (!cv::Rect({}, patch.size()).contains(middle))
		return at;
	cv::minMaxLoc(patch, &ink, &paper);
	cv::compare(patch, (ink + paper) / 2, dark, cv::CMP_LT);
	cv::connectedComponents(dark, named);
	if (!named.at<int>(middle))
		return at;
	mask = named == named.at<int>(middle);
	if (cv::countNonZero(mask.row(0)) || cv::countNonZero(mask.row(mask.rows - 1)) ||
	    cv::countNonZero(mask.col(0)) || cv::countNonZero(mask.col(mask.cols - 1)))
		return at;
	cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
	patch.convertTo(dark, CV_32F, -1, paper);
	dark.setTo(0, ~mask);
	const cv::Moments sum = cv::moments(dark);

	return {(float)(inside.x + sum.m10 / sum.m00), (float)(inside.y + sum.m01 / sum.m00)};
}

/* Distance of point k to its nearest neighbour. */
float nearest_distance(const boards::Points &points, size_t k)
{
	float least = INFINITY;

	for (size_t i = 0; i < points.size(); i++)
		if (i != k)
			least = std::min(least, (float)cv::norm(points[i] - points[k]));
	return least;
}

} // namespace

bool boards::find_circles(const board &wanted, const cv::Mat &grey, Points &points,
			  std::string &why)
{
	const cv::Size size(wanted.columns, wanted.rows);
	const Points place = board_flat(wanted);
	Points found;

	why = "no such grid of circles is to be seen";
	if (!cv::findCirclesGrid(grey, size, found, cv::CALIB_CB_ASYMMETRIC_GRID,
				 blob_detector(grey)) &&
	    !cv::findCirclesGrid(grey, size, found,
				 cv::CALIB_CB_ASYMMETRIC_GRID | cv::CALIB_CB_CLUSTERING,
				 blob_detector(grey)))
		return false;
	/* With an odd number of rows two countings fit; seen from the front is one of them. */
	for (int turn = 0; turn < 4 && points.empty(); turn++) {
		Points one = circles_recounted(wanted, found, turn & 1, turn & 2);

		if (fits_board(place, one, (float)wanted.step_mm))
			points = std::move(one);
	}
	found = points;
	for (size_t k = 0; k < points.size(); k++)
		points[k] = circle_centroid(grey, found[k], nearest_distance(found, k));
	return !points.empty();
}
