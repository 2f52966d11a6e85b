/* SPDX-License-Identifier: MIT */
#include "hal/look/median.h"

float select_median(float *value, int count)
{
	int low = 0, high = count - 1;

	while (low < high) {
		const float pivot = value[(low + high) / 2];
		int i = low, j = high;

		while (i <= j) {
			while (value[i] < pivot)
				i++;
			while (value[j] > pivot)
				j--;
			if (i <= j) {
				const float kept = value[i];

				value[i++] = value[j];
				value[j--] = kept;
			}
		}
		if (count / 2 <= j)
			high = j;
		else if (count / 2 >= i)
			low = i;
		else
			break;
	}
	return value[count / 2];
}
