// BVH files in and out.
#pragma once
#include "motiongan/formats/bvh_reader.hpp"
#include "motiongan/formats/bvh_writer.hpp"
