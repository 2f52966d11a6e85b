/* SPDX-License-Identifier: MIT */
/* The pose of points whose places are known, by OpenCV (Terzakis and Lourakis 2020, SQPnP). */
#include <cstring>
#include <exception>

#include <opencv2/calib3d.hpp>

extern "C" {
#include "bake/calibrate/camera/camera_problem.h"
}

extern "C" bool camera_pose(int count, const double (*place)[3], const double (*seen)[2],
			    double pose[MODEL_OF_VIEW])
{
	try {
		const cv::Mat places(count, 3, CV_64F, const_cast<double(*)[3]>(place));
		const cv::Mat points(count, 2, CV_64F, const_cast<double(*)[2]>(seen));
		cv::Vec3d rotation, translation;

		if (!cv::solvePnP(places, points, cv::Matx33d::eye(), cv::noArray(), rotation,
				  translation, false, cv::SOLVEPNP_SQPNP))
			return false;
		std::memcpy(pose + MODEL_ROTATION, rotation.val, sizeof(rotation.val));
		std::memcpy(pose + MODEL_TRANSLATION, translation.val, sizeof(translation.val));
		return true;
	} catch (const std::exception &) {
		return false; /* of points on a line, say */
	}
}
