// A thread under guard may not allocate, free, lock, or make any system call but those a turn of a
// real-time loop needs; the first that does ends the process with a sentence saying what it did.
// Include it in one source file of a test program: it defines malloc, pthread_mutex_lock and
// clock_gettime.
//
// System calls are stopped by a seccomp filter of the guarded thread alone. It lets through
//   sendto, sendmsg, recvfrom, recvmsg, poll, ppoll   the socket
//   timerfd_settime                                   the deadline of its wait
//   clock_nanosleep                                   the wait for the period's begin
//   clock_gettime(CLOCK_THREAD_CPUTIME_ID)            whose fault an overrun was, once per overrun
//   exit_group                                        the end of the test
// Every other clock is read without a system call; the readings let through are counted.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FARHAND_NO_PURITY "a sanitizer allocates, locks and calls the system by itself"
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FARHAND_NO_PURITY "a sanitizer allocates, locks and calls the system by itself"
#endif
#endif
#if !defined(FARHAND_NO_PURITY) && !(defined(__linux__) && defined(__x86_64__))
#define FARHAND_NO_PURITY "the system call filter is written for Linux on x86-64"
#endif

#ifndef FARHAND_NO_PURITY

#include <dlfcn.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <functional>

namespace farhand {

// Of a guarded process; shared with the parent that started it.
struct Impurity {
  char text[200] = {};  // empty: none
};
inline Impurity* impurity = nullptr;
inline constexpr int kImpure = 3;  // exit status
inline constexpr int kNoGuard = 4;

inline thread_local const char* guarded_as = nullptr;
inline thread_local std::size_t cpu_clock_readings = 0;  // while guarded

[[noreturn]] inline void confess(const char* what, long number) noexcept {
  const char* who = guarded_as;
  guarded_as = nullptr;
  if (impurity != nullptr)
    std::snprintf(impurity->text, sizeof impurity->text, "%s: %s%.0ld", who, what, number);
  _exit(kImpure);
}

inline void forbid(const char* function) noexcept {
  if (guarded_as != nullptr) confess(function, 0);
}

inline void on_bad_system_call(int, siginfo_t* info, void*) {
  confess("system call ", info->si_syscall);
}

inline auto system_call_filter() noexcept {
  constexpr std::array kAllowed = {
      SYS_sendto, SYS_sendmsg,         SYS_recvfrom,        SYS_recvmsg,   SYS_poll,
      SYS_ppoll,  SYS_timerfd_settime, SYS_clock_nanosleep, SYS_exit_group};
  const auto load = [](std::size_t offset) {
    return sock_filter(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<unsigned>(offset)));
  };
  const auto unless_skip = [](long value, unsigned char steps) {
    return sock_filter(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(value), 0, steps));
  };
  const sock_filter allow = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  const sock_filter trap = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  std::array<sock_filter, 8 + 2 * kAllowed.size()> filter{};
  std::size_t n = 0;
  filter[n++] = load(offsetof(seccomp_data, arch));
  filter[n++] = unless_skip(AUDIT_ARCH_X86_64, 2 + 2 * kAllowed.size());
  filter[n++] = load(offsetof(seccomp_data, nr));
  for (const long call : kAllowed) filter[n++] = unless_skip(call, 1), filter[n++] = allow;
  filter[n++] = unless_skip(SYS_clock_gettime, 3);
  filter[n++] = load(offsetof(seccomp_data, args));
  filter[n++] = unless_skip(CLOCK_THREAD_CPUTIME_ID, 1);
  filter[n++] = allow;
  filter[n++] = trap;
  return filter;
}

// Puts the calling thread under guard, for good: when done it may only sleep or end the process.
inline void guard_this_thread(const char* who) noexcept {
  struct sigaction action {};
  action.sa_sigaction = on_bad_system_call;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  auto filter = system_call_filter();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    _exit(kNoGuard);
  cpu_clock_readings = 0;
  guarded_as = who;
}

// Runs body in a child process that shares `impurity` and whatever else of its memory is shared.
// Returns the status as of waitpid.
inline int run_in_child(const std::function<void()>& body) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    body();
    _exit(0);
  }
  int status = -1;
  waitpid(child, &status, 0);
  return status;
}

// Plain values that a child and its parent both see.
template <typename T>
T& shared_with_children() {
  void* at = mmap(nullptr, sizeof(T), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) std::abort();
  return *new (at) T();
}

template <typename Function>
Function* next_definition(const char* name) noexcept {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace farhand

// NOLINTBEGIN(readability-identifier-naming, bugprone-macro-parentheses): the C library's own names
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  farhand::forbid("malloc");
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  farhand::forbid("calloc");
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  farhand::forbid("realloc");
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  farhand::forbid("aligned_alloc");
  return __libc_memalign(alignment, size);
}
void free(void* block) {
  farhand::forbid("free");
  __libc_free(block);
}

#define FARHAND_FORBIDDEN(name, Type)                                              \
  int name(Type* lock) noexcept {                                                  \
    farhand::forbid(#name);                                                        \
    static int (*const next)(Type*) = farhand::next_definition<int(Type*)>(#name); \
    return next(lock);                                                             \
  }
FARHAND_FORBIDDEN(pthread_mutex_lock, pthread_mutex_t)
FARHAND_FORBIDDEN(pthread_mutex_trylock, pthread_mutex_t)
FARHAND_FORBIDDEN(pthread_rwlock_rdlock, pthread_rwlock_t)
FARHAND_FORBIDDEN(pthread_rwlock_wrlock, pthread_rwlock_t)
FARHAND_FORBIDDEN(pthread_rwlock_tryrdlock, pthread_rwlock_t)
FARHAND_FORBIDDEN(pthread_rwlock_trywrlock, pthread_rwlock_t)
FARHAND_FORBIDDEN(sem_post, sem_t)
#undef FARHAND_FORBIDDEN

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static int (*const next)(clockid_t, timespec*) =
      farhand::next_definition<int(clockid_t, timespec*)>("clock_gettime");
  if (farhand::guarded_as != nullptr && clock == CLOCK_THREAD_CPUTIME_ID)
    ++farhand::cpu_clock_readings;
  return next(clock, time);
}
}
// NOLINTEND(readability-identifier-naming, bugprone-macro-parentheses)

#endif
