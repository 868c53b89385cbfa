// BVH files in and out.
#pragma once
#include "motiongan/motion/bvh_reader.hpp"
#include "motiongan/motion/bvh_writer.hpp"
