// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/recording/hdf5.h"

namespace calot::recorder {

using hdf5::Id;

Superblock readSuperblock(const std::filesystem::path& path) {
  const auto refuse = [&](const char* why) { throw Error(ErrorKind::damaged, Where{path.string()}, why); };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) refuse("no such file");
  if (std::filesystem::is_directory(status)) refuse("is a folder, not a recording");
  if (!std::filesystem::is_regular_file(status)) refuse("is not a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse("cannot be opened; check its permissions");
  std::array<char, 36> head{};
  in.read(head.data(), head.size());
  if (in.gcount() == 0) refuse("is empty");
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  if (in.gcount() < static_cast<std::streamsize>(head.size()) ||
      !std::string_view(head.data(), 8).starts_with(signature))
    refuse("is not an HDF5 file, so not a recording");
  // HDF5 File Format Specification 3.0, II.A: byte 8 version, 9 size of offsets, 11 consistency flags, 28 end of file.
  Superblock s;
  s.version = static_cast<unsigned char>(head[8]);
  s.writing = s.version >= 2 && (static_cast<unsigned char>(head[11]) & 0x5U) != 0;
  if (s.version >= 2 && head[9] == 8) std::memcpy(&s.endOfFile, &head[28], sizeof s.endOfFile);
  return s;
}

std::uint64_t sizeOfFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

hdf5::Id openForReading(const std::filesystem::path& path, Access access) {
  const Superblock superblock = readSuperblock(path);
  const Id how = hdf5::fileAccess(access == Access::settled ? 1 : 0);
  const unsigned swmr = superblock.writing ? H5F_ACC_SWMR_READ : 0U;
  // An existing handle of the file in this process decides how it is closed: another file library has the default.
  for (const H5F_close_degree_t degree : {H5F_CLOSE_DEFAULT, H5F_CLOSE_STRONG}) {
    H5Pset_fclose_degree(how.get(), degree);
    const auto open = [&] { return hdf5::open(path, H5F_ACC_RDONLY | swmr, how); };
    Id file = open();
    if (!file.valid()) continue;
    checkShape(path, file, sizeOfFile(path));
    if (!superblock.writing) return file;
    // Cached objects keep the extents that they had then, and the file grows: they are discarded.
    file.reset();
    file = open();
    if (file.valid()) return file;
  }
  const std::string why = hdf5::reason();
  const std::uint64_t bytes = sizeOfFile(path);
  if (superblock.endOfFile > bytes && !superblock.writing) {
    throw Error(ErrorKind::damaged, Where{path.string()},
                fmt::format("is cut off: {} of {} bytes are there", bytes, superblock.endOfFile), {Remedy::recover});
  }
  throw Error(why == hdf5::lockedByAnother ? ErrorKind::failure : ErrorKind::damaged, Where{path.string()},
              fmt::format("cannot be opened: {}", why));
}

namespace {

using hdf5::damaged;

/// Names that one group may hold, and attributes of one object. The format has 130 and at most 999 assets, and 29.
constexpr std::uint64_t maxLinks = 4096;
constexpr std::uint64_t maxAttributes = 256;
/// Stored together, and so unfolded together (bytes). Those of the format have 64 KiB, names more.
constexpr std::uint64_t maxChunkBytes = std::uint64_t{4} << 20U;
constexpr int maxDepth = 8;
constexpr std::size_t maxLinkName = 255;
/// Deflate cannot shrink more than 1032 to 1.
constexpr std::uint64_t mostUnfolding = 1040;
constexpr unsigned externalFiles = 7;  ///< type of the message that names them (HDF5 File Format Specification 3.0)

struct Links {
  std::vector<std::string> names;
  const char* fault = nullptr;  ///< of the one that comes next; its name is `at`
  std::string at;
};

const char* faultOf(H5L_type_t type) {
  switch (type) {
    case H5L_TYPE_HARD:
      return nullptr;
    case H5L_TYPE_SOFT:
      return "is a soft link; a recording has no links but its own objects";
    case H5L_TYPE_EXTERNAL:
      return "is a link to another file; a recording has no links but its own objects";
    default:
      return "is a link of an unknown kind; a recording has no links but its own objects";
  }
}

extern "C" herr_t calotTakeLink(hid_t /*group*/, const char* name, const H5L_info_t* info, void* out) {
  Links& links = *static_cast<Links*>(out);
  links.at = std::string(name).substr(0, maxLinkName);
  links.fault = faultOf(info->type);
  if (std::string_view(name).size() > maxLinkName) links.fault = "has a name that is too long";
  if (links.names.size() >= maxLinks) links.fault = "is one name too many in its group";
  if (links.fault != nullptr) return 1;
  links.names.push_back(links.at);
  return 0;
}

class ShapeCheck {
 public:
  ShapeCheck(const std::filesystem::path& path, std::uint64_t fileBytes) : path_(path), fileBytes_(fileBytes) {}

  /// @param place of the group, ending in a slash
  void group(hid_t group, const std::string& place, int depth) {
    H5G_info_t info{};
    if (H5Gget_info(group, &info) < 0) return;
    if (info.nlinks > maxLinks)
      refuse(place, fmt::format("holds {} names; that of a recording has at most {}", info.nlinks, maxLinks));
    Links links;
    const herr_t walked = H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, calotTakeLink, &links);
    if (links.fault != nullptr) refuse(place + links.at, links.fault);
    if (walked < 0) return;
    for (const std::string& name : links.names) object(group, name, place + name, depth);
  }

 private:
  [[noreturn]] void refuse(const std::string& place, const std::string& why) const { throw damaged(path_, place, why); }

  void object(hid_t parent, const std::string& name, const std::string& place, int depth) {
    H5O_info_t info{};
    const unsigned fields = H5O_INFO_BASIC | H5O_INFO_NUM_ATTRS | H5O_INFO_HDR;
    if (H5Oget_info_by_name2(parent, name.c_str(), &info, fields, H5P_DEFAULT) < 0) return;
    if (info.rc > 1 || !seen_.insert(info.addr).second)
      refuse(place, "is a second name of one object; in a recording each has one");
    if (info.num_attrs > maxAttributes)
      refuse(place,
             fmt::format("has {} attributes; those of a recording have at most {}", info.num_attrs, maxAttributes));
    if (info.type == H5O_TYPE_GROUP) {
      if (depth == maxDepth) refuse(place, "lies too deep");
      const Id below = hdf5::group(H5Gopen2(parent, name.c_str(), H5P_DEFAULT));
      if (below.valid()) group(below.get(), place + "/", depth + 1);
    } else if (info.type == H5O_TYPE_DATASET) {
      if ((info.hdr.mesg.present >> externalFiles & 1U) != 0) refuse(place, "keeps its data in other files");
      const Id dataset = hdf5::dataset(H5Dopen2(parent, name.c_str(), H5P_DEFAULT));
      if (dataset.valid()) values(dataset.get(), place);
    } else {
      refuse(place, "is neither a group nor a data set");
    }
  }

  void values(hid_t dataset, const std::string& place) const {
    const Id how = hdf5::properties(H5Dget_create_plist(dataset));
    if (!how.valid()) return;
    const H5D_layout_t layout = H5Pget_layout(how.get());
    // Even querying the extent of such a data set opens its sources.
    if (layout == H5D_VIRTUAL) refuse(place, "is made of other data sets");
    for (int i = 0; i < H5Pget_nfilters(how.get()); ++i) {
      unsigned flags = 0, config = 0;
      std::size_t parameters = 0;
      const H5Z_filter_t filter =
          H5Pget_filter2(how.get(), static_cast<unsigned>(i), &flags, &parameters, nullptr, 0, nullptr, &config);
      if (filter < H5Z_FILTER_DEFLATE || filter > H5Z_FILTER_SCALEOFFSET)
        refuse(place, fmt::format("is packed by filter {}, which does not come with HDF5", filter));
    }
    const Id type = hdf5::type(H5Dget_type(dataset));
    const Id space = hdf5::space(H5Dget_space(dataset));
    if (!type.valid() || !space.valid()) return;
    if (H5Tdetect_class(type.get(), H5T_VLEN) > 0 || H5Tis_variable_str(type.get()) > 0)
      refuse(place, "holds values of variable length");
    const std::uint64_t element = H5Tget_size(type.get());
    const int rank = H5Sget_simple_extent_ndims(space.get());
    if (rank < 0 || rank > 2) refuse(place, "has the wrong shape");
    std::array<hsize_t, 2> extent{1, 1};
    if (rank > 0) H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
    const std::uint64_t most = fileBytes_ < UINT64_MAX / mostUnfolding ? fileBytes_ * mostUnfolding : UINT64_MAX;
    if (product(product(extent[0], extent[1]), element) > most)
      refuse(place, "claims more bytes than the file can hold");
    if (layout != H5D_CHUNKED) return;
    std::array<hsize_t, 2> chunk{1, 1};
    if (H5Pget_chunk(how.get(), 2, chunk.data()) < 0) return;
    const std::uint64_t bytes = product(product(chunk[0], chunk[1]), element);
    if (bytes > maxChunkBytes)
      refuse(place, fmt::format("has chunks of {} bytes; those of a recording have at most {}", bytes, maxChunkBytes));
  }

  /// The greatest number where there is none so great.
  static std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    return b != 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
  }

  const std::filesystem::path& path_;
  std::uint64_t fileBytes_;
  std::set<haddr_t> seen_;
};

}  // namespace

void checkShape(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes) {
  const Id root = hdf5::group(H5Gopen2(file.get(), "/", H5P_DEFAULT));
  if (root.valid()) ShapeCheck(path, fileBytes).group(root.get(), "/", 0);
}

namespace {

/// hashlittle() of lookup3 (R. Jenkins, 2006), initial value 0: the checksum of HDF5's metadata.
std::uint32_t lookup3(std::span<const unsigned char> bytes) {
  std::uint32_t a = 0xdeadbeefU + static_cast<std::uint32_t>(bytes.size()), b = a, c = a;
  if (bytes.empty()) return c;
  const auto addTwelve = [&](const unsigned char* p) {
    std::array<std::uint32_t, 3> word;
    std::memcpy(word.data(), p, 12);
    a += word[0];
    b += word[1];
    c += word[2];
  };
  while (bytes.size() > 12) {
    addTwelve(bytes.data());
    a -= c, a ^= std::rotl(c, 4), c += b;
    b -= a, b ^= std::rotl(a, 6), a += c;
    c -= b, c ^= std::rotl(b, 8), b += a;
    a -= c, a ^= std::rotl(c, 16), c += b;
    b -= a, b ^= std::rotl(a, 19), a += c;
    c -= b, c ^= std::rotl(b, 4), b += a;
    bytes = bytes.subspan(12);
  }
  std::array<unsigned char, 12> last{};
  std::memcpy(last.data(), bytes.data(), bytes.size());
  addTwelve(last.data());
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
  return c;
}

/// Clears the flag of an active writer in the superblock (version 2 or 3, 8-byte offsets) of a file's image.
/// @return false if it is no such superblock.
bool markClosed(std::span<unsigned char> image) {
  constexpr std::size_t version = 8, sizeOfOffsets = 9, flags = 11, checksum = 44;
  if (image.size() < checksum + 4 || image[version] < 2 || image[version] > 3 || image[sizeOfOffsets] != 8)
    return false;
  image[flags] = 0;
  const std::uint32_t sum = lookup3(image.first(checksum));
  std::memcpy(&image[checksum], &sum, sizeof sum);
  return true;
}

}  // namespace

std::string closedImage(hdf5::Id& file) {
  if (H5Fflush(file.get(), H5F_SCOPE_LOCAL) < 0) return "";
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  if (size <= 0) return "";
  std::string image(static_cast<std::size_t>(size), '\0');
  const bool done = H5Fget_file_image(file.get(), image.data(), image.size()) == size && file.reset() &&
                    markClosed({reinterpret_cast<unsigned char*>(image.data()), image.size()});
  return done ? image : "";
}

}  // namespace calot::recorder
