// Numbers that say whether generated motion moves like real motion: how far joints turn and how fast, whether
// they leave the range that real clips show, how fast the body travels and how quickly the pose changes.
#pragma once
#include "motiongan/metrics/statistics_comparison.hpp"
#include "motiongan/metrics/statistics_measure.hpp"
