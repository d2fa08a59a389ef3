// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/attempt.h"

#include <fmt/format.h>
#include <sodium.h>

#include "recorder/base/dates.h"
#include "sim/scene/version.h"

#ifndef CALOT_VERSION
#error "CALOT_VERSION is set by the build"
#endif

namespace calot::recorder {

std::string newUuid() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
  std::array<unsigned char, 16> b{};
  randombytes_buf(b.data(), b.size());
  b[6] = static_cast<unsigned char>((b[6] & 0x0FU) | 0x40U);
  b[8] = static_cast<unsigned char>((b[8] & 0x3FU) | 0x80U);
  std::string text;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", b[i]);
  }
  return text;
}

std::string softwareName() { return "calot " CALOT_VERSION; }

std::string buildName() {
  std::string compiler;
#if defined(__clang__)
  compiler = fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  compiler = fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
  return fmt::format("{} {} {}", compiler, CALOT_BUILD_TYPE, CALOT_REVISION);
}

AttemptHeader makeHeader(const Model& model, std::vector<Asset> assets, const Provenance& provenance,
                         const AttemptSettings& settings) {
  AttemptHeader header;
  static_cast<AttemptSettings&>(header) = settings;
  header.attempt = newUuid();
  header.startUtc = presentDate();
  header.software = softwareName();
  header.build = buildName();
  header.simulationVersion = simulationVersion;
  header.stepResultVersion = stepResultVersion;
  header.provenance = provenance;
  header.ticksPerStep = model.scene().ticksPerStep;
  header.sceneName = model.scene().name;
  header.sceneMajor = model.scene().majorVersion;
  header.sceneMinor = model.scene().minorVersion;
  header.assets = std::move(assets);
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId kind) {
    if constexpr (Kind::hasStructures) {
      for (const StructureModel& structure : model.structures()) {
        if (structure.kind == kind) Kind::namesOf(header).push_back(structure.name);
      }
    }
  });
  header.layout = model.layout();
  header.deviceSamples = !provenance.device.empty();
  return header;
}

}  // namespace calot::recorder
