/* SPDX-License-Identifier: MIT */
/* The markers of a ChArUco board: found by OpenCV, and asked which dictionary and which layout of
 * squares they are of. */
#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "bake/calibrate/observe/boards_aruco.hpp"
#include "bake/calibrate/observe/boards_opencv.hpp"

namespace
{

using boards::Marker;

/* Two pairs of neighbours, each counted from both of its markers. */
constexpr int enough_agreement = 4;

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

/* Markers as they were found, whatever board they are on. */
struct Found {
	std::vector<boards::Points> corners;
	std::vector<int> numbers;
};

Found detect_dictionary(const board &wanted, const cv::Mat &grey, int dictionary)
{
	Found found;

	detect_markers(grey, boards::opencv_dictionary(dictionary, board_markers(&wanted)),
		       found.corners, found.numbers);
	return found;
}

std::vector<Marker> markers_on(const board &wanted, const Found &found)
{
	std::vector<Marker> markers;

	for (int r = 0; r < wanted.rows; r++)
		for (int c = 0; c < wanted.columns; c++) {
			const int number = board_marker_at(&wanted, c, r);
			const auto at = std::find(found.numbers.begin(), found.numbers.end(),
						  number);

			if (number >= 0 && at != found.numbers.end())
				markers.push_back(
					{c, r,
					 found.corners[(size_t)(at - found.numbers.begin())]});
		}
	return markers;
}

} // namespace

/* The corners of a marker in the board's axes, mm. */
boards::Points boards::marker_flat(const board &wanted, const Marker &marker)
{
	const float x = (float)((marker.column - 0.5) * wanted.step_mm);
	const float y = (float)((marker.row - 0.5) * wanted.step_mm);
	const float half = (float)wanted.marker_mm / 2;

	return {{x - half, y - half},
		{x + half, y - half},
		{x + half, y + half},
		{x - half, y + half}};
}

namespace
{

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
			const boards::Points flat = boards::marker_flat(wanted, one);
			const cv::Mat plane = cv::getPerspectiveTransform(flat, one.corner);
			const double scale = wanted.step_mm / wanted.marker_mm *
					     cv::norm(one.corner[0] - one.corner[2]);

			for (const cv::Point2f &corner : boards::marker_flat(wanted, other))
				middle[0] += corner / 4;
			for (const cv::Point2f &corner : other.corner)
				seen += corner / 4;
			cv::perspectiveTransform(middle, expected, plane);
			/* scale is the diagonal of a square, which is 1.4 of its sides */
			sum += cv::norm(expected[0] - seen) < scale / 2.8 ? 1 : -2;
		}
	return sum;
}

/* Tries the layouts of the squares that are not ruled out. Returns the better agreement, and the
 * board that has it. */
int agreement_of_layouts(const board &wanted, const Found &found, board &best)
{
	int most = INT_MIN;

	for (int legacy = 0; legacy < 2; legacy++) {
		board tried = wanted;

		tried.legacy = legacy;
		if ((wanted.legacy >= 0 && wanted.legacy != legacy) ||
		    (legacy && wanted.legacy < 0 && wanted.rows % 2))
			continue;
		const int now = agreement(wanted, markers_on(tried, found));

		if (now > most) {
			most = now;
			best = tried;
		}
	}
	return most;
}

/* What was found of one dictionary. */
struct Trial {
	Found found;
	board layout;
	int agreement;
};

Trial try_dictionary(const board &wanted, const cv::Mat &grey, int dictionary)
{
	board tried = wanted;
	Trial trial;

	tried.dictionary = dictionary;
	trial.found = detect_dictionary(tried, grey, dictionary);
	trial.layout = tried;
	trial.agreement = agreement_of_layouts(tried, trial.found, trial.layout);
	return trial;
}

/* Agreement counts if there is any; else how many markers there are, for messages. */
bool is_better(const Trial &one, const Trial &other)
{
	if (std::max(one.agreement, other.agreement) >= enough_agreement)
		return one.agreement > other.agreement;
	return one.found.numbers.size() > other.found.numbers.size();
}

/* The dictionary that agrees best. The first one is taken as soon as it agrees, because boards are
 * printed with it here; names becomes all that were tried. */
Trial try_dictionaries(const board &wanted, const cv::Mat &grey, std::string &names)
{
	Trial best = {{}, wanted, INT_MIN};

	for (int d = 0; d < BOARD_DICTIONARIES; d++) {
		if (wanted.dictionary >= 0 ? d != wanted.dictionary : d >= BOARD_TRIED)
			continue;
		names += std::string(names.empty() ? "" : ", ") + marker_sets[d].name;
		if (board_markers(&wanted) > marker_sets[d].markers)
			continue;
		const Trial trial = try_dictionary(wanted, grey, d);

		if (is_better(trial, best))
			best = trial;
		if (d == BOARD_5X5 && trial.agreement >= enough_agreement)
			break;
	}
	return best;
}

/* Says of a board whose markers were named, but are not there, which ones are. */
std::string others_seen(const board &wanted, const cv::Mat &grey)
{
	board open = wanted;
	std::string names;

	open.dictionary = open.legacy = -1;
	const Trial other = try_dictionaries(open, grey, names);

	if (other.agreement < enough_agreement)
		return "";
	return std::string(", but it is a board of ") + marker_sets[other.layout.dictionary].name +
	       (other.layout.legacy > 0 ? ", legacy" : "");
}

} // namespace

std::vector<Marker> boards::find_markers(board &wanted, const cv::Mat &grey, std::string &why)
{
	const bool settled = wanted.dictionary >= 0 && wanted.legacy >= 0;
	std::string names;
	const Trial best = try_dictionaries(wanted, grey, names);
	const std::vector<Marker> markers = markers_on(best.layout, best.found);

	if (best.agreement >= enough_agreement ||
	    (settled && !markers.empty() && best.agreement >= 0)) {
		wanted.dictionary = best.layout.dictionary;
		wanted.legacy = best.layout.legacy;
		return markers;
	}
	if (!best.found.numbers.empty())
		why = std::to_string(best.found.numbers.size()) + " markers of " +
		      marker_sets[best.layout.dictionary].name +
		      " are to be seen, but not beside each other where the board has them";
	else
		why = "no marker of " + names + " is to be seen";
	if (wanted.dictionary >= 0 || wanted.legacy >= 0)
		why += others_seen(wanted, grey);
	return {};
}
