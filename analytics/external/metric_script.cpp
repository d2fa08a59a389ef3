// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/external/metric_script.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/external/metric_input.h"
#include "recorder/base/child_process.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::Channel;
using Clock = std::chrono::steady_clock;

constexpr std::size_t maxAnswer = 65536;
constexpr int answerDescriptor = 3;
constexpr int notStarted = 127;

/// Children of this program.
std::set<pid_t> childrenNow() {
  std::set<pid_t> children;
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", gone)) {
    std::ifstream list(task.path() / "children");
    for (pid_t child = 0; list >> child;) children.insert(child);
  }
  return children;
}

/// While it lives, what a child leaves behind becomes this program's child, so that it can be ended even where it has
/// left the child's process group.
class Adoption {
 public:
  Adoption() : before_(childrenNow()) {
    prctl(PR_GET_CHILD_SUBREAPER, &was_);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
  }
  Adoption(const Adoption&) = delete;
  Adoption& operator=(const Adoption&) = delete;
  ~Adoption() {
    // Ending one hands its own children over: until none is new.
    for (int pass = 0; pass < 100; ++pass) {
      bool any = false;
      for (const pid_t child : childrenNow()) {
        if (before_.count(child) > 0) continue;
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        any = true;
      }
      if (!any) break;
    }
    prctl(PR_SET_CHILD_SUBREAPER, was_);
  }

 private:
  std::set<pid_t> before_;
  int was_ = 0;
};

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  static_cast<void>(setrlimit(static_cast<__rlimit_resource>(resource), &both));
}

/// In the child, after fork: calls nothing that another thread of the parent may have locked.
[[noreturn]] void become(char* const* arguments, char* const* environment, const char* folder, int answer, int printed,
                         const ScriptLimits& limits, std::uint64_t inputBytes) {
  setpgid(0, 0);
  const int nothing = open("/dev/null", O_RDONLY);
  // The answer's end may be one of the numbers that are given out here.
  const int kept = fcntl(answer, F_DUPFD, 10);
  const int shown = fcntl(printed, F_DUPFD, 10);
  if (nothing < 0 || kept < 0 || shown < 0 || chdir(folder) != 0) _exit(notStarted);
  dup2(nothing, STDIN_FILENO);
  dup2(shown, STDOUT_FILENO);
  dup2(shown, STDERR_FILENO);
  dup2(kept, answerDescriptor);
  close_range(answerDescriptor + 1, ~0U, 0);
  limit(RLIMIT_AS, static_cast<rlim_t>(limits.mebibytes) * 1048576U + static_cast<rlim_t>(inputBytes));
  limit(RLIMIT_CPU, limits.seconds + 1);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NPROC, 0);
  execve(arguments[0], arguments, environment);
  _exit(notStarted);
}

/// Bytes received through a connection, up to a maximum.
struct Collected {
  int descriptor;
  std::size_t most;
  std::string text = {};
  bool over = false;

  /// Takes what is there. @return whether more may come
  bool take() {
    std::array<char, 4096> piece{};
    const ssize_t n = recv(descriptor, piece.data(), piece.size(), MSG_DONTWAIT);
    if (n <= 0) return n < 0 && errno == EINTR;
    const std::size_t taken = std::min(static_cast<std::size_t>(n), most - text.size());
    text.append(piece.data(), taken);
    over = over || taken < static_cast<std::size_t>(n);
    return !over;
  }
};

std::vector<char*> pointersTo(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

std::string pythonProgram() {
  if (const char* named = std::getenv("CALOT_PYTHON"); named != nullptr && *named != '\0') return named;
  const std::string system = "/usr/bin/python3";
  if (access(system.c_str(), X_OK) == 0) return system;
  const char* const path = std::getenv("PATH");
  std::string rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string program = rest.substr(0, colon) + "/python3";
    if (access(program.c_str(), X_OK) == 0) return program;
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return system;
}

ScriptEnd runScript(const std::vector<std::string>& command, const std::filesystem::path& folder,
                    const ScriptLimits& limits, std::uint64_t inputBytes) {
  if (access(command.front().c_str(), X_OK) != 0)
    throw Error(ErrorKind::failure, Where{command.front()},
                fmt::format("cannot be started: {}; CALOT_PYTHON names the Python that runs metrics",
                            std::generic_category().message(errno)));
  const std::string home = folder.string();
  // One thread: sums have one order.
  const std::vector<std::string> fixed{"PATH=/usr/bin:/bin", "HOME=" + home,      "TMPDIR=" + home,
                                       "LANG=C.UTF-8",       "PYTHONHASHSEED=0",  "OPENBLAS_NUM_THREADS=1",
                                       "OMP_NUM_THREADS=1",  "MKL_NUM_THREADS=1", "PYTHONDONTWRITEBYTECODE=1"};
  const std::vector<char*> arguments = pointersTo(command), environment = pointersTo(fixed);
  auto [print, childsPrint] = recorder::newConnection();
  const int childsPrints = childsPrint.descriptor();
  const Adoption adoption;
  const auto deadline = Clock::now() + std::chrono::seconds(limits.seconds);
  recorder::ChildProcess child([&](const Channel& parent) {
    become(arguments.data(), environment.data(), home.c_str(), parent.descriptor(), childsPrints, limits, inputBytes);
  });
  childsPrint = Channel();
  setpgid(child.pid(), child.pid());  // whichever of both comes first
  const Channel process(static_cast<int>(syscall(SYS_pidfd_open, child.pid(), 0)));
  Collected answer{child.channel().descriptor(), maxAnswer}, printed{print.descriptor(), maxPrinted};
  std::array<pollfd, 3> ready{pollfd{answer.descriptor, POLLIN, 0}, pollfd{printed.descriptor, POLLIN, 0},
                              pollfd{process.descriptor(), POLLIN, 0}};
  ScriptEnd end;
  // A process that it forked may keep both connections open after its end.
  while ((ready[2].revents & POLLIN) == 0 && end.how == ScriptEnd::How::exited) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) end.how = ScriptEnd::How::late;
    poll(ready.data(), ready.size(), static_cast<int>(std::clamp<long long>(left, 0, 1000)));
    for (std::size_t i = 0; i < 2; ++i) {
      Collected& from = i == 0 ? answer : printed;
      if (ready[i].revents != 0 && !from.take()) ready[i].fd = -1;
      if (from.over) end.how = ScriptEnd::How::printedTooMuch;
    }
  }
  for (Collected* from : {&answer, &printed}) {
    while (from->take()) {
    }
  }
  kill(-child.pid(), SIGKILL);
  const recorder::ProcessEnd ended = child.end();
  end.answer = std::move(answer.text);
  end.printed = std::move(printed.text);
  if (end.how != ScriptEnd::How::exited) return end;
  end.number = ended.number;
  if (answer.over || printed.over) {
    end.how = ScriptEnd::How::printedTooMuch;
  } else if (ended.signalled) {
    end.how = ended.number == SIGXCPU ? ScriptEnd::How::late : ScriptEnd::How::signalled;
  } else if (ended.number == notStarted && end.answer.empty()) {
    throw Error(ErrorKind::failure, Where{command.front()},
                "cannot be started; CALOT_PYTHON names the Python that runs metrics");
  }
  return end;
}

namespace {

using ScriptJson = nlohmann::json;

constexpr std::size_t maxScriptBytes = 1U << 20U;
constexpr std::size_t maxMetricName = 64, maxMetricUnit = 16, maxMetricTitle = 120, maxMissingReason = 200;
constexpr std::uint32_t maxMetricVersion = 1000000;

std::string shortened(std::string text, std::size_t most) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text.size() > most ? text.substr(0, most) + "..." : text;
}

void writeBytes(const std::filesystem::path& file, const void* bytes, std::size_t size) {
  std::ofstream out(file, std::ios::binary);
  out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  if (!out.flush()) throw Error(ErrorKind::failure, Where{file.string()}, "cannot be written");
}

std::uint64_t bytesUnder(const std::filesystem::path& folder) {
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  return bytes;
}

void passOn(const ScriptPrint& print, const std::string& file, const std::string& printed) {
  if (!print) return;
  std::string_view rest = printed;
  while (!rest.empty()) print(file, shortened(std::string(recorder::takeLine(rest)), maxPrinted));
}

/// Parses the script's output. @throws Error (damaged) where it failed.
ScriptJson run(const std::string& file, const std::vector<std::byte>& text, const ScriptLimits& limits,
               const ScriptPrint& print, const std::filesystem::path* input) {
  const recorder::TemporaryFolder folder;
  const std::filesystem::path script = folder.path() / "metric.py", runner = folder.path() / "run_metric.py";
  writeBytes(script, text.data(), text.size());
  writeBytes(runner, metricRunner().data(), metricRunner().size());
  const std::string python = pythonProgram();
  std::vector<std::string> command{python, "-s", "-B", runner.string(), script.string(), file};
  if (input != nullptr) command.push_back(input->string());
  const ScriptEnd end = runScript(command, folder.path(), limits, input != nullptr ? bytesUnder(*input) : 0);
  passOn(print, file, end.printed);
  const auto fail = [&](const std::string& fault, const ScriptJson& line = {}) {
    return Error(ErrorKind::damaged, Where{file, line.is_number() ? fmt::format("line {}", line.get<int>()) : ""},
                 fault);
  };
  if (end.how == ScriptEnd::How::late)
    throw fail(fmt::format("takes more than {} s; allow it more, or look for a loop without end", limits.seconds));
  if (end.how == ScriptEnd::How::printedTooMuch) throw fail(fmt::format("prints more than {} bytes", maxPrinted));
  if (end.how == ScriptEnd::How::signalled)
    throw fail(fmt::format("ended by signal {} ({})", end.number, strsignal(end.number)));
  const ScriptJson answer = ScriptJson::parse(end.answer, nullptr, false);
  if (!answer.is_object()) throw fail(fmt::format("ended the program without a result (exit code {})", end.number));
  if (answer.contains("setup"))
    throw Error(ErrorKind::failure, Where{python},
                answer["setup"].get<std::string>() + "; install python3-numpy, or name another in CALOT_PYTHON");
  if (answer.contains("memory"))
    throw fail(fmt::format("takes more than {} MiB of memory; allow it more, or read less at a time", limits.mebibytes),
               answer.value("line", ScriptJson()));
  if (answer.contains("fault"))
    throw fail(shortened(answer["fault"].get<std::string>(), 4 * maxMissingReason), answer.value("line", ScriptJson()));
  return answer;
}

bool isMetricName(const std::string& name) {
  const auto letter = [](char c) { return c >= 'a' && c <= 'z'; };
  return !name.empty() && name.size() <= maxMetricName && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '-'; });
}

bool isMetricText(const std::string& text, std::size_t most) {
  return !text.empty() && text.size() <= most &&
         std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

ExternalMetric metricOf(const ScriptJson& declared, const std::string& file, std::string sha256) {
  const auto fail = [&](const std::string& fault) { return Error(ErrorKind::damaged, Where{file}, fault); };
  ExternalMetric metric;
  CheckpointDefinition& d = metric.definition;
  d.name = declared.at("name").get<std::string>();
  if (!isMetricName(d.name))
    throw fail(fmt::format("NAME \"{}\": 1 to {} small letters, digits and hyphens are expected, a letter first",
                           recorder::shown(d.name), maxMetricName));
  if (findCheckpoint(d.name) != nullptr)
    throw fail(fmt::format("NAME \"{}\" is a checkpoint of the program (calot checkpoints lists them)", d.name));
  const ScriptJson& version = declared.at("version");
  if (!version.is_number_unsigned() || version.get<std::uint64_t>() < 1 ||
      version.get<std::uint64_t>() > maxMetricVersion)
    throw fail(fmt::format("VERSION {}: 1 to {} is expected", version.dump(), maxMetricVersion));
  d.version = version.get<std::uint32_t>();
  d.unit = d.displayUnit = declared.at("unit").get<std::string>();
  if (!isMetricText(d.unit, maxMetricUnit))
    throw fail(fmt::format("UNIT: 1 to {} bytes on one line are expected, \"1\" for a share", maxMetricUnit));
  d.title = declared.at("title").get<std::string>();
  if (!isMetricText(d.title, maxMetricTitle))
    throw fail(fmt::format("TITLE: 1 to {} bytes on one line are expected", maxMetricTitle));
  static const std::map<std::string, Direction> directions{
      {"lower", Direction::lower}, {"higher", Direction::higher}, {"none", Direction::none}};
  const auto better = declared.at("better").get<std::string>();
  const auto direction = directions.find(better);
  if (direction == directions.end())
    throw fail(fmt::format("BETTER \"{}\": lower, higher or none is expected", recorder::shown(better)));
  d.direction = direction->second;
  d.window = "whole attempt";
  d.filter = "none";
  d.origins = {Origin::external};
  d.finality = Finality::final;
  d.definition = "script with SHA-256 " + sha256;
  metric.sha256 = std::move(sha256);
  return metric;
}

}  // namespace

MetricScript::MetricScript(const std::filesystem::path& file, const ScriptLimits& limits, ScriptPrint print)
    : file_(file.string()), limits_(limits), print_(std::move(print)) {
  text_ = recorder::readFileBytes(file, file_, maxScriptBytes);
  metric_ = ExternalMetricRef(metricOf(run(file_, text_, limits_, print_, nullptr), file_, recorder::sha256Hex(text_)));
}

CheckpointValue MetricScript::compute(const std::filesystem::path& folder, const std::string& note) const {
  const ScriptJson answer = run(file_, text_, limits_, print_, &folder);
  const CheckpointDefinition& d = metric_->definition;
  CheckpointValue value = answer.contains("value")
                              ? makeValue(d, "", Origin::external, answer.at("value").get<double>(), note)
                              : makeMissing(d, "", Origin::external, Availability::notAvailable,
                                            shortened(answer.at("missing").get<std::string>(), maxMissingReason));
  value.metric = metric_;
  return value;
}

std::vector<MetricScript> readMetricScripts(const std::vector<std::string>& files, const ScriptLimits& limits,
                                            const ScriptPrint& print) {
  std::vector<MetricScript> scripts;
  for (const std::string& file : files) {
    MetricScript script(file, limits, print);
    for (const MetricScript& other : scripts) {
      if (other.metric()->definition.name == script.metric()->definition.name)
        throw Error(ErrorKind::invalid, Where{file},
                    fmt::format("NAME {} is that of {} too", script.metric()->definition.name, other.file()));
    }
    scripts.push_back(std::move(script));
  }
  return scripts;
}

MetricOutcomes computeMetrics(const std::vector<MetricScript>& scripts, const std::filesystem::path& folder,
                              const std::string& note) {
  MetricOutcomes outcomes;
  for (const MetricScript& script : scripts) {
    try {
      outcomes.values.push_back(script.compute(folder, note));
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::damaged) throw;
      outcomes.failures.push_back(e);
    }
  }
  return outcomes;
}

}  // namespace calot::analytics
