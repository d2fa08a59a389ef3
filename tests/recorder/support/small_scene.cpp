// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/support/small_scene.h"

#include <unistd.h>

#include <stdexcept>

#include "recorder/sources/performer.h"

namespace calot::recorder::test {

namespace {

const std::filesystem::path assets = std::filesystem::path(CALOT_SOURCE_DIR) / "assets";

class Later final : public SampleSource {
 public:
  Later(PerformerSource source, std::uint64_t begin) : source_(std::move(source)), begin_(begin) {}
  [[nodiscard]] const Provenance& provenance() const override { return source_.provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override { return source_.next(begin_ + tick, out); }

 private:
  PerformerSource source_;
  std::uint64_t begin_;
};

}  // namespace

SmallScene smallScene() {
  std::vector<Asset> files = loadScene(assets / "scenes" / "touch-liver.json").assets;
  std::string text(reinterpret_cast<const char*>(files[0].bytes.data()), files[0].bytes.size());
  text.replace(text.find("1489"), 4, "300");
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  files[0].bytes.assign(bytes, bytes + text.size());
  LoadedScene loaded = sceneFromAssets(files);
  Model::Built built = Model::build(std::move(loaded.description));
  if (!built.model) throw std::runtime_error(built.error);
  return {std::move(loaded.assets), std::move(built.model)};
}

std::unique_ptr<SampleSource> performer(const SmallScene& scene, const std::string& profile, std::uint64_t seed,
                                        std::uint64_t begin) {
  return std::make_unique<Later>(
      PerformerSource(loadPerformer(assets / "performers" / (profile + ".json")), scene.model->scene(), seed), begin);
}

Folder::Folder() {
  static int number = 0;
  path_ = std::filesystem::temp_directory_path() /
          ("calot-loop-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
  std::filesystem::create_directories(path_);
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace calot::recorder::test
