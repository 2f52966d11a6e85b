/* SPDX-License-Identifier: MIT */
/* Includes ArUco's header, whose place depends on OpenCV's version. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_ARUCO_HPP
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_ARUCO_HPP

#include <opencv2/core/version.hpp>

/* ArUco moved from contrib to objdetect with 4.7. */
#define ARUCO_IN_OBJDETECT (CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407)
#if ARUCO_IN_OBJDETECT
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

#endif
