/* SPDX-License-Identifier: MIT */
/*
 * ChArUco: chessboards whose white squares hold numbered markers, so that a part of the board is
 * enough.
 *
 * The markers are found first, then the corners between them are placed, each from the
 * markers next to it. OpenCV's own class for that differs between versions.
 */
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "bake/calibrate/observe/boards_opencv.hpp"

namespace
{

/* A marker of a ChArUco board. */
struct Marker {
	int column, row;       /* position of its square */
	boards::Points corner; /* from its upper left, clockwise */
};

void detect_markers(const cv::Mat &grey, int dictionary, std::vector<boards::Points> &corners,
		    std::vector<int> &numbers)
{
#if ARUCO_IN_OBJDETECT
	const cv::aruco::ArucoDetector detector(cv::aruco::getPredefinedDictionary(dictionary));

	detector.detectMarkers(grey, corners, numbers);
#else
	cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(dictionary), corners,
				 numbers);
#endif
}

std::vector<Marker> markers_on(const board &wanted, const std::vector<boards::Points> &corners,
			       const std::vector<int> &numbers)
{
	std::vector<Marker> markers;

	for (int r = 0; r < wanted.rows; r++)
		for (int c = 0; c < wanted.columns; c++) {
			const int number = board_marker_at(&wanted, c, r);
			const auto at = std::find(numbers.begin(), numbers.end(), number);

			if (number >= 0 && at != numbers.end())
				markers.push_back({c, r, corners[(size_t)(at - numbers.begin())]});
		}
	return markers;
}

/* The corners of a marker in the board's axes, mm. */
boards::Points marker_flat(const board &wanted, const Marker &marker)
{
	const float x = (float)((marker.column - 0.5) * wanted.step_mm);
	const float y = (float)((marker.row - 0.5) * wanted.step_mm);
	const float half = (float)wanted.marker_mm / 2;

	return {{x - half, y - half},
		{x + half, y - half},
		{x + half, y + half},
		{x - half, y + half}};
}

/*
 * Counts the pairs of markers at a corner whose places agree with the board, less twice those that
 * do not: one marker's own homography says where the other should be, to half a square. A board of
 * other numbers, or with its squares exchanged, has its neighbours two squares from there.
 */
int agreement(const board &wanted, const std::vector<Marker> &markers)
{
	int sum = 0;

	for (const Marker &one : markers)
		for (const Marker &other : markers) {
			boards::Points middle = {{0, 0}}, expected;
			cv::Point2f seen(0, 0);

			if (std::abs(one.column - other.column) != 1 ||
			    std::abs(one.row - other.row) != 1)
				continue;
			const boards::Points flat = marker_flat(wanted, one);
			const cv::Mat plane = cv::getPerspectiveTransform(flat, one.corner);
			const double scale = wanted.step_mm / wanted.marker_mm *
					     cv::norm(one.corner[0] - one.corner[2]);

			for (const cv::Point2f &corner : marker_flat(wanted, other))
				middle[0] += corner / 4;
			for (const cv::Point2f &corner : other.corner)
				seen += corner / 4;
			cv::perspectiveTransform(middle, expected, plane);
			/* scale is the diagonal of a square, which is 1.4 of its sides */
			sum += cv::norm(expected[0] - seen) < scale / 2.8 ? 1 : -2;
		}
	return sum;
}

/* Finds the markers of a board. Empty: why there are none. */
std::vector<Marker> find_markers(const board &wanted, const cv::Mat &grey, std::string &why)
{
	const std::string name = marker_sets[wanted.dictionary].name;
	std::vector<boards::Points> corners;
	std::vector<int> numbers;

	detect_markers(grey, boards::opencv_dictionary(wanted.dictionary, board_markers(&wanted)),
		       corners, numbers);

	const std::vector<Marker> markers = markers_on(wanted, corners, numbers);

	if (!markers.empty() && agreement(wanted, markers) >= 0)
		return markers;
	why = numbers.empty()
		      ? "no marker of " + name + " is to be seen"
		      : std::to_string(numbers.size()) + " markers of " + name +
				" are to be seen, but not beside each other where the board has them";
	why += ", which names its own if they are not 5x5 (:6x6) or its upper left square is white (:legacy)";
	return {};
}

constexpr int enough_corners = 6;

/*
 * Predicts corner (column, row) by the homography of the markers that touch it or come next; a
 * local homography hardly suffers from the lens's distortion. room becomes the distance to the
 * nearest black of these markers, if that is smaller.
 */
bool expect_corner(const board &wanted, const std::vector<Marker> &markers, int column, int row,
		   cv::Point2f &place, double &room)
{
	const boards::Points corner = {
		{(float)(column * wanted.step_mm), (float)(row * wanted.step_mm)}};
	boards::Points mm, px, out;
	int touching = 0;

	for (const Marker &marker : markers) {
		/* squares column..column+1, row..row+1 touch the corner */
		const int dx = std::max(column - marker.column, marker.column - column - 1);
		const int dy = std::max(row - marker.row, marker.row - row - 1);
		const boards::Points four = marker_flat(wanted, marker);

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
	const std::vector<Marker> markers = find_markers(wanted, grey, why);
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
