/* SPDX-License-Identifier: MIT */
/* OpenCV speaks C++ alone. */
#ifndef INLAY_TESTS_BENCH_PEERS_SUMS_H
#define INLAY_TESTS_BENCH_PEERS_SUMS_H

#ifdef __cplusplus
extern "C" {
#endif

/* sum += scale * picture, by cv::scaleAdd(). */
void peers_scale_add(const float *picture, double scale, float *sum, int values);

void peers_one_thread(void);

#ifdef __cplusplus
}
#endif

#endif
