/* SPDX-License-Identifier: MIT */
/*
 * ChArUco: chessboards whose white squares hold numbered markers, so that a part of the board is
 * enough.
 *
 * boards_marker.cpp finds the markers; this file places the corners between them, each from the
 * markers next to it. OpenCV's own class for that differs between versions.
 */
#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "bake/calibrate/observe/boards_corner.hpp"
#include "bake/calibrate/observe/boards_opencv.hpp"

namespace
{

constexpr int enough_corners = 6;

/*
 * Predicts corner (column, row) by the homography of the markers that touch it or come next; a
 * local homography hardly suffers from the lens's distortion. room becomes the distance to the
 * nearest black of these markers, if that is smaller.
 */
bool expect_corner(const board &wanted, const std::vector<boards::Marker> &markers, int column,
		   int row, cv::Point2f &place, double &room)
{
	const boards::Points corner = {
		{(float)(column * wanted.step_mm), (float)(row * wanted.step_mm)}};
	boards::Points mm, px, out;
	int touching = 0;

	for (const boards::Marker &marker : markers) {
		/* squares column..column+1, row..row+1 touch the corner */
		const int dx = std::max(column - marker.column, marker.column - column - 1);
		const int dy = std::max(row - marker.row, marker.row - row - 1);
		const boards::Points four = boards::marker_flat(wanted, marker);

		if (std::max(dx, dy) > 1)
			continue;
		touching += std::max(dx, dy) == 0;
		mm.insert(mm.end(), four.begin(), four.end());
		px.insert(px.end(), marker.corner.begin(), marker.corner.end());
	}
	if (!touching)
		return false;
	const cv::Mat plane = cv::findHomography(mm, px);

	if (plane.empty() || cv::determinant(plane) <= 0)
		return false;
	cv::perspectiveTransform(corner, out, plane);
	place = out[0];
	for (const cv::Point2f &black : px)
		room = std::min(room, std::max(std::abs((double)(black.x - place.x)),
					       std::abs((double)(black.y - place.y))));
	return true;
}

} // namespace

bool boards::find_charuco(const board &wanted, const cv::Mat &grey, Points &points,
			  std::vector<bool> &seen, std::string &why)
{
	const std::vector<boards::Marker> markers = find_markers(wanted, grey, why);
	double room = INFINITY;
	int count = 0;

	for (int r = 0; r + 1 < wanted.rows; r++)
		for (int c = 0; c + 1 < wanted.columns; c++) {
			cv::Point2f corner;

			seen.push_back(expect_corner(wanted, markers, c, r, corner, room));
			points.push_back(corner);
		}
	if (markers.empty())
		return false;
	const Corners corners(grey, room);

	for (size_t k = 0; k < points.size(); k++) {
		seen[k] = seen[k] && corners.place(points[k]);
		count += seen[k];
	}
	why = "only " + std::to_string(markers.size()) + " markers and " + std::to_string(count) +
	      " corners of the board are to be seen";
	return count >= enough_corners;
}
