#pragma once

namespace palpate::loop {

/// True in builds with address or thread sanitizer, which replace malloc and map terabytes.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PALPATE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PALPATE_SANITIZED 1
#endif
#endif
#ifndef PALPATE_SANITIZED
#define PALPATE_SANITIZED 0
#endif
inline constexpr bool kSanitized = PALPATE_SANITIZED != 0;

}  // namespace palpate::loop
