// Random123 refuses processors that its authors did not try. Philox is integer arithmetic; it is compiled as for one that they did.
// The standard headers come first, since the name must not reach them.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <iterator>
#include <limits>
#include <stdexcept>
#define __aarch64__ 1
#include_next <Random123/philox.h>
#undef __aarch64__
