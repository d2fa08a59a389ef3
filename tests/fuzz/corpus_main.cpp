// SPDX-License-Identifier: GPL-3.0-or-later
// Runs every file of a corpus through its fuzz target, without a fuzzer: what was once found stays found.
// usage: fuzz_corpus TARGET FOLDER
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#define CALOT_FUZZ_TARGET(name) extern "C" int fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inc"
#undef CALOT_FUZZ_TARGET

namespace {

struct Target {
  const char* name;
  int (*run)(const std::uint8_t* data, std::size_t size);
};

constexpr Target targets[] = {
#define CALOT_FUZZ_TARGET(name) {#name, fuzz_##name},
#include "fuzz_targets.inc"
#undef CALOT_FUZZ_TARGET
};

}  // namespace

int main(int count, char** words) {
  if (count != 3) return 2;
  const auto* target = std::find_if(std::begin(targets), std::end(targets),
                                    [&](const Target& t) { return std::strcmp(t.name, words[1]) == 0; });
  if (target == std::end(targets)) return 2;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(words[2])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    std::printf("%s\n", file.filename().c_str());
    std::fflush(stdout);  // the last one is the one that ends it
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(in), {});
    target->run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  std::printf("%zu inputs of %s\n", files.size(), words[1]);
  return files.empty() ? 1 : 0;
}
