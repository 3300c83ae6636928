#include "model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "setup_error.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

void expect_refused(const std::string& path, const std::string& reason) {
  EXPECT_THAT([&] { ModelFile file(path); },
              ThrowsMessage<SetupError>(AllOf(HasSubstr(path), HasSubstr(reason))));
}

TEST(ModelFile, NamesTheFileThatIsMissing) {
  const TemporaryFolder folder;
  expect_refused(folder.file("bolt.bpm"), "there is no such model file");
  expect_refused(folder.path(), "there is no such model file");
}

TEST(ModelFile, RefusesForeignBytes) {
  const TemporaryFolder folder;
  const std::string path = folder.file("photo.bpm");
  std::ofstream(path) << std::string(4096, '#');
  expect_refused(path, "not a binpick model file");
}

TEST(ModelFile, RefusesAnEmptyFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("empty.bpm");
  std::ofstream{path};
  expect_refused(path, "model file");
}

}  // namespace
}  // namespace binpick::app
