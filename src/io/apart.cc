#include "io/apart.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>

#include "core/machine.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

bool is_child = false;

/// How it went, before what there is to say; and behind it, so that it is known to be whole.
enum class Outcome : char { Done = 'd', Input = 'i', Io = 'o', Limit = 'l' };

std::string told(Outcome outcome, const std::string& words) {
  return static_cast<char>(outcome) + words + static_cast<char>(outcome);
}

std::string told_of(const std::function<std::string()>& work) {
  try {
    return told(Outcome::Done, work());
  } catch (const InputError& error) {
    return told(Outcome::Input, error.what());
  } catch (const LimitError& error) {
    return told(Outcome::Limit, error.what());
  } catch (const IoError& error) {
    return told(Outcome::Io, error.what());
  } catch (const std::bad_alloc&) {
    return {};
  }
}

/// The kernel kills at the hard limit, and says why at a lower soft one.
void limit(int resource, rlim_t most, rlim_t beyond = 0) {
  const rlimit both{most, most + beyond};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// The other process; it ends without what this one has registered for its end.
[[noreturn]] void be_apart(int pipe_end, const std::function<std::string()>& work,
                           unsigned cpu_seconds) {
  is_child = true;
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGPIPE, SIGXCPU}) {
    ::signal(signal, SIG_DFL);
  }
  // OpenCASCADE tells standard output what it thinks of a file, libcgns the other what it asserts.
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
  }
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, cpu_seconds, 2);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  constexpr rlim_t kLibraries = rlim_t{4} << 30U;
  limit(RLIMIT_AS, mapped_bytes() + kLibraries + free_memory_bytes());
#endif
  const std::string bytes = told_of(work);
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::write(pipe_end, bytes.data() + sent, bytes.size() - sent);
    if (count <= 0) break;
    sent += static_cast<std::size_t>(count);
  }
  ::close(pipe_end);
  for (;;) ::kill(::getpid(), SIGKILL);
}

std::string read_all(int pipe_end) {
  std::string bytes;
  std::array<char, 1 << 16> some{};
  for (;;) {
    const ssize_t count = ::read(pipe_end, some.data(), some.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.append(some.data(), static_cast<std::size_t>(count));
  }
}

[[noreturn]] void say_why(int status, const Apart& apart) {
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGINT || signal == SIGTERM) throw Cancelled();
  if (signal == SIGXCPU) {
    throw IoError(fmt::format("{}: {} does not get done with it in {} s; it is damaged, or {}",
                              apart.file, apart.library, apart.cpu_seconds, apart.advice));
  }
  throw IoError(fmt::format("{}: {} fails on it; it is damaged, or needs more memory than there is",
                            apart.file, apart.library));
}

}  // namespace

bool is_apart() { return is_child; }

std::string run_apart(const std::function<std::string()>& work, const Apart& apart) {
  const std::string& file = apart.file;
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw IoError(file + ": no pipe: " + std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) {
    const std::string why = std::strerror(errno);
    ::close(ends[0]);
    ::close(ends[1]);
    throw IoError(file + ": no process to read it: " + why);
  }
  if (child == 0) {
    ::close(ends[0]);
    be_apart(ends[1], work, apart.cpu_seconds);
  }
  ::close(ends[1]);
  std::string bytes = read_all(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const bool is_whole = bytes.size() >= 2 && bytes.front() == bytes.back();
  if (!is_whole) say_why(status, apart);
  const auto outcome = static_cast<Outcome>(bytes.front());
  bytes.erase(0, 1);
  bytes.pop_back();
  if (outcome == Outcome::Input) throw InputError(bytes);
  if (outcome == Outcome::Limit) throw LimitError(bytes);
  if (outcome == Outcome::Io) throw IoError(bytes);
  return bytes;
}

}  // namespace vdb_offset
