// SPDX-License-Identifier: GPL-3.0-or-later
// CALOT_TEST_SANITIZED: this build has an address or thread sanitizer, which brings its own `operator new` and takes
// ten times as long.
#pragma once

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CALOT_TEST_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CALOT_TEST_SANITIZED
#endif
