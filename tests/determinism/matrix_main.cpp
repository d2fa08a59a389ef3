// SPDX-License-Identifier: GPL-3.0-or-later
// One cell of the determinism matrix: links the core alone, goes on from a stored State, prints the digests of every
// step. Any two builds must print the same.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "sim/haptics/haptic_tick.h"
#include "sim/scene/flat.h"
#include "sim/scene/version.h"
#include "sim/step/stepper.h"
#include "tests/determinism/large_solid.h"
#include "tests/determinism/thread_executor.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#ifdef __wasm__
// A module here cannot unwind: what would be thrown ends it.
extern "C" {
void* __cxa_allocate_exception(std::size_t bytes) noexcept { return std::malloc(bytes); }
[[noreturn]] void __cxa_throw(void* /*thrown*/, void* /*type*/, void (* /*destroy*/)(void*)) { std::abort(); }
}
#endif

namespace {

std::vector<std::byte> readFile(const char* path) {
  std::vector<std::byte> bytes;
  std::FILE* file = std::fopen(path, "rb");
  if (file == nullptr) return bytes;
  std::byte buffer[65536];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;)
    bytes.insert(bytes.end(), buffer, buffer + n);
  std::fclose(file);
  return bytes;
}

/// What a host program may have done before it calls us.
void setFlushToZero() {
#if defined(__x86_64__)
  _mm_setcsr(_mm_getcsr() | 0x8040U);
#elif defined(__aarch64__)
  asm volatile("msr fpcr, %0" : : "r"(std::uint64_t{1} << 24U));
#endif
}

int run(const char* path, unsigned threads) {
  using namespace calot;
  FlatState flat;
  if (!loadFlat(readFile(path), flat)) {
    std::fprintf(stderr, "%s: is no flat state; make one with: calot state R.h5 --step N --flat -o %s\n", path, path);
    return 4;
  }
  Model::Built built = Model::build(flat.scene);
  if (!built.model) {
    std::fprintf(stderr, "%s: scene: %s\n", path, built.error.c_str());
    return 4;
  }
  State state;
  if (!restoreState(*built.model, flat.state, state)) {
    std::fprintf(stderr, "%s: the State does not fit the scene's model\n", path);
    return 4;
  }
  ThreadExecutor executor(threads);
  Stepper stepper(*built.model, executor);
  const std::size_t perStep = flat.scene.ticksPerStep;
  std::array<HapticState, handCount> haptic;
  std::array<HapticModel, handCount> hapticOf{hapticModel(*built.model, 0), hapticModel(*built.model, 1)};
  for (std::size_t h = 0; h < handCount; ++h) haptic[h] = initialHaptics(state, h);
  std::printf("simulation %u\n", simulationVersion);
  const std::span<const TickSamples> all(flat.ticks);
  for (std::size_t at = 0; at + perStep <= all.size(); at += perStep) {
    DigestStream forces;
    for (std::size_t i = 0; i < perStep; ++i) {
      for (std::size_t h = 0; h < handCount; ++h) {
        takeSample(*built.model, h, all[at + i].hand[h], haptic[h]);
        const HapticForce force = hapticTick(hapticOf[h], haptic[h], stepper.contactSet(h));
        forces.append(force.force.data(), sizeof force.force);
      }
    }
    stepper.step(state, all.subspan(at, perStep));
    const StateDigest& digest = stepper.digest(state);
    std::printf("%llu forces %016llx", static_cast<unsigned long long>(state.clock.step - 1),
                static_cast<unsigned long long>(forces.value()));
    for (const std::uint64_t d : digest.component) std::printf(" %016llx", static_cast<unsigned long long>(d));
    std::printf("\n");
  }
  return 0;
}

int runLargeSolid(unsigned threads) {
  calot::ThreadExecutor executor(threads);
  for (const std::uint64_t digest : calot::test::largeSolid(executor)) {
    std::printf("%016llx\n", static_cast<unsigned long long>(digest));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* path = nullptr;
  unsigned threads = 1;
  bool largeSolid = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--flush-to-zero") == 0) {
      setFlushToZero();
    } else if (std::strcmp(argv[i], "--large-solid") == 0) {
      largeSolid = true;
    } else if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc) {
      threads = static_cast<unsigned>(std::strtoul(argv[++i], nullptr, 10));
    } else if (path == nullptr && argv[i][0] != '-') {
      path = argv[i];
    } else {
      path = nullptr;
      break;
    }
  }
  if ((path != nullptr) == largeSolid || threads == 0) {
    std::fprintf(stderr, "usage: calot-matrix FLAT|--large-solid [--threads N] [--flush-to-zero]\n");
    return 2;
  }
  return largeSolid ? runLargeSolid(threads) : run(path, threads);
}
