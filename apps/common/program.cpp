// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/common/program.h"

#include <exception>
#include <iostream>
#include <new>

#include "apps/common/advice.h"

namespace calot::apps {

int endWith(ExitCode code, const std::string& program, const std::string& message) {
  std::cerr << program << ": " << message << '\n';
  return static_cast<int>(code);
}

int runProgram(const std::string& program, const std::function<int()>& body) {
  try {
    return body();
  } catch (const Error& e) {
    return endWith(codeOf(e.kind()), program, messageOf(e));
  } catch (const std::bad_alloc&) {
    return endWith(ExitCode::failure, program, "not enough memory");
  } catch (const std::exception& e) {
    return endWith(ExitCode::failure, program, e.what());
  }
}

}  // namespace calot::apps
