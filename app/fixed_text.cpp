#include "fixed_text.hpp"

#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "binpick/base/assert.hpp"

namespace binpick::app {

void FixedText::print(const char* format, ...) {
  if (!whole_) return;
  va_list arguments;
  va_start(arguments, format);
  const std::size_t room = memory_.size() - length_;
  const int wanted = std::vsnprintf(memory_.data() + length_, room, format, arguments);
  va_end(arguments);
  // vsnprintf ends with a zero, for which there has to be room too.
  whole_ = wanted >= 0 && static_cast<std::size_t>(wanted) < room;
  if (whole_) length_ += static_cast<std::size_t>(wanted);
}

void FixedText::add(std::string_view text) {
  whole_ = whole_ && text.size() <= memory_.size() - length_;
  if (!whole_) return;
  std::memcpy(memory_.data() + length_, text.data(), text.size());
  length_ += text.size();
}

void FixedText::add_json_string(std::string_view text) {
  add("\"");
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      print("\\%c", c);
    else if (byte < 0x20)
      print("\\u%04x", byte);
    else
      add({&c, 1});
  }
  add("\"");
}

void FixedText::shorten(std::size_t length) {
  BINPICK_ASSERT(length <= length_);
  length_ = length;
  whole_ = true;
}

}  // namespace binpick::app
