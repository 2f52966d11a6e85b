/* SPDX-License-Identifier: MIT */
/* Finds chessboards. */
#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "bake/calibrate/observe/boards_opencv.hpp"

namespace
{

/* Corners are searched in a picture of at most so many pixels, then placed in the whole one. The
 * quick search takes many seconds in a larger picture that holds a board of another size. */
constexpr double quick_pixels = 0.32e6, careful_pixels = 1.3e6;

/* Radius around a corner within which only its squares lie, as a share of the distance to the next
 * corner. */
constexpr double room = 0.5;

/* Least contrast of a corner between its two pairs of squares, relative to that of the whole board:
 * about 1 for a corner, 0.5 where the squares end at the paper. */
constexpr double is_corner = 0.72;
constexpr double row_share = 0.75;   /* least share of corners among the places of a row */
constexpr double cells_share = 0.85; /* least share of places with the right colour in a board */
constexpr int side_min = 3;

struct Grid {
	int columns = 0, rows = 0;
	boards::Points point;

	const cv::Point2f &at(int column, int row) const
	{
		return point[(size_t)row * (size_t)columns + (size_t)column];
	}

	/* Place in the square to the lower right of a corner; u and v 0..1 along its sides. */
	cv::Point2f inside(int column, int row, float u, float v) const
	{
		return (1 - v) * ((1 - u) * at(column, row) + u * at(column + 1, row)) +
		       v * ((1 - u) * at(column, row + 1) + u * at(column + 1, row + 1));
	}
};

/* ---- placing ---- */

float shortest_step(const Grid &grid)
{
	float shortest = INFINITY;

	for (int r = 0; r < grid.rows; r++)
		for (int c = 0; c + 1 < grid.columns; c++)
			shortest = std::min(shortest,
					    (float)cv::norm(grid.at(c + 1, r) - grid.at(c, r)));
	for (int r = 0; r + 1 < grid.rows; r++)
		for (int c = 0; c < grid.columns; c++)
			shortest = std::min(shortest,
					    (float)cv::norm(grid.at(c, r + 1) - grid.at(c, r)));
	return shortest;
}

void place_corners(const cv::Mat &grey, Grid &grid)
{
	const boards::Corners corners(grey, room * (double)shortest_step(grid));

	for (cv::Point2f &point : grid.point)
		(void)corners.place(point); /* a smudged corner stays nearly where it was */
}

/* ---- what lies between the corners ---- */

float sample_mean(const cv::Mat &grey, cv::Point2f at)
{
	const int x = std::clamp(cvRound(at.x), 1, grey.cols - 2);
	const int y = std::clamp(cvRound(at.y), 1, grey.rows - 2);
	float sum = 0;

	for (int i = -1; i <= 1; i++)
		for (int j = -1; j <= 1; j++)
			sum += grey.at<uchar>(y + i, x + j);
	return sum / 9;
}

/* Mean brightness of the squares with odd column + row minus that of the others, between the
 * corners; the square at the first corner's lower right is 0,0. */
float grid_contrast(const cv::Mat &grey, const Grid &grid)
{
	float sum[2] = {0, 0};
	int count[2] = {0, 0};

	for (int r = 0; r + 1 < grid.rows; r++)
		for (int c = 0; c + 1 < grid.columns; c++) {
			sum[(c + r) % 2] += sample_mean(grey, grid.inside(c, r, 0.5F, 0.5F));
			count[(c + r) % 2]++;
		}
	return sum[1] / (float)count[1] - sum[0] / (float)count[0];
}

/* Contrast of the four squares around a place, given steps to its neighbours right and below:
 * positive where the upper left and lower right squares are darker. */
float corner_contrast(const cv::Mat &grey, cv::Point2f at, cv::Point2f right, cv::Point2f below)
{
	const cv::Point2f a = 0.3F * (right + below), b = 0.3F * (right - below);

	return (sample_mean(grey, at + b) + sample_mean(grey, at - b) - sample_mean(grey, at + a) -
		sample_mean(grey, at - a)) /
	       2;
}

/* ---- which way round ---- */

enum Turn { FLIP_X = 1, FLIP_Y = 2, TRANSPOSE = 4, TURNS = 8 };

Grid grid_turned(const Grid &grid, int turn)
{
	Grid to;

	to.columns = turn & TRANSPOSE ? grid.rows : grid.columns;
	to.rows = turn & TRANSPOSE ? grid.columns : grid.rows;
	for (int r = 0; r < to.rows; r++)
		for (int c = 0; c < to.columns; c++) {
			const int x = turn & TRANSPOSE ? r : c, y = turn & TRANSPOSE ? c : r;

			to.point.push_back(grid.at(turn & FLIP_X ? grid.columns - 1 - x : x,
						   turn & FLIP_Y ? grid.rows - 1 - y : y));
		}
	return to;
}

cv::Point2f along_rows(const Grid &grid)
{
	cv::Point2f sum(0, 0);

	for (int r = 0; r < grid.rows; r++)
		sum += grid.at(grid.columns - 1, r) - grid.at(0, r);
	return sum;
}

cv::Point2f along_columns(const Grid &grid)
{
	cv::Point2f sum(0, 0);

	for (int c = 0; c < grid.columns; c++)
		sum += grid.at(c, grid.rows - 1) - grid.at(c, 0);
	return sum;
}

/* Turns the grid so that it is seen from the front, with the first square black where that is
 * decisive, else upright. */
void orient_grid(const cv::Mat &grey, cv::Size wanted, Grid &grid)
{
	Grid best;
	bool best_black = false;
	float best_right = -INFINITY;

	for (int turn = 0; turn < TURNS; turn++) {
		Grid one = grid_turned(grid, turn);
		const cv::Point2f right = along_rows(one);
		const bool black = grid_contrast(grey, one) > 0;

		if (one.columns != wanted.width || one.rows != wanted.height ||
		    right.cross(along_columns(one)) <= 0)
			continue;
		if (black < best_black || (black == best_black && right.x <= best_right))
			continue;
		best = std::move(one);
		best_black = black;
		best_right = right.x;
	}
	grid = std::move(best);
}

/* ---- how large it really is ---- */

/* The row above the first, extrapolated quadratically from the first three. */
boards::Points row_above(const Grid &grid)
{
	boards::Points row;

	for (int c = 0; c < grid.columns; c++)
		row.push_back(3 * (grid.at(c, 0) - grid.at(c, 1)) + grid.at(c, 2));
	return row;
}

boards::Points row_of(const Grid &grid, int row)
{
	const auto first = grid.point.begin() + (ptrdiff_t)row * grid.columns;

	return boards::Points(first, first + grid.columns);
}

/* Whether a row consists of corners like the row below it (next). sign: expected sign of its first
 * corner, 1 where that of the grid's first corner counts as positive. */
bool has_corners(const cv::Mat &grey, const boards::Points &row, const boards::Points &next,
		 float whole, float sign)
{
	const cv::Rect2f inside(1, 1, (float)grey.cols - 2, (float)grey.rows - 2);
	int corners = 0;

	for (size_t c = 0; c < row.size(); c++, sign = -sign) {
		const cv::Point2f right = c ? row[c] - row[c - 1] : row[1] - row[0];

		corners += inside.contains(row[c]) &&
			   sign * corner_contrast(grey, row[c], right, next[c] - row[c]) / whole >
				   (float)is_corner;
	}
	return corners >= row_share * (double)row.size();
}

/* Calls change() for each side, brought to the top by turns of 90 degrees, until it changes none of
 * the four. */
template <typename Change> void at_each_side(Grid &grid, Change change)
{
	for (int unchanged = 0; unchanged < 4;) {
		if (change(grid)) {
			unchanged = 0;
			continue;
		}
		grid = grid_turned(grid, TRANSPOSE | FLIP_X);
		unchanged++;
	}
}

/* Removes outer rows and columns without corners, such as the board's own edge, then adds rows that
 * continue beyond the grid. */
void fit_size(const cv::Mat &grey, Grid &grid)
{
	at_each_side(grid, [&](Grid &one) {
		if (one.rows < side_min ||
		    has_corners(grey, row_of(one, 0), row_of(one, 1), grid_contrast(grey, one), 1))
			return false;
		one.point.erase(one.point.begin(), one.point.begin() + one.columns);
		one.rows--;
		return true;
	});
	if (std::min(grid.columns, grid.rows) < side_min)
		return;
	at_each_side(grid, [&](Grid &one) {
		const boards::Points above = row_above(one);

		if (one.rows >= BOARD_SIDE_MAX ||
		    !has_corners(grey, above, row_of(one, 0), grid_contrast(grey, one), -1))
			return false;
		one.point.insert(one.point.begin(), above.begin(), above.end());
		one.rows++;
		place_corners(grey, one);
		return true;
	});
}

/* Whether neighbouring squares differ in colour all over: not so in a lattice of every second or
 * third corner. */
bool is_board(const cv::Mat &grey, const Grid &grid)
{
	int right = 0, count = 0;

	if (std::min(grid.columns, grid.rows) < side_min)
		return false;
	const float sign = grid_contrast(grey, grid) > 0 ? 1 : -1;

	for (int r = 0; r + 1 < grid.rows; r++)
		for (int c = 0; c + 2 < grid.columns; c++)
			for (int k = 0; k < 9; k++) {
				const float u = 0.25F * (float)(k % 3 + 1);
				const float v = 0.25F * (float)(k / 3 + 1);
				const float step = sample_mean(grey, grid.inside(c + 1, r, u, v)) -
						   sample_mean(grey, grid.inside(c, r, u, v));

				right += ((c + r) % 2 ? -sign : sign) * step > 0;
				count++;
			}
	return right > cells_share * count;
}

/* Searches by attempt: 0, the wanted size, quickly; 1, the wanted size, carefully; 2, any size. */
bool search_board(const cv::Mat &grey, cv::Size wanted, int attempt, Grid &grid)
{
	const int quickly = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE |
			    cv::CALIB_CB_FAST_CHECK;
	const int carefully = cv::CALIB_CB_NORMALIZE_IMAGE;
	cv::Mat size(wanted, CV_8U);
	bool found;

	if (attempt == 0)
		found = cv::findChessboardCorners(grey, wanted, grid.point, quickly);
	else if (attempt == 1)
		found = cv::findChessboardCornersSB(grey, wanted, grid.point, carefully);
	else
		found = cv::findChessboardCornersSB(grey, cv::Size(side_min, side_min), grid.point,
						    carefully | cv::CALIB_CB_LARGER, size);
	grid.columns = size.cols;
	grid.rows = size.rows;
	return found;
}

cv::Mat reduced_picture(const cv::Mat &grey, double pixels)
{
	const double scale = std::sqrt(pixels / (double)grey.total());
	cv::Mat small;

	if (scale >= 1)
		return grey;
	cv::resize(grey, small, cv::Size(), scale, scale, cv::INTER_AREA);
	return small;
}

/* Scales the points from the reduced picture to the whole one. */
void enlarge_grid(const cv::Mat &small, const cv::Mat &grey, Grid &grid)
{
	for (cv::Point2f &point : grid.point) {
		point.x = (point.x + 0.5F) * (float)grey.cols / (float)small.cols - 0.5F;
		point.y = (point.y + 0.5F) * (float)grey.rows / (float)small.rows - 0.5F;
	}
}

} // namespace

bool boards::find_chess(const board &wanted, const cv::Mat &grey, Points &points, std::string &why)
{
	const cv::Size size(wanted.columns, wanted.rows);
	bool found = false;
	Grid grid;

	for (int attempt = 0; attempt < 3 && !found; attempt++) {
		const cv::Mat small = reduced_picture(grey,
						      attempt ? careful_pixels : quick_pixels);

		if (!search_board(small, size, attempt, grid))
			continue;
		enlarge_grid(small, grey, grid);
		place_corners(grey, grid);
		fit_size(grey, grid);
		found = is_board(grey, grid);
	}
	why = "no chessboard is to be seen";
	if (!found)
		return false;
	if (std::minmax(grid.columns, grid.rows) != std::minmax(size.width, size.height)) {
		why = "holds a chessboard of " + std::to_string(std::max(grid.columns, grid.rows)) +
		      "x" + std::to_string(std::min(grid.columns, grid.rows)) + " inner corners";
		return false;
	}
	orient_grid(grey, size, grid);
	points = std::move(grid.point);
	return !points.empty();
}
