// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/openigtlink_device.h"

#include <fmt/format.h>
#include <igtl_header.h>
#include <igtl_qtdata.h>
#include <igtl_sensor.h>
#include <igtl_tdata.h>
#include <igtl_transform.h>
#include <igtl_util.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

using openigtlink::Item;

constexpr std::chrono::milliseconds patience{300};
constexpr std::size_t maxFaults = 16;  // kinds of fault reported for a connection
constexpr double maxGripper = 3.2;     // rad
constexpr int statusOk = 1;

void checkTools(const std::array<std::string, handCount>& tools) {
  if (tools[0].empty() && tools[1].empty())
    throw Error(ErrorKind::invalid, "OpenIGTLink: at least one hand needs a tool", {Remedy::nameTools});
  if (tools[0] == tools[1])
    throw Error(ErrorKind::invalid, "OpenIGTLink: both hands have the same tool", {Remedy::nameTools});
  for (const std::string& tool : tools) {
    if (tool.size() > openigtlink::maxName)
      throw Error(ErrorKind::invalid,
                  fmt::format("OpenIGTLink: a tool's name has at most {} characters", openigtlink::maxName),
                  {Remedy::nameTools});
  }
}

}  // namespace

OpenIgtLinkDevice::OpenIgtLinkDevice(OpenIgtLinkSettings settings, DeviceClock clock)
    : ReopeningDevice(std::move(clock)), settings_(std::move(settings)) {
  gone_ = "the server is gone";
  info_.name = openIgtLinkKind.name;
  info_.identity = fmt::format("openigtlink:{}/{},{}", settings_.host, settings_.tool[0], settings_.tool[1]);
  info_.detail = fmt::format("server {}:{}, tools \"{}\" and \"{}\"", settings_.host, settings_.port, settings_.tool[0],
                             settings_.tool[1]);
  info_.capabilities.hands =
      static_cast<int>(!settings_.tool[0].empty()) + static_cast<int>(!settings_.tool[1].empty());
  info_.capabilities.sensesGripper = true;
}

std::string OpenIgtLinkDevice::connect() {
  std::string fault;
  stream_ = TcpStream::connect(settings_.host, settings_.port, patience, fault);
  decoder_.reset();
  told_.clear();
  gripper_.fill(0.0);
  return stream_.open() ? "" : fault;
}

void OpenIgtLinkDevice::tellOnce(DeviceEvent::Kind kind, const std::string& fault, DeviceInput& out) {
  if (told_.size() < maxFaults && told_.insert(fault).second) tell(kind, "openigtlink: " + fault, out);
}

void OpenIgtLinkDevice::take(const Item& item, DeviceInput& out) {
  if (item.kind == Item::Kind::unknown) return;
  if (item.kind == Item::Kind::status) {
    if (item.code != statusOk)
      tellOnce(DeviceEvent::Kind::status, fmt::format("the server says: status {} {}", item.code, item.text), out);
    return;
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::string& tool = settings_.tool[h];
    if (tool.empty()) continue;
    if (item.kind == Item::Kind::number) {
      if (item.name != tool + "Jaw") continue;
      if (std::isfinite(item.value) && std::abs(item.value) <= maxGripper)
        gripper_[h] = std::max(0.0, item.value);
      else
        tellOnce(DeviceEvent::Kind::malformed, fmt::format("{}: an opening that is not an angle", item.name), out);
      return;
    }
    if (item.name != tool) continue;
    out.samples.push_back({.deviceTime = item.time,
                           .hostTime = clock_(),
                           .sequence = sequence_[h]++,
                           .hand = static_cast<Hand>(h),
                           .position = item.position,
                           .orientation = item.orientation,
                           .gripper = gripper_[h],
                           .valid = item.kind == Item::Kind::pose && item.rotation});
    if (item.kind == Item::Kind::pose && !item.rotation)
      tellOnce(DeviceEvent::Kind::malformed,
               fmt::format("{}: a pose that is not finite, too far, or no rotation", item.name), out);
    break;
  }
  if (item.kind == Item::Kind::fault) tellOnce(DeviceEvent::Kind::malformed, item.text, out);
}

void OpenIgtLinkDevice::read(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (wait.count() > 0 && !stream_.readable(wait)) return;
  const auto decode = [&](std::span<const std::byte> bytes) {
    return decoder_.take(bytes, [&](const Item& item) { take(item, out); });
  };
  if (!stream_.receiveAll(decode)) lose("disconnected: what the server sends is no OpenIGTLink", out);
}

OpenedDevice openOpenIgtLink(const DeviceRequest& request) {
  checkTools(request.tools);
  OpenIgtLinkSettings settings;
  settings.tool = request.tools;
  request.readAddress(settings.host, settings.port);
  return {std::make_unique<OpenIgtLinkDevice>(settings), nullptr};
}

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds lookPeriod{50};  // between two looks at `stop`
constexpr std::chrono::milliseconds rest{100};       // between two sendings of the last poses

bool send(TcpStream& client, const std::string& tool, const DeviceSample& sample) {
  if (tool.empty()) return true;
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  std::vector<std::byte> bytes = openigtlink::sensorMessage(tool + "Jaw", now, sample.gripper);
  const std::vector<std::byte> pose = openigtlink::transformMessage(tool, now, sample.position, sample.orientation);
  bytes.insert(bytes.end(), pose.begin(), pose.end());
  return client.send(bytes);
}

void serveClient(TcpStream client, const DeviceScript& motion, const OpenIgtLinkServerSettings& settings,
                 const std::atomic<bool>& stop) {
  const Clock::time_point begin = Clock::now();
  std::array<std::optional<DeviceSample>, handCount> last;
  std::array<std::byte, 4096> unread;  // what clients say is passed over
  for (const DeviceSample& sample : motion.samples) {
    const auto hand = static_cast<std::size_t>(sample.hand);
    const auto due = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::nano>(
                                 static_cast<double>(sample.hostTime) / settings.speed));
    while (Clock::now() < due && !stop) std::this_thread::sleep_until(std::min(due, Clock::now() + lookPeriod));
    if (stop || !send(client, settings.tool[hand], sample)) return;
    client.receive(unread);
    last[hand] = sample;
  }
  while (client.open() && !stop) {
    std::this_thread::sleep_for(rest);
    for (std::size_t h = 0; h < handCount; ++h) {
      if (last[h]) send(client, settings.tool[h], *last[h]);
    }
    client.receive(unread);
  }
}

}  // namespace

void serveOpenIgtLink(const DeviceScript& motion, const OpenIgtLinkServerSettings& settings,
                      const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell) {
  TcpListener listener(settings.port);
  tell(fmt::format("listening on 127.0.0.1:{}", listener.port()));
  listener.serve(stop, settings.once, tell,
                 [&](TcpStream client) { serveClient(std::move(client), motion, settings, stop); });
}

}  // namespace calot::recorder

namespace calot::recorder::openigtlink {
namespace {

constexpr std::size_t headerBytes = IGTL_HEADER_SIZE;
constexpr std::uint64_t maxRead = 65536;                    // body of a type that is read
constexpr std::uint64_t maxBody = std::uint64_t{1} << 32U;  // of any type: an image of 4 GB
constexpr double metresPerMillimetre = 1e-3;
constexpr double farthest = 10.0;        // m
constexpr double orthonormality = 1e-3;  // as kinematics files
static_assert(sizeof(igtl_header) == headerBytes);

std::string textOf(const char* data, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < most && data[i] != '\0'; ++i) text += data[i] >= 0x20 && data[i] < 0x7f ? data[i] : '?';
  return text;
}

template <class T>
T read(std::span<const std::byte> bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

// The wire's time is seconds in 32.32.
std::int64_t nanoseconds(std::uint64_t stamp) {
  if (stamp == 0) return -1;
  return static_cast<std::int64_t>((stamp >> 32U) * 1'000'000'000U +
                                   igtl_frac_to_nanosec(static_cast<igtl_uint32>(stamp & 0xffffffffU)));
}

/// Puts a pose into an item, or nothing if it is invalid.
void setPose(const Vec3& position, bool rotation, const Quat& orientation, Item& item) {
  item.rotation = rotation && position.allFinite() && position.cwiseAbs().maxCoeff() <= farthest;
  item.position = item.rotation ? position : Vec3::Zero();
  if (item.rotation) item.orientation = orientation;
}

Vec3 metres(float x, float y, float z) { return metresPerMillimetre * Eigen::Vector3f(x, y, z).cast<double>(); }

/// Columns of the rotation matrix, then the position (mm).
void readMatrix(const igtl_float32* m, Item& item) {
  const Mat3 r = Eigen::Map<const Eigen::Matrix3f>(m).cast<double>();
  const bool rotation = r.allFinite() && r.cwiseAbs().maxCoeff() < 2.0 && rotationDefect(r) <= orthonormality;
  setPose(metres(m[9], m[10], m[11]), rotation, rotation ? quaternionOf(r) : Quat::Identity(), item);
}

void readQuaternion(const igtl_qtdata_element& e, Item& item) {
  const Quat q(static_cast<double>(e.quaternion[3]), static_cast<double>(e.quaternion[0]),
               static_cast<double>(e.quaternion[1]), static_cast<double>(e.quaternion[2]));
  setPose(metres(e.position[0], e.position[1], e.position[2]),
          q.coeffs().allFinite() && std::abs(q.norm() - 1.0) <= orthonormality, q.normalized(), item);
}

bool isRead(const std::string& type) {
  return type == "TRANSFORM" || type == "TDATA" || type == "QTDATA" || type == "SENSOR" || type == "STATUS";
}

using Tell = std::function<void(const Item&)>;

void readBody(const std::string& type, const Item& head, std::span<const std::byte> body, const Tell& tell) {
  Item item = head;
  const auto fault = [&](std::size_t wanted) {
    item.kind = Item::Kind::fault;
    item.text = fmt::format("a {} message of {} bytes, where {} are expected", type, body.size(), wanted);
    tell(item);
  };
  item.kind = Item::Kind::pose;
  if (type == "TRANSFORM") {
    if (body.size() != IGTL_TRANSFORM_SIZE) return fault(IGTL_TRANSFORM_SIZE);
    auto m = read<std::array<igtl_float32, 12>>(body);
    igtl_transform_convert_byte_order(m.data());
    readMatrix(m.data(), item);
    tell(item);
  } else if (type == "TDATA") {
    if (body.size() % IGTL_TDATA_ELEMENT_SIZE != 0) return fault(IGTL_TDATA_ELEMENT_SIZE);
    for (; !body.empty(); body = body.subspan(IGTL_TDATA_ELEMENT_SIZE)) {
      auto e = read<igtl_tdata_element>(body);
      igtl_tdata_convert_byte_order(&e, 1);
      std::array<igtl_float32, 12> m{};
      std::memcpy(m.data(), e.transform, sizeof m);
      item.name = textOf(e.name, IGTL_TDATA_LEN_NAME);
      readMatrix(m.data(), item);
      tell(item);
    }
  } else if (type == "QTDATA") {
    if (body.size() % IGTL_QTDATA_ELEMENT_SIZE != 0) return fault(IGTL_QTDATA_ELEMENT_SIZE);
    for (; !body.empty(); body = body.subspan(IGTL_QTDATA_ELEMENT_SIZE)) {
      auto e = read<igtl_qtdata_element>(body);
      igtl_qtdata_convert_byte_order(&e, 1);
      item.name = textOf(e.name, IGTL_QTDATA_LEN_NAME);
      readQuaternion(e, item);
      tell(item);
    }
  } else if (type == "SENSOR") {
    item.kind = Item::Kind::number;
    const std::size_t count = body.empty() ? 0 : static_cast<std::size_t>(body[0]);
    const std::size_t wanted = IGTL_SENSOR_HEADER_SIZE + 8 * std::max<std::size_t>(1, count);
    if (body.size() != wanted) return fault(wanted);
    auto header = read<igtl_sensor_header>(body);
    header.larray = 1;
    auto value = read<igtl_float64>(body.subspan(IGTL_SENSOR_HEADER_SIZE));
    igtl_sensor_convert_byte_order(&header, &value);
    item.value = value;
    tell(item);
  } else {
    constexpr std::size_t fixed = 30;  // code (2), subcode (8), error name (20); then text
    if (body.size() < fixed) return fault(fixed);
    item.kind = Item::Kind::status;
    item.code = std::to_integer<int>(body[0]) * 256 + std::to_integer<int>(body[1]);
    item.text =
        textOf(reinterpret_cast<const char*>(body.data()) + fixed, std::min<std::size_t>(body.size() - fixed, 200));
    tell(item);
  }
}

std::vector<std::byte> message(const char* type, const std::string& name, std::int64_t time,
                               std::span<const std::byte> body) {
  igtl_header header{};
  header.version = IGTL_HEADER_VERSION;
  std::memcpy(header.name, type, std::min(std::strlen(type), sizeof header.name));
  std::memcpy(header.device_name, name.data(), std::min(name.size(), sizeof header.device_name));
  if (time >= 0) {
    const auto ns = static_cast<std::uint64_t>(time);
    header.timestamp =
        (ns / 1'000'000'000U) << 32U | igtl_nanosec_to_frac(static_cast<igtl_uint32>(ns % 1'000'000'000U));
  }
  header.body_size = body.size();
  std::vector<std::byte> copy(body.begin(), body.end());  // the library takes no const
  header.crc = crc64(reinterpret_cast<unsigned char*>(copy.data()), copy.size(), 0);
  igtl_header_convert_byte_order(&header);
  std::vector<std::byte> out(headerBytes + body.size());
  std::memcpy(out.data(), &header, headerBytes);
  std::memcpy(out.data() + headerBytes, body.data(), body.size());
  return out;
}

}  // namespace

void Decoder::reset() {
  buffer_.clear();
  skip_ = 0;
}

bool Decoder::take(std::span<const std::byte> bytes, const Tell& tell) {
  if (skip_ > 0) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(skip_, bytes.size()));
    skip_ -= n;
    bytes = bytes.subspan(n);
  }
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  bool sound = true;
  while (buffer_.size() - at >= headerBytes) {
    const std::span<std::byte> rest(buffer_.data() + at, buffer_.size() - at);
    auto header = read<igtl_header>(rest);
    igtl_header_convert_byte_order(&header);
    const std::string type = textOf(header.name, sizeof header.name);
    Item item;
    item.name = textOf(header.device_name, sizeof header.device_name);
    item.time = nanoseconds(header.timestamp);
    const std::uint64_t size = header.body_size;
    if (header.version < 1 || header.version > 3 || type.empty() || size > maxBody ||
        (isRead(type) && size > maxRead)) {
      item.text = "what came is not an OpenIGTLink header";
      tell(item);
      sound = false;
      break;
    }
    if (!isRead(type) || header.version == 3) {
      item.kind = Item::Kind::unknown;
      item.name = header.version == 3 ? type + " (protocol version 3)" : type;
      tell(item);
      const std::uint64_t here = std::min<std::uint64_t>(size, rest.size() - headerBytes);
      skip_ = size - here;
      at += headerBytes + static_cast<std::size_t>(here);
      continue;
    }
    if (rest.size() - headerBytes < size) break;
    const std::span<std::byte> body = rest.subspan(headerBytes, static_cast<std::size_t>(size));
    if (crc64(reinterpret_cast<unsigned char*>(body.data()), body.size(), 0) != header.crc) {
      item.text = fmt::format("a {} message with a wrong checksum", type);
      tell(item);
    } else {
      readBody(type, item, body, tell);
    }
    at += headerBytes + body.size();
  }
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(at));
  return sound;
}

std::vector<std::byte> transformMessage(const std::string& name, std::int64_t time, const Vec3& position,
                                        const Quat& orientation) {
  const Mat3 r = orientation.normalized().toRotationMatrix();
  std::array<igtl_float32, 12> m{};  // column by column, then the position
  Eigen::Map<Eigen::Matrix3f>(m.data()) = r.cast<float>();
  Eigen::Map<Eigen::Vector3f>(m.data() + 9) = (position / metresPerMillimetre).cast<float>();
  igtl_transform_convert_byte_order(m.data());
  return message("TRANSFORM", name, time, std::as_bytes(std::span(m)));
}

std::vector<std::byte> sensorMessage(const std::string& name, std::int64_t time, double value) {
  igtl_sensor_header header{};
  header.larray = 1;
  igtl_float64 data = value;
  igtl_sensor_convert_byte_order(&header, &data);
  std::vector<std::byte> body(IGTL_SENSOR_HEADER_SIZE + sizeof data);
  std::memcpy(body.data(), &header, IGTL_SENSOR_HEADER_SIZE);
  std::memcpy(body.data() + IGTL_SENSOR_HEADER_SIZE, &data, sizeof data);
  return message("SENSOR", name, time, body);
}

}  // namespace calot::recorder::openigtlink
