// Statistics that compare generated with real motion: joint angles and speeds, values outside the real range,
// root speed, and the mean frequency of the pose.
#pragma once
#include "motiongan/metrics/statistics_comparison.hpp"
#include "motiongan/metrics/statistics_measure.hpp"
