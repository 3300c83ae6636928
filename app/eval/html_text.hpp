// The pieces of text that an HTML page is made of.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace binpick::app {

std::string escape_html(std::string_view text);
std::string base64(std::span<const std::uint8_t> bytes);
std::string fixed_digits(double value, int digits);

}  // namespace binpick::app
