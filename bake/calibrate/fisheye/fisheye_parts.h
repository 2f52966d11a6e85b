/* SPDX-License-Identifier: MIT */
/* Shared by the parts of a fisheye's calibration from points: rotations, the fit, its first
 * guess, the choice of a model. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_PARTS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_PARTS_H

#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/fisheye/fisheye_optics.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/base/fault.h"

/* Computes exp([w]x), the rotation about w by its length, rad (Rodrigues). */
void turn_matrix(const double w[3], double rotation[9]);

/* Computes the left Jacobian of SO(3): exp([w + dw]x) = exp([J dw]x) exp([w]x) to first order. */
void turn_jacobian(const double w[3], double jacobian[9]);

void turn_multiply(const double a[9], const double b[9], double product[9]);

/* The inverse of fisheye_rotation(): angles about X, then Y, then Z, degrees; the one about Y is in
 * -90..90. At +-90 the one about X is 0. */
void turn_degrees(const double rotation[9], double deg[3]);

/*
 * Least-squares fit of a fisheye lens to points of boards, one unknown pose for each view.
 */

struct lens_pose {
	double rotation[9]; /* world to camera: camera = rotation world + translation */
	double translation[3];
};

struct lens_problem {
	const struct observations *seen;
	bool plain; /* plain squares, even if there are outliers */
};

/* The first guess, and then the solution. */
struct lens_solution {
	struct optics optics;
	int poses;
	struct lens_pose *pose; /* [poses] */
	/* Parameters: optics.number, then for each pose three turns (rad, about the camera's axes,
	 * after its rotation) and its translation. */
	int parameters;
	struct least_squares_fit fit;
};

#define LENS_POSE 6 /* parameters of a pose */

/* Allocates the poses. -ENOMEM. */
int lens_solution_create(struct lens_solution *solution, const struct lens_problem *problem);
void lens_solution_free(struct lens_solution *solution); /* idempotent; zeroed is fine */

/* Copies a solution without its fit, as a first guess. -ENOMEM. */
int lens_solution_copy(struct lens_solution *copy, const struct lens_solution *from);

/* Improves the solution's optics (the terms only of the polynomial model) and poses: by plain
 * squares and, unless problem->plain, once more with a robust loss if there are outliers. Returns
 * what least_squares_solve() returns. */
int lens_solve(const struct lens_problem *problem, struct lens_solution *solution,
	       struct fault *fault);

/* Returns the standard deviation of a point, px, from the median of the residuals, which few
 * outliers hardly move. */
double lens_deviation(const struct lens_problem *problem, const struct lens_solution *solution);

/* Projects a point by the solution; false: it has no image. */
bool lens_expect(const struct lens_solution *solution, const struct observation *point,
		 double px[2]);

/*
 * Fills the solution's optics (of its model, all terms 0) and poses with a first guess. mirrored:
 * the picture fits better mirrored: points in the wrong order, or flipped. -ERANGE: no pose fits;
 * -EINVAL: an impossible point (the fault names it); -ENOMEM.
 */
int lens_start(const struct lens_problem *problem, struct lens_solution *solution, bool *mirrored,
	       struct fault *fault);

/* Every model's solution. */
struct model_trials {
	bool solved[FISHEYE_MODEL_COUNT];
	int err[FISHEYE_MODEL_COUNT]; /* from lens_solve(), where the model was tried */
	struct lens_solution solution[FISHEYE_MODEL_COUNT];
	/* with residuals capped, so that common outliers count less */
	double rms_px[FISHEYE_MODEL_COUNT];
	double aic[FISHEYE_MODEL_COUNT]; /* Akaike's criterion: the least is best */
	enum fisheye_model best;	 /* the best of the solved ones */
	bool mirrored;
	struct fault fault[FISHEYE_MODEL_COUNT]; /* why a model was not solved */
};

/* Fits the models. start: an equidistant lens from lens_start(). wanted: fits that model and, for
 * comparison, the polynomial; FISHEYE_MODEL_COUNT: all. Returns 0, also where no model was solved;
 * -ENOMEM. */
int models_try(struct model_trials *trials, const struct lens_problem *problem,
	       const struct lens_solution *start, int wanted);
void models_free(struct model_trials *trials); /* idempotent; zeroed is fine */

/* Returns the fewest points that determine a lens: one more than the number of unknowns that they
 * could be fitted to. */
int fisheye_fewest(const struct lens_problem *problem, const struct fisheye_wanted *wanted);

/* Whether there are too few points to begin with; the verdict then says so. */
bool fisheye_doubt_count(struct fisheye_result *result, const struct lens_problem *problem,
			 const struct fisheye_wanted *wanted);

/* Judges the lens of one model, or that there is none. */
void fisheye_doubt(struct fisheye_result *result, const struct lens_problem *problem,
		   const struct model_trials *trials, const struct fisheye_wanted *wanted,
		   enum fisheye_model model);

/* Judges the errors over the image circle, whatever the lens was found from. */
void fisheye_doubt_circle(struct fisheye_result *result, double tolerance_px, const char *remedy);

#endif
