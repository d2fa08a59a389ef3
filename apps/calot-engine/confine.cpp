// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot-engine/confine.h"

#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <array>

namespace calot::apps {

namespace {

// A sanitizer's own needs are others, and its memory has no bounds.
#ifdef CALOT_SANITIZED
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

bool limit(int what, rlim_t most) {
  const rlimit both{most, most};
  return setrlimit(static_cast<__rlimit_resource>(what), &both) == 0;
}

/// System calls of a program that computes, besides mmap. The C++ runtime wakes (futex) what might wait for what it
/// does once.
constexpr std::array allowed{
    SCMP_SYS(read),
    SCMP_SYS(write),
    SCMP_SYS(exit),
    SCMP_SYS(exit_group),
    SCMP_SYS(brk),
    SCMP_SYS(munmap),
    SCMP_SYS(mremap),
    SCMP_SYS(futex),
    SCMP_SYS(madvise),
    SCMP_SYS(rt_sigreturn),
    SCMP_SYS(restart_syscall),
};

}  // namespace

recorder::Confinement confine() {
  if constexpr (sanitized) return recorder::Confinement::none;
  bool done = limit(RLIMIT_AS, engineMemory) && limit(RLIMIT_CORE, 0) && limit(RLIMIT_FSIZE, 0) &&
              prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_KILL_PROCESS);
  if (filter == nullptr) return recorder::Confinement::none;
  for (const int call : allowed) done = seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) == 0 && done;
  // Memory is for numbers: none of it may be run.
  const scmp_arg_cmp notToBeRun{2, SCMP_CMP_MASKED_EQ, PROT_EXEC, 0};
  done = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1, &notToBeRun) == 0 && done;
  done = seccomp_load(filter) == 0 && done;
  seccomp_release(filter);
  return done ? recorder::Confinement::own : recorder::Confinement::none;
}

}  // namespace calot::apps
