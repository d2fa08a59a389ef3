// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels and fat in a recording: names, columns, and files that lie about them.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recorded_columns.h"
#include "recorder/recording/recover.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/recording/support/synthetic.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using test::Folder;
using test::makeHeader;
using test::randomStep;
using test::withStructures;

/// What opening and reading everything says; empty: nothing is wrong.
std::string faultOf(const std::filesystem::path& path) {
  try {
    const ChainVerdict chain = probe(path);
    return chain.intact() ? "" : chain.fault == ChainFault::start ? "chain: its start" : "chain: later";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::damaged) << e.what();
    return e.what();
  }
}

/// Changes a closed recording through the library, as an editor of HDF5 files would.
void edit(const std::filesystem::path& path, const std::function<void(hid_t)>& how) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  how(file);
  EXPECT_GE(H5Fclose(file), 0);
}

/// Puts fixed-length strings of so many bytes each, or variable ones (0), in place of a data set of names.
void putNames(hid_t file, const char* path, const std::vector<std::string>& names, std::size_t bytes) {
  if (H5Lexists(file, path, H5P_DEFAULT) > 0) H5Ldelete(file, path, H5P_DEFAULT);
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, bytes == 0 ? H5T_VARIABLE : bytes);
  const hsize_t count = names.size();
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t d = H5Dcreate2(file, path, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(d, 0);
  std::string packed(bytes * names.size(), '\0');
  std::vector<const char*> pointers;
  for (std::size_t i = 0; i < names.size(); ++i) {
    pointers.push_back(names[i].c_str());
    if (bytes > 0) names[i].copy(&packed[i * bytes], bytes);
  }
  const void* data = bytes == 0 ? static_cast<const void*>(pointers.data()) : packed.data();
  if (count > 0) {
    EXPECT_GE(H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), 0);
  }
  H5Dclose(d);
  H5Sclose(space);
  H5Tclose(type);
}

template <class T>
void putValue(hid_t file, const char* path, hid_t type, std::vector<hsize_t> place, T value) {
  const hid_t d = H5Dopen2(file, path, H5P_DEFAULT);
  const hid_t space = H5Dget_space(d);
  const hid_t one = H5Screate(H5S_SCALAR);
  H5Sselect_elements(space, H5S_SELECT_SET, 1, place.data());
  EXPECT_GE(H5Dwrite(d, type, one, space, H5P_DEFAULT, &value), 0);
  H5Sclose(one);
  H5Sclose(space);
  H5Dclose(d);
}

TEST(Structures, AreOrgansThenVesselsThenFat) {
  const AttemptHeader header = withStructures(makeHeader(10, 2), 2, 1);
  EXPECT_EQ(header.structures(), (std::vector<std::string>{"organ0", "organ1", "vessel0", "vessel1", "fat0"}));
}

TEST(Structures, SurviveRecovery) {
  const Folder folder;
  const AttemptHeader header = withStructures(makeHeader(10, 2), 2, 1);
  test::writeRecording(folder / "r.h5", header, 130);
  EXPECT_EQ(recover(folder / "r.h5", folder / "o.h5", false).steps, 130U);
  Recording r(folder / "r.h5");
  Recording o(folder / "o.h5");
  EXPECT_EQ(o.header().structures(), header.structures());
  EXPECT_EQ(o.status().back().chain, r.status().back().chain);
  for (const std::uint64_t n : {std::uint64_t{0}, std::uint64_t{129}}) {
    const test::Step made = randomStep(header, n, 1);
    EXPECT_TRUE(o.step(n).result.isSameAs(made.result));
  }
}

TEST(Structures, AreNamedInExportedTitles) {
  const Folder folder;
  test::writeRecording(folder / "r.h5", withStructures(makeHeader(10, 2), 2, 1), 30);
  Recording r(folder / "r.h5");
  exportCsv(r, folder / "csv", false, {});
  const auto firstLine = [&](const char* file) {
    std::ifstream in(folder / "csv" / file);
    std::string line;
    std::getline(in, line);
    return line;
  };
  const std::string hand = firstLine("observables_left.csv");
  EXPECT_NE(
      hand.find("organ_force[organ1] (N),organ_force[vessel0] (N),organ_force[vessel1] (N),organ_force[fat0] (N)"),
      std::string::npos)
      << hand;
  EXPECT_NE(hand.find(",cautery,clips"), std::string::npos) << hand;
  EXPECT_NE(firstLine("observables_vessels.csv").find("largest_tension[vessel1] (N)"), std::string::npos);
  EXPECT_NE(firstLine("observables_fat.csv").find("to_clear[fat0] (m^3)"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "csv" / "observables_procedure.csv"));
}

/// Recordings of version 2 have neither, whatever else a file holds under these names.
TEST(EarlierVersion, HasOrgansAlone) {
  const Folder folder;
  AttemptHeader header = makeHeader();
  header.stepResultVersion = 2;
  test::writeRecording(folder / "r.h5", header, 60);
  edit(folder / "r.h5", [](hid_t file) { putNames(file, "/scene/vessels", {"duct"}, 4); });
  Recording r(folder / "r.h5");
  EXPECT_TRUE(r.verifyChain().intact());
  EXPECT_EQ(r.header().structures(), header.organs);
  const StepResult made = randomStep(header, 59, 1).result;
  const StepResult read = r.step(59).result;
  EXPECT_EQ(read.hand[1].structureForce, made.hand[1].structureForce);
  EXPECT_EQ(read.hand[1].graspForce, made.hand[1].graspForce);
  EXPECT_EQ(read.organ[1].volume, made.organ[1].volume);
  EXPECT_EQ(read.hand[1].clips, 0U);
  EXPECT_EQ(read.hand[1].cautery, Cautery::off);
  EXPECT_EQ(read.organ[1].charredArea, 0.0);
  EXPECT_TRUE(read.vessel.empty() && read.fat.empty());
}

TEST(EarlierVersion, CannotBeWrittenWithVesselsOrFat) {
  const Folder folder;
  AttemptHeader header = withStructures(makeHeader(), 1, 0);
  header.stepResultVersion = 2;
  EXPECT_THROW(RecordingWriter(folder / "r.h5", header), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Structures, AreAtMostThoseOfAScene) {
  const Folder folder;
  EXPECT_THROW(RecordingWriter(folder / "r.h5", withStructures(makeHeader(10, 8), 8, 1)), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  test::writeRecording(folder / "r.h5", withStructures(makeHeader(10, 7), 8, 1), 3);
  EXPECT_EQ(faultOf(folder / "r.h5"), "");
}

TEST(HostileNames, AreDamageAndNamed) {
  const Folder folder;
  test::writeRecording(folder / "whole.h5", withStructures(makeHeader(10, 4), 6, 6), 30);
  ASSERT_EQ(faultOf(folder / "whole.h5"), "");
  const std::vector<std::string> six{"a", "b", "c", "d", "e", "f"};
  const std::vector<std::string> seven{"a", "b", "c", "d", "e", "f", "g"};
  using Names = std::vector<std::string>;
  const struct {
    const char* path;
    Names names;
    std::size_t bytes;
    const char* fault;
  } cases[] = {
      {"/scene/vessels", six, 0, "variable length"},
      {"/scene/vessels", {"a", "b", "c", "d", "e", std::string("f\0g", 3)}, 3, "zero inside"},
      {"/scene/vessels", six, 2000, "fixed-length"},
      {"/scene/vessels", Names(17, "a"), 1, "shape"},
      {"/scene/vessels", {}, 1, "shape"},
      {"/scene/vessels", seven, 1, "more than 16"},
      {"/scene/fat", seven, 1, "more than 16"},
      {"/scene/fat", {"a"}, 1, "wrong shape"},
      {"/scene/fat", {"a", "b", "c", "d", "e", "f"}, 0, "/scene/fat"},
      {"/scene/vessels", six, 1, "chain: its start"},
      {"/scene/fat", six, 1, "chain: its start"},
  };
  for (const auto& c : cases) {
    std::filesystem::copy_file(folder / "whole.h5", folder / "c.h5", std::filesystem::copy_options::overwrite_existing);
    edit(folder / "c.h5", [&](hid_t file) { putNames(file, c.path, c.names, c.bytes); });
    const std::string fault = faultOf(folder / "c.h5");
    EXPECT_NE(fault.find(c.fault), std::string::npos) << c.path << ": " << fault;
    EXPECT_THROW(recover(folder / "c.h5", folder / "o.h5", false), Error) << c.fault;
  }
  for (const char* path : {"/scene/vessels", "/scene/fat"}) {  // lost, and of another kind
    std::filesystem::copy_file(folder / "whole.h5", folder / "c.h5", std::filesystem::copy_options::overwrite_existing);
    edit(folder / "c.h5", [&](hid_t file) { H5Ldelete(file, path, H5P_DEFAULT); });
    EXPECT_NE(faultOf(folder / "c.h5"), "") << path;
    edit(folder / "c.h5", [&](hid_t file) { H5Gclose(H5Gcreate2(file, path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); });
    EXPECT_NE(faultOf(folder / "c.h5").find(path), std::string::npos) << path;
  }
}

TEST(HostileValues, AreNamedWithTheirRow) {
  const Folder folder;
  test::writeRecording(folder / "whole.h5", withStructures(makeHeader(), 2, 1), 60);
  const struct {
    const char* path;
    std::vector<hsize_t> place;
    std::uint8_t value;
  } cases[] = {{"/observables/left/cautery", {31}, 3},
               {"/observables/vessels/asleep", {31, 1}, 2},
               {"/observables/fat/asleep", {31, 0}, 255}};
  for (const auto& c : cases) {
    std::filesystem::copy_file(folder / "whole.h5", folder / "c.h5", std::filesystem::copy_options::overwrite_existing);
    edit(folder / "c.h5", [&](hid_t file) { putValue(file, c.path, H5T_NATIVE_UINT8, c.place, c.value); });
    const std::string fault = faultOf(folder / "c.h5");
    EXPECT_NE(fault.find(std::string(c.path) + "[31]"), std::string::npos) << fault;
  }
}

}  // namespace
}  // namespace calot::recorder
