#include "solver/threads.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>
#ifdef __linux__
#include <sched.h>
#endif

namespace deformable {

// How long a thread waits for others before it gives way, and before it sleeps. Where cores are fewer than threads, long waits cost
// more than all work: 4000 pauses made two threads on one core 15 times slower.
static constexpr int PAUSES = 200, YIELDS = 200;

static void cpu_pause()
{
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

struct Threads::Team {
  const pid_t owner = getpid();
  const int count;
  std::vector<std::thread> others;
  std::atomic<unsigned> job{0}, turn{0};    // numbers of the last call, and meeting of all
  std::atomic<int> arrived{0}, asleep{0};
  Call call = nullptr;    // null: threads end
  void *of = nullptr;
  std::mutex mutex;
  std::condition_variable awake;

  explicit Team(int count) : count(count)
  {
    // signals are for the caller, as Python expects it
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    for (int thread = 1; thread < count; ++thread)
      others.emplace_back([this, thread] { work(thread); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
  ~Team()
  {
    begin(nullptr, nullptr);
    for (std::thread &other : others) other.join();
  }

  void begin(Call call_, void *of_)
  {
    call = call_;
    of = of_;
    ++job;
    if (asleep == 0) return;
    const std::lock_guard<std::mutex> lock(mutex);
    awake.notify_all();
  }

  void work(int thread)
  {
    for (unsigned last = 0;; ++last) {
      const auto has_job = [&] { return job != last; };
      for (int n = 0; n < PAUSES && !has_job(); ++n) cpu_pause();
      for (int n = 0; n < YIELDS && !has_job(); ++n) std::this_thread::yield();
      if (!has_job()) {
        std::unique_lock<std::mutex> lock(mutex);
        ++asleep;
        awake.wait(lock, has_job);
        --asleep;
      }
      if (!call) return;
      call(of, thread);
      meet();
    }
  }

  void meet()
  {
    const unsigned now = turn;
    if (++arrived == count) {
      arrived = 0;
      ++turn;
      return;
    }
    for (int n = 0; n < PAUSES && turn == now; ++n) cpu_pause();
    while (turn == now) std::this_thread::yield();
  }
};

Threads::Threads() = default;

// In a forked child the threads do not exist, and nobody may wait for them.
Threads::~Threads()
{
  if (team && team->owner != getpid()) static_cast<void>(team.release());
}

int Threads::count() const
{
  return team && team->owner == getpid() ? team->count : 1;
}

void Threads::set_count(int wanted)
{
  if (wanted == count()) return;
  if (team && team->owner != getpid()) static_cast<void>(team.release());
  team.reset(wanted > 1 ? new Team(wanted) : nullptr);
}

void Threads::run_all(Call call, void *of)
{
  if (count() == 1) return call(of, 0);
  team->begin(call, of);
  call(of, 0);
  team->meet();
}

void Threads::wait_for_all()
{
  if (count() > 1) team->meet();
}

// Of those that the process is bound to, and of its share of the machine: containers have a quota.
int Threads::usable_cores()
{
  int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#ifdef __linux__
  cpu_set_t bound;
  if (sched_getaffinity(0, sizeof bound, &bound) == 0) cores = std::max(1, CPU_COUNT(&bound));
  std::ifstream quota("/sys/fs/cgroup/cpu.max");
  double time = 0.0, period = 0.0;
  if (quota >> time >> period && time > 0.0 && period > 0.0)    // else: "max"
    cores = std::min(cores, std::max(1, static_cast<int>(std::ceil(time / period))));
#endif
  return cores;
}

}    // namespace deformable
