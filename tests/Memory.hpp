// Processes that may hold little memory. Mapped files that are only read do not count; everything else does.
#pragma once
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <new>

// A sanitizer's own memory is far more than any limit here.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_can_be_limited = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool memory_can_be_limited = false;
#else
constexpr bool memory_can_be_limited = true;
#endif
#else
constexpr bool memory_can_be_limited = true;
#endif

enum class Ending { good, bad, out_of_memory, otherwise };

/// How some work ends in a separate process that may use so many bytes.
inline Ending endingWithin(rlim_t bytes, const std::function<bool()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_DATA, &limit);
    Ending ending = Ending::otherwise;
    try {
      ending = work() ? Ending::good : Ending::bad;
    } catch (const std::bad_alloc&) {
      ending = Ending::out_of_memory;
    } catch (...) {
    }
    ::_exit(static_cast<int>(ending));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? static_cast<Ending>(WEXITSTATUS(status)) : Ending::otherwise;
}
