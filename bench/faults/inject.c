// Preloaded into a program: makes the n-th call of one kind fail, or kills the program there.
//   FAULT_CALL   open, read, write, fsync, rename, malloc, thread or site
//   FAULT_AT     number of the call that fails, counted from 1; 0: none, only count. Of a site: its key
//   FAULT_STICKY all calls from then on fail, as on a full disk
//   FAULT_KILL   the program is killed (SIGKILL) instead
//   FAULT_COUNT  file for the number of calls; for the keys of all sites, a line each
// A site is where memory is allocated: the caller of the allocator (often operator new) and the caller of that, as
// offsets in their libraries, so that its key is the same in every run. The first allocation there fails.
// Calls are counted from the start of main: what the dynamic loader and static initialisers do is not kinloop's.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum Call { kNone, kOpen, kRead, kWrite, kFsync, kRename, kMalloc, kThread, kSite };

static enum Call failing = kNone;
static long fail_at = 0;
static uint64_t failing_site = 0;
static int sticky = 0, kills = 0;
static atomic_long calls;

static int fails(enum Call call) {
  if (call != failing) return 0;
  const long number = atomic_fetch_add(&calls, 1) + 1;
  const int now = fail_at != 0 && (sticky ? number >= fail_at : number == fail_at);
  if (now && kills) raise(SIGKILL);
  return now;
}

enum { kCallers = 2, kMostSites = 1 << 18 };
static _Atomic uint64_t sites[kMostSites];  // a hash table of keys; 0 = free
static _Thread_local int in_site = 0;       // finding the callers may allocate

// Key of the chain of callers of the allocator.
static __attribute__((noinline)) uint64_t site_key(void) {
  enum { kOwn = 3 };  // this function, fails_at_site and the allocator
  void* frames[kOwn + kCallers];
  const int count = backtrace(frames, kOwn + kCallers);
  uint64_t key = 14695981039346656037u;  // FNV-1a
  for (int i = kOwn; i < count; ++i) {
    Dl_info library;
    const uintptr_t base = dladdr(frames[i], &library) ? (uintptr_t)library.dli_fbase : 0;
    key = (key ^ ((uintptr_t)frames[i] - base)) * 1099511628211u;
  }
  return key | 1;
}

// Returns whether the key is new.
static int add_site(uint64_t key) {
  for (size_t i = key >> 20, tried = 0; tried < kMostSites; ++i, ++tried) {
    uint64_t there = 0;
    if (atomic_compare_exchange_strong(&sites[i % kMostSites], &there, key)) return 1;
    if (there == key) return 0;
  }
  return 0;
}

static __attribute__((noinline)) int fails_at_site(void) {
  if (failing != kSite || in_site) return 0;
  in_site = 1;
  const uint64_t key = site_key();
  const int now = add_site(key) && key == failing_site;
  in_site = 0;
  return now;
}

static void write_sites(int file) {
  char text[32];
  for (size_t i = 0; i < kMostSites; ++i) {
    const uint64_t key = atomic_load(&sites[i]);
    if (key != 0 && write(file, text, (size_t)snprintf(text, sizeof text, "%llx\n", (unsigned long long)key)) < 0) _exit(99);
  }
}

static void write_count(void) {
  const char* path = getenv("FAULT_COUNT");
  const long count = atomic_load(&calls);
  const int of_sites = failing == kSite;
  failing = kNone;
  if (path == NULL) return;
  char text[32];
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (of_sites)
    write_sites(file);
  else if (write(file, text, (size_t)snprintf(text, sizeof text, "%ld\n", count)) < 0) _exit(99);
  close(file);
}

static int (*real_main)(int, char**, char**);

static int armed_main(int argc, char** argv, char** environment) {
  static const char* const kNames[] = {"", "open", "read", "write", "fsync", "rename", "malloc", "thread", "site"};
  const char *call = getenv("FAULT_CALL"), *at = getenv("FAULT_AT");
  fail_at = at ? atol(at) : 0;
  failing_site = at ? strtoull(at, NULL, 16) : 0;
  sticky = getenv("FAULT_STICKY") != NULL;
  kills = getenv("FAULT_KILL") != NULL;
  atexit(write_count);
  void* frame;
  backtrace(&frame, 1);  // loads its library
  for (int i = kOpen; call && i <= kSite; ++i)
    if (strcmp(call, kNames[i]) == 0) failing = (enum Call)i;
  return real_main(argc, argv, environment);
}

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void* stack_end) {
  int (*start)(int (*)(int, char**, char**), int, char**, void (*)(void), void (*)(void), void (*)(void), void*);
  *(void**)&start = dlsym(RTLD_NEXT, "__libc_start_main");
  real_main = main;
  return start(armed_main, argc, argv, init, fini, rtld_fini, stack_end);
}

// Whether no full disk is felt: by a file in memory (memfd_create), and by standard error, to which the message goes.
static int is_off_disk(int file) {
  if (failing != kWrite) return 0;
  if (file == STDERR_FILENO) return 1;
  char link[32], target[8];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  return readlink(link, target, sizeof target) == sizeof target && memcmp(target, "/memfd:", 7) == 0;
}

// A function of the C library that sets errno and returns `failed` when its turn has come.
#define WRAP(result, name, parameters, arguments, call, code, failed) \
  result name parameters {                                            \
    static result(*real) parameters;                                  \
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name);              \
    if (fails(call)) {                                                \
      errno = code;                                                   \
      return failed;                                                  \
    }                                                                 \
    return real arguments;                                            \
  }

#define WRAP_OPEN(name, parameters, arguments)           \
  int name parameters {                                  \
    static int(*real)(const char*, int, ...);            \
    mode_t mode = 0;                                     \
    if (flags & (O_CREAT | O_TMPFILE)) {                 \
      va_list rest;                                      \
      va_start(rest, flags);                             \
      mode = va_arg(rest, mode_t);                       \
      va_end(rest);                                      \
    }                                                    \
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name); \
    if (fails(kOpen)) {                                  \
      errno = EMFILE;                                    \
      return -1;                                         \
    }                                                    \
    return real arguments;                               \
  }

WRAP_OPEN(open, (const char* path, int flags, ...), (path, flags, mode))
WRAP_OPEN(open64, (const char* path, int flags, ...), (path, flags, mode))
WRAP(FILE*, fopen, (const char* path, const char* mode), (path, mode), kOpen, EMFILE, NULL)
WRAP(FILE*, fopen64, (const char* path, const char* mode), (path, mode), kOpen, EMFILE, NULL)
WRAP(ssize_t, read, (int file, void* to, size_t size), (file, to, size), kRead, EIO, -1)
WRAP(ssize_t, pread, (int file, void* to, size_t size, off_t at), (file, to, size, at), kRead, EIO, -1)
WRAP(ssize_t, pread64, (int file, void* to, size_t size, off64_t at), (file, to, size, at), kRead, EIO, -1)
WRAP(ssize_t, write, (int file, const void* from, size_t size), (file, from, size), is_off_disk(file) ? kNone : kWrite, ENOSPC, -1)
WRAP(ssize_t, writev, (int file, const struct iovec* from, int parts), (file, from, parts), kWrite, ENOSPC, -1)
WRAP(ssize_t, pwrite, (int file, const void* from, size_t size, off_t at), (file, from, size, at), kWrite, ENOSPC, -1)
WRAP(ssize_t, pwrite64, (int file, const void* from, size_t size, off64_t at), (file, from, size, at), kWrite, ENOSPC, -1)
WRAP(int, ftruncate, (int file, off_t size), (file, size), kWrite, ENOSPC, -1)
WRAP(int, ftruncate64, (int file, off64_t size), (file, size), kWrite, ENOSPC, -1)
WRAP(int, fsync, (int file), (file), kFsync, EIO, -1)
WRAP(int, fdatasync, (int file), (file), kFsync, EIO, -1)
WRAP(int, rename, (const char* from, const char* to), (from, to), kRename, EACCES, -1)
WRAP(int, renameat2, (int a, const char* from, int b, const char* to, unsigned flags), (a, from, b, to, flags), kRename,
     EACCES, -1)

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*), void* argument) {
  static int (*real)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "pthread_create");
  return fails(kThread) ? EAGAIN : real(thread, attributes, start, argument);
}

// dlsym itself allocates, so the allocator is called by its other names.
extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static void* no_memory(void) {
  errno = ENOMEM;
  return NULL;
}

#define REFUSED (fails(kMalloc) || fails_at_site())

void* malloc(size_t size) { return REFUSED ? no_memory() : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return REFUSED ? no_memory() : __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return REFUSED ? no_memory() : __libc_realloc(old, size); }
void* memalign(size_t align, size_t size) { return REFUSED ? no_memory() : __libc_memalign(align, size); }
void* aligned_alloc(size_t align, size_t size) { return memalign(align, size); }
int posix_memalign(void** result, size_t align, size_t size) {
  void* memory = memalign(align, size);
  if (memory != NULL) *result = memory;
  return memory != NULL ? 0 : ENOMEM;
}
