// Reading and writing BVH files.
#pragma once
#include "motiongan/formats/bvh_reader.hpp"
#include "motiongan/formats/bvh_writer.hpp"
