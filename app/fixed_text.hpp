// Text put together in memory that somebody else owns: no allocation, never beyond its end. What
// does not fit is left out and remembered. Thread: one at a time.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace binpick::app {

class FixedText {
 public:
  explicit FixedText(std::span<char> memory) : memory_(memory) {}

  // As printf. All of it or, where it does not fit, nothing from here on.
  void print(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void add(std::string_view text);
  // In quotes, with what JSON wants to be escaped; bytes that are no ASCII pass as they are.
  void add_json_string(std::string_view text);

  void clear() { length_ = 0, whole_ = true; }
  // Forgets what came after the first `length` characters.
  void shorten(std::size_t length);
  std::string_view text() const { return {memory_.data(), length_}; }
  std::size_t length() const { return length_; }
  bool whole() const { return whole_; }  // nothing was left out

 private:
  std::span<char> memory_;
  std::size_t length_ = 0;
  bool whole_ = true;
};

}  // namespace binpick::app
