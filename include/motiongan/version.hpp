// Which version this is: MOTIONGAN_VERSION and its parts, which CMake writes into the generated header.
#pragma once
#include <motiongan_version.h>
