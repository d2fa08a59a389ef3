// SPDX-License-Identifier: GPL-3.0-or-later
// A device as the source of an attempt: the options of every command that takes one.
#pragma once

#include <array>
#include <atomic>
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "recorder/loop.h"
#include "recorder/base/identity.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/open_device.h"
#include "sim/scene/description.h"

namespace calot::apps {

struct DeviceOptions {
  std::string name, calibration;
  std::vector<std::string> tools{"LeftTool", "RightTool"};
};

/// --tools, which commands share. @param options outlives the parsing.
void addTools(CLI::App& command, DeviceOptions& options);

/// Left and right; "-" stands for none. @throws Error (invalid) unless there are two.
std::array<std::string, handCount> toolsOf(const DeviceOptions& options);

/// Opens the device, takes its calibration, waits for its first samples (at most ten seconds).
/// @throws Error: invalid, for names, and for an assessment without calibration; refused, for a calibration that is not
/// to be used; damaged, for files; failure, where the device is not there or says nothing.
std::unique_ptr<recorder::DeviceSource> makeDeviceSource(const DeviceOptions& options, const SceneDescription& scene,
                                                         recorder::Mode mode, const std::atomic<bool>* stop);

/// Where the source is a device: runs it at the pace of the clock if it lives in real time, and lets its motors have
/// the forces. @param source outlives the run.
void driveDevice(recorder::SampleSource& source, recorder::RunSettings& run);

/// Where the source is a device: its raw samples go into the recording. @param firstTick as
/// RecordingWriter::takeRawSamples. Source and writer outlive the run.
void recordDevice(recorder::SampleSource& source, recorder::RecordingWriter& writer, std::uint64_t firstTick = 0);

/// Where the source is a device: what came from it, on stdout.
void tellDevice(recorder::SampleSource& source);

}  // namespace calot::apps
