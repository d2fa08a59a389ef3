// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded, a file system that grants no locks, as some network shares: ENOLCK.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stddef.h>

int flock(int file, int operation) {
  (void)file;
  (void)operation;
  errno = ENOLCK;
  return -1;
}

static int control(const char* name, int file, int command, void* argument) {
  switch (command) {
    case F_SETLK:
    case F_SETLKW:
    case F_OFD_SETLK:
    case F_OFD_SETLKW:
      errno = ENOLCK;
      return -1;
    default:
      return ((int (*)(int, int, ...))dlsym(RTLD_NEXT, name))(file, command, argument);
  }
}

#define CONTROL(name)                               \
  int name(int file, int command, ...) {            \
    va_list rest;                                   \
    va_start(rest, command);                        \
    void* argument = va_arg(rest, void*);           \
    va_end(rest);                                   \
    return control(#name, file, command, argument); \
  }
CONTROL(fcntl)
CONTROL(fcntl64)
