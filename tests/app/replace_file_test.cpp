#include "replace_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "setup_error.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Throws;
using testing::ThrowsMessage;

void replace_with(const std::string& path, const std::string& text) {
  replace_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ReplaceFile, WritesANewFileAndReplacesAnOldOne) {
  const TemporaryFolder folder;
  const std::string path = folder.file("model.bpm");
  replace_with(path, "first");
  EXPECT_EQ(text_of(path), "first");
  replace_with(path, "second, longer");
  EXPECT_EQ(text_of(path), "second, longer");
  EXPECT_EQ(folder.file_count(), 1);
}

TEST(ReplaceFile, ReplacesWhatALinkPointsAt) {
  const TemporaryFolder folder;
  replace_with(folder.file("target"), "old");
  fs::create_symlink(folder.file("target"), folder.file("link"));
  replace_with(folder.file("link"), "new");
  EXPECT_TRUE(fs::is_symlink(folder.file("link")));
  EXPECT_EQ(text_of(folder.file("target")), "new");
}

TEST(ReplaceFile, RefusesAFolderThatDoesNotExist) {
  const TemporaryFolder folder;
  const std::string path = folder.file("missing/model.bpm");
  EXPECT_THAT([&] { check_replaceable(path); }, ThrowsMessage<SetupError>(HasSubstr(path)));
  EXPECT_THAT([&] { replace_with(path, "x"); }, ThrowsMessage<SetupError>(HasSubstr(path)));
}

TEST(ReplaceFile, RefusesWhatIsNotAFile) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { check_replaceable(folder.path()); }, Throws<SetupError>());
  EXPECT_THAT([] { check_replaceable("/dev/null"); }, Throws<SetupError>());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(ReplaceFile, CheckLeavesNothingBehind) {
  const TemporaryFolder folder;
  check_replaceable(folder.file("model.bpm"));
  EXPECT_EQ(folder.file_count(), 0);
  replace_with(folder.file("model.bpm"), "old");
  check_replaceable(folder.file("model.bpm"));
  EXPECT_EQ(folder.file_count(), 1);
  EXPECT_EQ(text_of(folder.file("model.bpm")), "old");
}

}  // namespace
}  // namespace binpick::app
