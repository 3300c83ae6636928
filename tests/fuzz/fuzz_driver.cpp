// Runs a libFuzzer entry without libFuzzer: each file of a corpus as it is, then mutations of them
// (bits, bytes, words, cuts, repeats, joins) for a number of seconds. Not guided by coverage, which
// the short frames of our formats do not need much; with clang, -fsanitize=fuzzer takes the same
// entry and the same corpus.
//   PROGRAM CORPUS_FOLDER [SECONDS [SEED]]
// The input that is being run is kept in ./fuzz_input.bin while it runs, and stays there if the
// program dies of it; the seed is printed.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;
constexpr std::size_t kInputBytesMax = 4096;

const Input* running = nullptr;

// Writes the input that killed us; only calls that a signal handler may make.
void keep_input(int signal_number) {
  const int file = ::open("fuzz_input.bin", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0 && running != nullptr) {
    [[maybe_unused]] const auto written = ::write(file, running->data(), running->size());
  }
  ::signal(signal_number, SIG_DFL);
  ::raise(signal_number);
}

void run(const Input& input) {
  running = &input;
  // A copy of exactly its size: reading beyond it is seen by the address sanitizer.
  const Input exact(input.begin(), input.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

std::vector<Input> read_corpus(const char* folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Input> corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

void mutate(Input& input, const std::vector<Input>& corpus, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  static constexpr std::uint8_t kTelling[] = {0, 1, 2, 6, 0x7F, 0x80, 0xFE, 0xFF};
  if (input.empty()) input.push_back(0);
  const std::size_t at = below(input.size());
  switch (below(7)) {
    case 0:
      input[at] ^= static_cast<std::uint8_t>(1U << below(8));
      break;
    case 1:
      input[at] = static_cast<std::uint8_t>(random());
      break;
    case 2:
      input[at] = kTelling[below(std::size(kTelling))];
      break;
    case 3:
      input.resize(at);
      break;
    case 4:
      input.insert(input.begin() + static_cast<std::ptrdiff_t>(at),
                   static_cast<std::uint8_t>(random()));
      break;
    case 5: {
      const Input copy(input.begin() + static_cast<std::ptrdiff_t>(at), input.end());
      input.insert(input.end(), copy.begin(), copy.end());
      break;
    }
    default: {
      const Input& other = corpus[below(corpus.size())];
      input.insert(input.end(), other.begin(), other.end());
    }
  }
  if (input.size() > kInputBytesMax) input.resize(kInputBytesMax);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER [SECONDS [SEED]]\n", argv[0]);
    return 2;
  }
  const double seconds = argc > 2 ? std::atof(argv[2]) : 1;
  const std::uint64_t seed =
      argc > 3 ? std::strtoull(argv[3], nullptr, 10) : std::random_device{}();
  ::signal(SIGABRT, keep_input);
  ::signal(SIGSEGV, keep_input);
  const std::vector<Input> corpus = read_corpus(argv[1]);
  if (corpus.empty()) {
    std::fprintf(stderr, "%s holds no input\n", argv[1]);
    return 1;
  }
  std::printf("seed %llu, %zu inputs\n", static_cast<unsigned long long>(seed), corpus.size());
  std::fflush(stdout);
  for (const Input& input : corpus) run(input);
  std::mt19937_64 random(seed);
  unsigned long long runs = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    Input input = corpus[random() % corpus.size()];
    for (std::uint64_t i = 0, n = 1 + random() % 8; i < n; ++i) mutate(input, corpus, random);
    run(input);
    ++runs;
  }
  std::printf("%llu mutations, nothing found\n", runs);
  return 0;
}
