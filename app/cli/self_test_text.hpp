// The self-test that training ends with, as text.
#pragma once

#include <string>
#include <vector>

#include "training/self_test.hpp"

namespace binpick::app {

// To the standard output.
void print_self_test(const SelfTest& test, const std::vector<std::string>& advice);

}  // namespace binpick::app
